// Vectors and small helpers on top of Imath. Points, directions and normals are all Vec3; names say which is meant.
#pragma once

#include <Imath/ImathBox.h>
#include <Imath/ImathVec.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace dapple {

using Vec2 = Imath::V2f;
using Vec3 = Imath::V3f;
using Int2 = Imath::V2i;
using Box2 = Imath::Box2f;
using Box3 = Imath::Box3f;

inline constexpr float pi = 3.14159265358979323846f;
inline constexpr float inv_pi = 0.31830988618379067154f;
inline constexpr float one_minus_epsilon = 0x1.fffffep-1f;
inline constexpr float infinity = __builtin_huge_valf();

template <class T>
constexpr T sqr(T x)
{
    return x * x;
}

inline float dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline float abs_dot(const Vec3& a, const Vec3& b) { return std::fabs(dot(a, b)); }
inline Vec3 cross(const Vec3& a, const Vec3& b) { return a.cross(b); }
inline float length(const Vec3& v) { return std::sqrt(dot(v, v)); }
inline float length_squared(const Vec3& v) { return dot(v, v); }
inline Vec3 normalize(const Vec3& v) { return v * (1.0f / length(v)); }
inline Vec3 abs(const Vec3& v) { return {std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}; }
inline float max_component(const Vec3& v) { return std::max({v.x, v.y, v.z}); }
inline Vec3 lerp(float t, const Vec3& a, const Vec3& b) { return a * (1.0f - t) + b * t; }
inline float lerp(float t, float a, float b) { return a * (1.0f - t) + b * t; }
inline bool is_finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
// Returns n, flipped to the side of v.
inline Vec3 face_forward(const Vec3& n, const Vec3& v) { return dot(n, v) < 0.0f ? -n : n; }
inline float safe_sqrt(float x) { return std::sqrt(std::max(0.0f, x)); }
inline constexpr float radians(float degrees) { return degrees * (pi / 180.0f); }
inline constexpr float degrees(float rad) { return rad * (180.0f / pi); }
inline float clamp01(float x) { return std::clamp(x, 0.0f, 1.0f); }

// Angle between two unit vectors [rad], accurate near 0 and pi.
inline float angle_between(const Vec3& a, const Vec3& b)
{
    if (dot(a, b) < 0.0f) return pi - 2.0f * std::asin(std::min(1.0f, length(a + b) / 2.0f));
    return 2.0f * std::asin(std::min(1.0f, length(b - a) / 2.0f));
}

}  // namespace dapple
