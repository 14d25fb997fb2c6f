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
    Vec3 origin = p + offset;
    // Round away from the surface: the addition above may have rounded back onto it.
    for (int axis = 0; axis < 3; ++axis) {
        if (offset[axis] != 0.0f) origin[axis] = next_float(origin[axis], offset[axis] > 0.0f);
    }
    return origin;
}

}  // namespace dapple
