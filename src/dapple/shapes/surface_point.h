// Differential geometry of a point on a surface: what textures, materials, lights and walks need to know of it.
#pragma once

#include "dapple/math/frame.h"
#include "dapple/math/vec.h"

#include <cstdint>

namespace dapple {

// What is wanted of a surface point; the rest is left out because nothing will look at it.
enum class SurfaceDetail : uint8_t {
    bare,         // position and normals
    no_tangents,  // uv as well (textures)
    tangents,     // and the tangents and what changes along them (bump and normal maps, anisotropic lobes)
};

struct SurfacePoint {
    Vec3 position{0, 0, 0};
    Vec3 error{0, 0, 0};        // absolute bound of the position's error per axis, for offset_ray_origin
    Vec3 n_geometric{0, 0, 1};  // unit; points to the surface's outside (orientation of the shape, reversal applied)
    Vec3 n_shading{0, 0, 1};    // unit; same side as n_geometric
    Vec2 uv{0, 0};
    Vec3 dpdu{1, 0, 0};  // geometric parametrisation
    Vec3 dpdv{0, 1, 0};
    Vec3 dpdu_shading{1, 0, 0};  // tangent that orients anisotropic lobes; orthogonal to n_shading
    Vec3 dndu{0, 0, 0};          // change of the shading normal
    Vec3 dndv{0, 0, 0};
    float time = 0.0f;
};

}  // namespace dapple
