// Triangles as light sources: sampling by area, and by solid angle after Arvo 1995, "Stratified sampling of spherical
// triangles". The solid angle is that of Van Oosterom and Strackee 1983. All angles are taken in double precision,
// which holds the relative error of direction and density below 1e-6 in the range used: below 3e-4 sr a triangle is so
// small that area sampling is as good unless it is seen edge-on, above 6.22 sr (almost a half space) the formula
// degenerates.
#include "dapple/sampling/warps.h"
#include "dapple/shapes/mesh.h"
#include "dapple/shapes/primitive_kinds.h"

namespace dapple::detail {
namespace {

constexpr double min_solid_angle = 3e-4;
constexpr double max_solid_angle = 6.22;

// The part of v orthogonal to the unit vector axis, normalised; zero when they are parallel.
Vec3d orthogonal_part(const Vec3d& v, const Vec3d& axis)
{
    const Vec3d part = v - axis * v.dot(axis);
    const double len2 = part.dot(part);
    return len2 > 0.0 ? part * (1.0 / std::sqrt(len2)) : Vec3d(0.0);
}

// A direction uniform in the spherical triangle abc (Arvo's names: the sub-triangle of area phi = u.x * solid angle
// with vertex c' on the arc ac, then a point on the arc from b to c'). Arvo's s and t, sine and cosine of phi - alpha,
// come from those of phi by the addition theorem, which needs no alpha.
Vec3d sample_spherical_triangle(const SphericalTriangle& triangle, const Vec2& u)
{
    const auto& [a, b, c] = triangle.directions;
    const double cos_ab = a.dot(b);
    // Sine and cosine of the angle alpha at a, both times the sines of the sides ab and ac.
    const double scaled_sin = triangle.volume;
    const double scaled_cos = b.dot(c) - cos_ab * a.dot(c);
    const double scale2 = scaled_sin * scaled_sin + scaled_cos * scaled_cos;
    const double inv_scale = scale2 > 0.0 ? 1.0 / std::sqrt(scale2) : 0.0;
    const double sin_alpha = scaled_sin * inv_scale;
    const double cos_alpha = scaled_cos * inv_scale;

    const double phi = u.x * triangle.solid_angle;
    const double sin_phi = std::sin(phi);
    const double cos_phi = std::cos(phi);
    const double s = sin_phi * cos_alpha - cos_phi * sin_alpha;
    const double t = cos_phi * cos_alpha + sin_phi * sin_alpha;
    const double k_u = t - cos_alpha;
    const double k_v = s + sin_alpha * cos_ab;
    const double denominator = (k_v * s + k_u * t) * sin_alpha;
    const double numerator = (k_v * t - k_u * s) * cos_alpha - k_v;
    // 0/0 at u.x = 0, where the sub-triangle is empty and c' is a.
    const double q = denominator != 0.0 ? std::clamp(numerator / denominator, -1.0, 1.0) : 1.0;
    const Vec3d c_sub = a * q + orthogonal_part(c, a) * std::sqrt(1.0 - q * q);

    const double one_minus_z = u.y * (1.0 - c_sub.dot(b));
    const double z = 1.0 - one_minus_z;
    return b * z + orthogonal_part(c_sub, b) * std::sqrt(std::max(0.0, one_minus_z * (1.0 + z)));
}

}  // namespace

double triangle_area(const Primitive& primitive)
{
    const Vec3d p0 = to_double(primitive.p[0]);
    return 0.5 * (to_double(primitive.p[1]) - p0).cross(to_double(primitive.p[2]) - p0).length();
}

SurfacePoint triangle_primitive_surface_point(const Primitive& primitive, const Vec2& barycentrics, float time,
                                              SurfaceDetail detail)
{
    MeshTriangle triangle;
    for (int i = 0; i < 3; ++i) {
        triangle.p[i] = primitive.p[i];
        triangle.n[i] = primitive.n[i];
        triangle.uv[i] = primitive.uv[i];
    }
    triangle.has_normals = primitive.has_normals;
    triangle.has_uv = primitive.has_uv;
    triangle.flip = primitive.flip;
    return mesh_surface_point(triangle, barycentrics, time, detail);
}

ShapeSample triangle_sample_area(const Primitive& primitive, const Vec2& u)
{
    const Vec3 b = sample_triangle(u);
    ShapeSample sample =
        to_sample(triangle_primitive_surface_point(primitive, Vec2(b.y, b.z), 0.0f, SurfaceDetail::no_tangents));
    const double total = triangle_area(primitive);
    sample.pdf = total > 0.0 ? static_cast<float>(1.0 / total) : 0.0f;
    return sample;
}

bool find_spherical_triangle(const Primitive& primitive, const Vec3& reference, SphericalTriangle& triangle)
{
    auto& d = triangle.directions;
    for (int i = 0; i < 3; ++i) {
        d[i] = to_double(primitive.p[i]) - to_double(reference);
        const double len2 = d[i].dot(d[i]);
        if (!(len2 > 0.0)) return false;
        d[i] *= 1.0 / std::sqrt(len2);
    }
    triangle.volume = std::abs(d[0].dot(d[1].cross(d[2])));
    // The ratio is exact enough; its arc tangent only has to be as good as the density, which is a float.
    const auto cosines = static_cast<float>(1.0 + d[0].dot(d[1]) + d[1].dot(d[2]) + d[2].dot(d[0]));
    triangle.solid_angle = 2.0 * std::atan2(static_cast<float>(triangle.volume), cosines);
    return triangle.solid_angle >= min_solid_angle && triangle.solid_angle <= max_solid_angle;
}

bool triangle_sample_solid_angle(const Primitive& primitive, const Vec3& reference, const SphericalTriangle& triangle,
                                 const Vec2& u, ShapeSample& sample)
{
    const Vec3d direction = sample_spherical_triangle(triangle, u);

    // Where the direction meets the triangle: Cramer's rule, with the reference as origin.
    const Vec3d p0 = to_double(primitive.p[0]);
    const Vec3d to_p0 = p0 - to_double(reference);
    const Vec3d e1 = to_double(primitive.p[1]) - p0;
    const Vec3d e2 = to_double(primitive.p[2]) - p0;
    const Vec3d h = direction.cross(e2);
    const double det = e1.dot(h);
    if (det == 0.0) return false;
    const double inv_det = 1.0 / det;
    double b1 = std::clamp(-to_p0.dot(h) * inv_det, 0.0, 1.0);
    double b2 = std::clamp(-direction.dot(to_p0.cross(e1)) * inv_det, 0.0, 1.0);
    if (b1 + b2 > 1.0) {
        const double sum = b1 + b2;
        b1 /= sum;
        b2 /= sum;
    }
    const Vec2 barycentrics(static_cast<float>(b1), static_cast<float>(b2));
    sample = to_sample(triangle_primitive_surface_point(primitive, barycentrics, 0.0f, SurfaceDetail::no_tangents));
    sample.pdf = static_cast<float>(1.0 / triangle.solid_angle);
    return true;
}

}  // namespace dapple::detail
