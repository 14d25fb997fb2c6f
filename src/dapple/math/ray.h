// Rays and robust ray origins.
#pragma once

#include "dapple/math/vec.h"

#include <bit>
#include <cstdint>

namespace dapple {

struct Ray {
    Vec3 origin{0, 0, 0};
    Vec3 direction{0, 0, 1};  // unit length where a distance is read from t
    float time = 0.0f;        // in [0, 1] over the shutter interval

    Vec3 at(float t) const { return origin + direction * t; }
};

// The float next to finite x on the side of +infinity (up) or -infinity: std::nextafter without the call.
inline float next_float(float x, bool up)
{
    if (x == 0.0f) return up ? 0x1p-149f : -0x1p-149f;
    const auto bits = std::bit_cast<int32_t>(x);
    return std::bit_cast<float>((x > 0.0f) == up ? bits + 1 : bits - 1);
}

// Where a ray may leave a surface without meeting it again: `p` moved along the geometric normal, to the side of
// `direction`, by more than the error bound of p (an absolute bound per axis, see SurfacePoint::error).
inline Vec3 offset_ray_origin(const Vec3& p, const Vec3& error, const Vec3& n_geometric, const Vec3& direction)
{
    const float distance = dot(abs(n_geometric), error);
    const Vec3 offset = n_geometric * (dot(direction, n_geometric) < 0.0f ? -distance : distance);
    // Round away from the surface: the addition may have rounded back onto it. Three axes at once, and without
    // branches, which no processor could foresee: next_float where the offset is not 0.
    typedef float Float4 __attribute__((vector_size(16)));
    typedef int32_t Int4 __attribute__((vector_size(16)));
    const Float4 by{offset.x, offset.y, offset.z, 0.0f};
    const Float4 origin = Float4{p.x, p.y, p.z, 0.0f} + by;
    const Int4 bits = std::bit_cast<Int4>(origin);
    const Int4 up = by > 0.0f;
    const Int4 step = 1 | ~(up ^ (bits < 0));  // 1 or, where next_float goes to smaller bits, -1
    const Int4 next = origin == 0.0f ? (up ? Int4{} + 1 : Int4{} + INT32_MIN + 1) : bits + step;
    const Int4 result = by != 0.0f ? next : bits;
    const auto moved = std::bit_cast<Float4>(result);
    return {moved[0], moved[1], moved[2]};
}

}  // namespace dapple
