// Shapes, meshes, objects and their instances.
#pragma once

#include "dapple/scene/values.h"

#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace dapple::scene {

// Vertices and faces in object space. Per-vertex arrays are empty or as long as `positions`; indices are in range.
struct MeshData {
    std::vector<Vec3> positions;
    std::vector<Vec3> normals;
    std::vector<Vec2> uvs;
    std::vector<uint32_t> triangles;  // 3 per face
    std::vector<uint32_t> quads;      // 4 per face: p00, p10, p01, p11 of a bilinear patch
    std::vector<Vec3> tangents;       // orient anisotropic lobes on triangles; else the texture coordinates do
};

struct Sphere {
    float radius = 1.0f;
    float z_min = -1.0f, z_max = 1.0f;  // clipped to [z_min, z_max]; the reader sets them to -+radius by default
    float phi_max = 360.0f;             // [degrees]
};
struct Disk {
    float height = 0.0f;
    float radius = 1.0f;
    float inner_radius = 0.0f;
    float phi_max = 360.0f;  // [degrees]
};
struct Cylinder {
    float radius = 1.0f;
    float z_min = -1.0f, z_max = 1.0f;
    float phi_max = 360.0f;  // [degrees]
};
// Triangles and bilinear patches; a PLY file with both has both.
struct Mesh {
    std::shared_ptr<const MeshData> data;
};
// A triangle control mesh, to be subdivided by Loop's scheme.
struct LoopSubdivision {
    int levels = 3;
    std::shared_ptr<const MeshData> data;
};

struct Shape {
    std::variant<Sphere, Disk, Cylinder, Mesh, LoopSubdivision> geometry;
    MovingMatrix world_from_object;  // in an ObjectDefinition: object_from_shape, see there
    bool reverse_orientation = false;
    MaterialIndex material{0};
    AreaLightIndex area_light;  // none: does not emit
    FloatInput alpha{1.0f};     // opacity in [0, 1]
    MediumIndex inside, outside;
    bool medium_interface = false;  // the scene names a MediumInterface here (may be vacuum on both sides)
    SourceLocation at;
    std::string name;  // "sphere", "plymesh geometry/lte.ply", ... for messages
};

// Shapes that exist only through instances. The shapes' matrices are the whole transform that was current at their
// place; an instance's matrix is applied after them: world = instance * shape.
struct ObjectDefinition {
    std::string name;
    std::vector<Shape> shapes;
    SourceLocation at;
};
struct Instance {
    ObjectIndex object;
    MovingMatrix world_from_object;
    SourceLocation at;
};

}  // namespace dapple::scene
