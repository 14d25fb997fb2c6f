// Geometric primitives in world space: what an area light samples, and what rays meet where Embree has no native
// geometry (sphere, disk, cylinder, bilinear patch). Small tagged value, free functions.
#pragma once

#include "dapple/math/ray.h"
#include "dapple/math/transform.h"
#include "dapple/shapes/surface_point.h"

#include <cstdint>

namespace dapple {

struct Primitive {
    enum class Kind : uint8_t { triangle, sphere, disk, cylinder, bilinear };
    Kind kind = Kind::triangle;
    bool flip = false;            // outside is against the parametrisation's normal: ReverseOrientation xor handedness
    Vec3 p[4];                    // triangle (3), bilinear patch (4: p00, p10, p01, p11), world space
    Vec2 uv[4];
    Vec3 n[4];                    // shading normals; used when has_normals
    bool has_normals = false;
    bool has_uv = false;          // false: triangle (0,0),(1,0),(1,1); patch the unit square
    Transform world_from_object;  // quadrics
    float radius = 1.0f;          // quadrics
    float inner_radius = 0.0f;    // disk
    float height = 0.0f;          // disk
    float z_min = -1.0f, z_max = 1.0f;  // sphere, cylinder
    float phi_max = 2.0f * pi;
};

struct PrimitiveHit {
    float t = 0.0f;
    Vec2 uv{0, 0};                // triangle: barycentric of vertices 1 and 2; others: the parameter in [0,1]^2
};

Box3 bounds(const Primitive& primitive);
float area(const Primitive& primitive);

// Nearest intersection with t in (t_min, t_max); quadrics and patches only. Computed in double precision.
bool intersect(const Primitive& primitive, const Ray& ray, float t_min, float t_max, PrimitiveHit& hit);

// Differential geometry at a hit. `hit.uv` is what intersect returned (for triangles: Embree's barycentrics).
SurfacePoint surface_point(const Primitive& primitive, const PrimitiveHit& hit, float time);

struct ShapeSample {
    Vec3 position{0, 0, 0};
    Vec3 error{0, 0, 0};
    Vec3 normal{0, 0, 1};         // unit, outside
    Vec2 uv{0, 0};
    float pdf = 0.0f;             // per area (sample_area) or per solid angle (sample_solid_angle)
};

// A point chosen uniformly by area (triangles, quadrics; patches by an approximation whose pdf is exact).
ShapeSample sample_area(const Primitive& primitive, const Vec2& u);
float pdf_area(const Primitive& primitive, const Vec3& position);

// A point chosen for its solid angle from `reference` (spheres: the cone; triangles: the spherical triangle of Arvo
// 1995, when it is neither tiny nor huge; else by area). False when nothing is visible.
bool sample_solid_angle(const Primitive& primitive, const Vec3& reference, const Vec2& u, ShapeSample& sample);
// The density of sample_solid_angle for a direction wi that meets the primitive at `at` with unit normal n.
float pdf_solid_angle(const Primitive& primitive, const Vec3& reference, const Vec3& wi, const Vec3& at, const Vec3& n);

}  // namespace dapple
