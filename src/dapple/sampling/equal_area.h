// The equal-area map between the unit square and the sphere (Clarberg 2008, "Fast equal-area mapping of the
// (hemi)sphere using SIMD"), in the orientation pbrt-v4 uses, so that environment maps and spherical cameras agree.
//
// The square [-1,1]^2 is folded like an octahedron: the diamond |x| + |y| <= 1 holds z >= 0, the four corners hold
// z <= 0. In the diamond, r = |x| + |y| and phi = (pi/2) |y| / r per quadrant; the triangle of radius r in a quadrant
// has area r^2 / 2 of 4, the spherical octant's cap above z has (pi/2)(1 - z) of 4 pi: equal shares demand z = 1 - r^2.
// The corners are the diamond's triangles mirrored at its edges. The inverse uses atan2 and 1 - |z| =
// (x^2+y^2)/(1+|z|), which keeps full precision at the poles (Clarberg's polynomial and 1 - |z| do not).
#pragma once

#include "dapple/math/vec.h"

namespace dapple {

// The unit direction of a point of [0,1]^2; uniform points become uniform directions (density 1 / (4 pi)).
inline Vec3 equal_area_square_to_sphere(const Vec2& p)
{
    const float x = 2.0f * p.x - 1.0f;
    const float y = 2.0f * p.y - 1.0f;
    const float ax = std::fabs(x);
    const float ay = std::fabs(y);
    const bool upper = ax + ay <= 1.0f;
    // Mirrored at the diamond's edge, a corner's point has its distance to the corner as radius.
    const float u = upper ? ax : 1.0f - ay;
    const float v = upper ? ay : 1.0f - ax;
    const float r = u + v;
    if (!(r > 0.0f)) return {0.0f, 0.0f, upper ? 1.0f : -1.0f};
    const float phi = (0.5f * pi) * (v / r);
    const float sin_t = r * safe_sqrt(2.0f - r * r);
    const float z = 1.0f - r * r;
    return {std::copysign(sin_t * std::cos(phi), x), std::copysign(sin_t * std::sin(phi), y), upper ? z : -z};
}

// The point of [0,1]^2 that equal_area_square_to_sphere takes to the unit direction d.
inline Vec2 equal_area_sphere_to_square(const Vec3& d)
{
    const float ax = std::fabs(d.x);
    const float ay = std::fabs(d.y);
    const float r = std::min(1.0f, std::sqrt((ax * ax + ay * ay) / (1.0f + std::fabs(d.z))));
    const float share = std::min(1.0f, std::atan2(ay, ax) * (2.0f * inv_pi));
    float v = share * r;
    float u = r - v;
    if (d.z < 0.0f) {
        const float mirrored = 1.0f - v;
        v = 1.0f - u;
        u = mirrored;
    }
    return {0.5f * (std::copysign(u, d.x) + 1.0f), 0.5f * (std::copysign(v, d.y) + 1.0f)};
}

// Brings a point at most one square outside of [0,1]^2 back into it, along the sphere: each edge of the square is glued
// to itself, mirrored at its middle. For looking up the neighbours of texels at the rim of an equal-area map.
inline Vec2 wrap_equal_area_square(Vec2 p)
{
    if (p.x < 0.0f || p.x > 1.0f) {
        p.x = p.x < 0.0f ? -p.x : 2.0f - p.x;
        p.y = 1.0f - p.y;
    }
    if (p.y < 0.0f || p.y > 1.0f) {
        p.y = p.y < 0.0f ? -p.y : 2.0f - p.y;
        p.x = 1.0f - p.x;
    }
    return p;
}

}  // namespace dapple
