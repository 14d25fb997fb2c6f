// Double-precision helpers of the shapes room: where positions are found and densities cancel, single precision would
// need error analysis of its own.
#pragma once

#include "dapple/math/transform.h"
#include "dapple/math/vec.h"

namespace dapple::detail {

using Vec3d = Imath::V3d;

inline constexpr double pi_d = 3.14159265358979323846;

inline Vec3d to_double(const Vec3& v) { return Vec3d(v.x, v.y, v.z); }
inline Vec3 to_float(const Vec3d& v)
{
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

// Affine transforms of points, vectors and normals (the latter by the inverse's transpose, not normalised).
inline Vec3d transform_vector(const Matrix4& matrix, const Vec3d& v)
{
    const auto& m = matrix.m;
    return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
            m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}
inline Vec3d transform_point(const Matrix4& matrix, const Vec3d& p)
{
    return transform_vector(matrix, p) + Vec3d(matrix.m[0][3], matrix.m[1][3], matrix.m[2][3]);
}
inline Vec3d transform_normal(const Matrix4& inverse, const Vec3d& n)
{
    const auto& m = inverse.m;
    return {m[0][0] * n.x + m[1][0] * n.y + m[2][0] * n.z, m[0][1] * n.x + m[1][1] * n.y + m[2][1] * n.z,
            m[0][2] * n.x + m[1][2] * n.y + m[2][2] * n.z};
}

// The derivative of N / |N| when N changes by dN.
inline Vec3d normalized_change(const Vec3d& normal, const Vec3d& change)
{
    const double len2 = normal.dot(normal);
    if (!(len2 > 0.0)) return Vec3d(0.0);
    return (change - normal * (normal.dot(change) / len2)) / std::sqrt(len2);
}

// The integral of f over [a,b] by `panels` panels of three-point Gauss quadrature.
template <class F>
double integrate(const F& f, double a, double b, int panels)
{
    const double half = 0.5 * (b - a) / panels;
    const double node = half * 0.77459666924148337704;  // sqrt(3/5)
    double sum = 0.0;
    for (int i = 0; i < panels; ++i) {
        const double middle = a + (2 * i + 1) * half;
        sum += 5.0 * f(middle - node) + 8.0 * f(middle) + 5.0 * f(middle + node);
    }
    return sum * half / 9.0;
}

}  // namespace dapple::detail
