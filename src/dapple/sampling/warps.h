// Maps from the unit square to discs, spheres, cones and triangles, each with its density and its inverse. All are area
// preserving up to the constant (or cosine) density named, and continuous, so stratified points stay stratified.
// Concentric disc: Shirley and Chiu 1997, "A low distortion map between disk and square". Triangle: Heitz 2019, "A
// low-distortion map between triangle and square". Cost: one sine and cosine at most, for discs two short polynomials.
#pragma once

#include "dapple/math/frame.h"
#include "dapple/math/vec.h"

namespace dapple {

// A point of the unit disc, uniform in area (density pdf_disk).
inline Vec2 sample_disk_concentric(const Vec2& u)
{
    const float x = 2.0f * u.x - 1.0f;
    const float y = 2.0f * u.y - 1.0f;
    if (x == 0.0f && y == 0.0f) return {0.0f, 0.0f};
    // The choice between two halves of the square is a coin toss, which no branch could foresee.
    const bool wide = std::fabs(x) > std::fabs(y);
    const float radius = wide ? x : y;
    const float angle = (pi / 4.0f) * ((wide ? y : x) / radius);
    // Polynomials through (sin t) / t and cos t at the Chebyshev nodes of [-pi/4, pi/4]: within 1.2e-8 before rounding.
    const float t2 = angle * angle;
    const float sine = angle * (((-0x1.9ac9b0p-13f * t2 + 0x1.110c28p-7f) * t2 - 0x1.555552p-3f) * t2 + 1.0f);
    const float cosine = (((0x1.9a6f2cp-16f * t2 - 0x1.6c0e08p-10f) * t2 + 0x1.55554cp-5f) * t2 - 0.5f) * t2 + 1.0f;
    return {radius * (wide ? cosine : sine), radius * (wide ? sine : cosine)};
}
// Density of sample_disk_concentric per unit area of the unit disc.
inline float pdf_disk() { return inv_pi; }
// The u that sample_disk_concentric maps to p, a point of the unit disc.
inline Vec2 invert_disk_concentric(const Vec2& p)
{
    const float r = std::sqrt(p.x * p.x + p.y * p.y);
    if (r == 0.0f) return {0.5f, 0.5f};
    float x, y;
    if (std::fabs(p.x) > std::fabs(p.y)) {
        x = std::copysign(r, p.x);
        y = x * (4.0f * inv_pi) * std::atan(p.y / p.x);
    } else {
        y = std::copysign(r, p.y);
        x = y * (4.0f * inv_pi) * std::atan(p.x / p.y);
    }
    return {clamp01(0.5f * (x + 1.0f)), clamp01(0.5f * (y + 1.0f))};
}

// A unit direction of the hemisphere z >= 0 with density pdf_cosine_hemisphere (Malley's method).
inline Vec3 sample_cosine_hemisphere(const Vec2& u)
{
    const Vec2 p = sample_disk_concentric(u);
    return {p.x, p.y, safe_sqrt(1.0f - p.x * p.x - p.y * p.y)};
}
// Density per solid angle [1/sr] at cosine cos_theta to the z axis; 0 below the horizon.
inline float pdf_cosine_hemisphere(float cos_theta_z) { return std::max(0.0f, cos_theta_z) * inv_pi; }
// The u that sample_cosine_hemisphere maps to w.
inline Vec2 invert_cosine_hemisphere(const Vec3& w) { return invert_disk_concentric({w.x, w.y}); }

namespace detail {

// A unit direction at height z whose azimuth is 2 pi u; one_minus_z is given apart, for accuracy near the pole.
inline Vec3 direction_at_height(float z, float one_minus_z, float u)
{
    return spherical_direction(safe_sqrt(one_minus_z * (1.0f + z)), z, 2.0f * pi * u);
}
// Azimuth of w as a fraction of the circle in [0, 1).
inline float azimuth_fraction(const Vec3& w)
{
    const float fraction = std::atan2(w.y, w.x) * (0.5f * inv_pi);
    return std::min(fraction < 0.0f ? fraction + 1.0f : fraction, one_minus_epsilon);
}

}  // namespace detail

// A unit direction of the hemisphere z >= 0, uniform in solid angle.
inline Vec3 sample_uniform_hemisphere(const Vec2& u) { return detail::direction_at_height(1.0f - u.x, u.x, u.y); }
// Density of sample_uniform_hemisphere [1/sr] for directions with z >= 0.
inline float pdf_uniform_hemisphere() { return 0.5f * inv_pi; }
inline Vec2 invert_uniform_hemisphere(const Vec3& w) { return {clamp01(1.0f - w.z), detail::azimuth_fraction(w)}; }

// A unit direction, uniform over the sphere.
inline Vec3 sample_uniform_sphere(const Vec2& u)
{
    return detail::direction_at_height(1.0f - 2.0f * u.x, 2.0f * u.x, u.y);
}
// Density of sample_uniform_sphere [1/sr].
inline float pdf_uniform_sphere() { return 0.25f * inv_pi; }
inline Vec2 invert_uniform_sphere(const Vec3& w) { return {clamp01(0.5f * (1.0f - w.z)), detail::azimuth_fraction(w)}; }

// A unit direction within the cone around +z whose edge has 1 - cosine = one_minus_cos_max (> 0), uniform in solid
// angle. Narrow cones (a distant sun) keep full precision where a cosine near 1 would not.
inline Vec3 sample_uniform_cone_versine(const Vec2& u, float one_minus_cos_max)
{
    const float one_minus_z = u.x * one_minus_cos_max;
    return detail::direction_at_height(1.0f - one_minus_z, one_minus_z, u.y);
}
// Density of sample_uniform_cone_versine [1/sr] inside the cone.
inline float pdf_uniform_cone_versine(float one_minus_cos_max) { return 1.0f / (2.0f * pi * one_minus_cos_max); }

// A unit direction within the cone around +z whose edge has the cosine cos_theta_max (< 1), uniform in solid angle.
inline Vec3 sample_uniform_cone(const Vec2& u, float cos_theta_max)
{
    return sample_uniform_cone_versine(u, 1.0f - cos_theta_max);
}
// Density of sample_uniform_cone [1/sr] inside the cone.
inline float pdf_uniform_cone(float cos_theta_max) { return pdf_uniform_cone_versine(1.0f - cos_theta_max); }
// The u that sample_uniform_cone maps to w.
inline Vec2 invert_uniform_cone(const Vec3& w, float cos_theta_max)
{
    return {clamp01((1.0f - w.z) / (1.0f - cos_theta_max)), detail::azimuth_fraction(w)};
}

// Barycentric coordinates (of vertices 0, 1, 2; sum 1) of a point uniform in the triangle's area: density 1 / area.
inline Vec3 sample_triangle(const Vec2& u)
{
    float b0, b1;
    if (u.x < u.y) {
        b0 = 0.5f * u.x;
        b1 = u.y - b0;
    } else {
        b1 = 0.5f * u.y;
        b0 = u.x - b1;
    }
    return {b0, b1, std::max(0.0f, 1.0f - b0 - b1)};
}
// The u that sample_triangle maps to the barycentric coordinates b.
inline Vec2 invert_triangle(const Vec3& b)
{
    if (b.x < b.y) return {2.0f * b.x, b.y + b.x};
    return {b.x + b.y, 2.0f * b.y};
}

}  // namespace dapple
