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

// The directions from the reference to the vertices; false when the reference is a vertex.
bool vertex_directions(const Primitive& primitive, const Vec3& reference, Vec3d directions[3])
{
    for (int i = 0; i < 3; ++i) {
        directions[i] = to_double(primitive.p[i]) - to_double(reference);
        const double len = directions[i].length();
        if (!(len > 0.0)) return false;
        directions[i] /= len;
    }
    return true;
}

// The part of v orthogonal to the unit vector axis, normalised; zero when they are parallel.
Vec3d orthogonal_part(const Vec3d& v, const Vec3d& axis)
{
    const Vec3d part = v - axis * v.dot(axis);
    const double len = part.length();
    return len > 0.0 ? part / len : Vec3d(0.0);
}

// A direction uniform in the spherical triangle abc of the given solid angle (Arvo's names: the sub-triangle of area
// u.x * solid_angle with vertex c' on the arc ac, then a point on the arc from b to c').
Vec3d sample_spherical_triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c, double solid_angle, const Vec2& u)
{
    const Vec3d ab = orthogonal_part(b, a);
    const Vec3d ac = orthogonal_part(c, a);
    const double cos_alpha = std::clamp(ab.dot(ac), -1.0, 1.0);
    const double sin_alpha = ab.cross(ac).length();
    const double alpha = std::atan2(sin_alpha, cos_alpha);

    const double angle = u.x * solid_angle - alpha;
    const double s = std::sin(angle);
    const double t = std::cos(angle);
    const double k_u = t - cos_alpha;
    const double k_v = s + sin_alpha * a.dot(b);
    const double denominator = (k_v * s + k_u * t) * sin_alpha;
    const double numerator = (k_v * t - k_u * s) * cos_alpha - k_v;
    // 0/0 at u.x = 0, where the sub-triangle is empty and c' is a.
    const double q = denominator != 0.0 ? std::clamp(numerator / denominator, -1.0, 1.0) : 1.0;
    const Vec3d c_sub = a * q + ac * std::sqrt(1.0 - q * q);

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

SurfacePoint triangle_primitive_surface_point(const Primitive& primitive, const Vec2& barycentrics, float time)
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
    return mesh_surface_point(triangle, barycentrics, time);
}

ShapeSample triangle_sample_area(const Primitive& primitive, const Vec2& u)
{
    const Vec3 b = sample_triangle(u);
    ShapeSample sample = to_sample(triangle_primitive_surface_point(primitive, Vec2(b.y, b.z), 0.0f));
    const double total = triangle_area(primitive);
    sample.pdf = total > 0.0 ? static_cast<float>(1.0 / total) : 0.0f;
    return sample;
}

double triangle_sampled_solid_angle(const Primitive& primitive, const Vec3& reference)
{
    Vec3d d[3];
    if (!vertex_directions(primitive, reference, d)) return 0.0;
    const double volume = std::abs(d[0].dot(d[1].cross(d[2])));
    const double solid_angle = 2.0 * std::atan2(volume, 1.0 + d[0].dot(d[1]) + d[1].dot(d[2]) + d[2].dot(d[0]));
    return solid_angle >= min_solid_angle && solid_angle <= max_solid_angle ? solid_angle : 0.0;
}

bool triangle_sample_solid_angle(const Primitive& primitive, const Vec3& reference, const Vec2& u, double solid_angle,
                                 ShapeSample& sample)
{
    Vec3d d[3];
    if (!vertex_directions(primitive, reference, d)) return false;
    const Vec3d direction = sample_spherical_triangle(d[0], d[1], d[2], solid_angle, u);

    // Where the direction meets the triangle: Cramer's rule, with the reference as origin.
    const Vec3d to_p0 = to_double(primitive.p[0]) - to_double(reference);
    const Vec3d e1 = to_double(primitive.p[1]) - to_double(primitive.p[0]);
    const Vec3d e2 = to_double(primitive.p[2]) - to_double(primitive.p[0]);
    const Vec3d h = direction.cross(e2);
    const double det = e1.dot(h);
    if (det == 0.0) return false;
    double b1 = std::clamp(-to_p0.dot(h) / det, 0.0, 1.0);
    double b2 = std::clamp(-direction.dot(to_p0.cross(e1)) / det, 0.0, 1.0);
    if (b1 + b2 > 1.0) {
        const double sum = b1 + b2;
        b1 /= sum;
        b2 /= sum;
    }
    sample = to_sample(
        triangle_primitive_surface_point(primitive, Vec2(static_cast<float>(b1), static_cast<float>(b2)), 0.0f));
    sample.pdf = static_cast<float>(1.0 / solid_angle);
    return true;
}

}  // namespace dapple::detail
