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
    // The outside is the side of cross(dp/du, dp/dv) of the world-space parametrisation, or the other side when flip is
    // set: flip = ReverseOrientation xor "the transform swaps handedness". A reflecting transform turns that cross
    // product over and flip turns it back, so spheres and cylinders have their outside away from the centre or axis and
    // disks towards their object-space +z, whatever the transform, unless ReverseOrientation is on. Triangles count as
    // parametrised along p1 - p0 and p2 - p0, whatever their uv. Shading normals, where given, overrule all of this:
    // the outside is their side (as in pbrt).
    bool flip = false;
    Vec3 p[4]{Vec3(0), Vec3(0), Vec3(0), Vec3(0)};  // triangle (3), bilinear patch (4: p00, p10, p01, p11), world space
    Vec2 uv[4]{Vec2(0), Vec2(0), Vec2(0), Vec2(0)};
    Vec3 n[4]{Vec3(0), Vec3(0), Vec3(0),
              Vec3(0)};  // shading normals, world space, negated already under ReverseOrientation
    bool has_normals = false;
    bool has_uv = false;                // false: triangle (0,0),(1,0),(1,1); patch the unit square
    Transform world_from_object;        // quadrics; affine
    float radius = 1.0f;                // quadrics
    float inner_radius = 0.0f;          // disk
    float height = 0.0f;                // disk
    float z_min = -1.0f, z_max = 1.0f;  // sphere, cylinder
    float phi_max = 2.0f * pi;
};

struct PrimitiveHit {
    float t = 0.0f;
    Vec2 uv{0, 0};  // triangle: barycentric of vertices 1 and 2; others: the parameter in [0,1]^2
};

// Axis-aligned bounds in world space, rounded outwards.
Box3 bounds(const Primitive& primitive);
// Surface area in world space; closed form where the transform is a similarity, else quadrature (relative error 1e-6).
float area(const Primitive& primitive);

// Nearest intersection with t in (t_min, t_max); quadrics and patches only. Computed in double precision.
bool intersect(const Primitive& primitive, const Ray& ray, float t_min, float t_max, PrimitiveHit& hit);
// The same for who goes on with the ray: hit.uv is left out where surface_point(primitive, ray, hit) does not look at
// it.
bool meet(const Primitive& primitive, const Ray& ray, float t_min, float t_max, PrimitiveHit& hit);

// Differential geometry at a hit. `hit.uv` is what intersect returned (for triangles: Embree's barycentrics).
SurfacePoint surface_point(const Primitive& primitive, const PrimitiveHit& hit, float time);
// The same for a hit of this ray. On quadrics the position is the ray's own point projected onto the surface, which is
// finer than the hit's parameters where the ray is short against the radius (a planet seen from its ground).
SurfacePoint surface_point(const Primitive& primitive, const Ray& ray, const PrimitiveHit& hit,
                           SurfaceDetail detail = SurfaceDetail::tangents);

struct ShapeSample {
    Vec3 position{0, 0, 0};
    Vec3 error{0, 0, 0};
    Vec3 normal{0, 0, 1};  // unit, outside
    Vec2 uv{0, 0};
    float pdf = 0.0f;  // per area (sample_area) or per solid angle (sample_solid_angle)
};

// A primitive to be sampled, with what all its samples have in common.
struct SampledShape {
    SampledShape() = default;
    SampledShape(const Primitive& shape);  // implicit: cold code samples primitives as they are

    Primitive primitive;
    bool whole_sphere = false;
    // Triangles.
    bool one_sided = false;  // normal and error are those of all points (shading normals may turn the outside over)
    Vec3 normal{0, 0, 1};
    Vec3 error{0, 0, 0};
    Vec3 center{0, 0, 0};
    float far_distance2 = 0.0f;  // squared distance from the centre where sampling by area is as good as by solid angle
    float density = 0.0f;        // of sampling by area: one over the area; 0 where there is none [1/m^2]
};

// A point chosen uniformly by area: triangles, disks, quadrics under similarities. Patches, and spheres and cylinders
// under uneven scales, are sampled roughly by area; the pdf is exact. The sample's pdf is 0 where there is no area.
ShapeSample sample_area(const SampledShape& shape, const Vec2& u);
// The density of sample_area at a position on the primitive [1/m^2].
float pdf_area(const SampledShape& shape, const Vec3& position);

// A point chosen for its solid angle from `reference` (whole spheres: uniform in the cone, or in all directions from
// within; triangles: the spherical triangle of Arvo 1995, when it is neither far nor tiny nor huge; else by area).
// False when nothing is visible. Sides are not looked at: a point may show its back.
bool sample_solid_angle(const SampledShape& shape, const Vec3& reference, const Vec2& u, ShapeSample& sample);
// The density of sample_solid_angle [1/sr] for a unit direction wi that meets the primitive at `at` with unit geometric
// normal n (either side).
float pdf_solid_angle(const SampledShape& shape, const Vec3& reference, const Vec3& wi, const Vec3& at, const Vec3& n);

}  // namespace dapple
