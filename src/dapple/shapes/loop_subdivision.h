// Loop subdivision surfaces: triangle meshes whose refinement converges to a smooth surface.
#pragma once

#include "dapple/base/error.h"
#include "dapple/math/vec.h"

#include <cstdint>
#include <span>
#include <vector>

namespace dapple {

struct SubdividedMesh {
    std::vector<Vec3> positions;  // on the limit surface; the control vertices come first, in their order
    std::vector<Vec3> normals;    // unit normals of the limit surface, on the side cross(p1 - p0, p2 - p0) points to
    std::vector<uint32_t> indices;
};

// Refines the control mesh `levels` times, four triangles out of one, and moves the vertices to the limit surface.
// Vertices that no triangle uses stay where they are, with normal +z. Throws UserError at `where` when the mesh is no
// consistently oriented manifold (with or without boundary), refers to vertices that do not exist, or would grow beyond
// 2^28 triangles.
SubdividedMesh loop_subdivide(std::span<const Vec3> positions, std::span<const uint32_t> indices, int levels,
                              const SourceLocation& where);

}  // namespace dapple
