// Orthonormal frames: s, t span the tangent plane, n is the normal (the local z axis).
#pragma once

#include "dapple/math/vec.h"

namespace dapple {

struct Frame {
    Vec3 s{1, 0, 0};
    Vec3 t{0, 1, 0};
    Vec3 n{0, 0, 1};

    Frame() = default;
    Frame(const Vec3& s_axis, const Vec3& t_axis, const Vec3& n_axis) : s(s_axis), t(t_axis), n(n_axis) {}

    // Any frame around the unit vector n (Duff et al. 2017, "Building an orthonormal basis, revisited").
    explicit Frame(const Vec3& normal) : n(normal)
    {
        const float sign = std::copysign(1.0f, n.z);
        const float a = -1.0f / (sign + n.z);
        const float b = n.x * n.y * a;
        s = Vec3(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
        t = Vec3(b, sign + n.y * n.y * a, -n.y);
    }

    // The frame around unit normal n whose s axis follows `tangent` as far as orthogonality allows.
    static Frame from_normal_tangent(const Vec3& normal, const Vec3& tangent)
    {
        const Vec3 s_raw = tangent - normal * dot(normal, tangent);
        const float len2 = length_squared(s_raw);
        // Below this the difference is rounding alone and says nothing about the tangent.
        if (!(len2 > 1e-10f * length_squared(tangent))) return Frame(normal);
        const Vec3 s_rough = s_raw * (1.0f / std::sqrt(len2));
        // A tangent close to the normal leaves some of it behind: once more.
        const Vec3 s_axis = normalize(s_rough - normal * dot(normal, s_rough));
        return Frame(s_axis, cross(normal, s_axis), normal);
    }

    Vec3 to_local(const Vec3& v) const { return {dot(v, s), dot(v, t), dot(v, n)}; }
    Vec3 to_world(const Vec3& v) const { return s * v.x + t * v.y + n * v.z; }
};

// Trigonometry of a unit direction in a local frame (z is the normal).
inline float cos_theta(const Vec3& w) { return w.z; }
inline float abs_cos_theta(const Vec3& w) { return std::fabs(w.z); }
inline bool same_hemisphere(const Vec3& a, const Vec3& b) { return a.z * b.z > 0.0f; }

inline Vec3 spherical_direction(float sin_t, float cos_t, float phi)
{
    return {sin_t * std::cos(phi), sin_t * std::sin(phi), cos_t};
}

}  // namespace dapple
