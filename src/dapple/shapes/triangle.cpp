// Triangles as light sources: sampling by area, and by solid angle after Arvo 1995, "Stratified sampling of spherical
// triangles". The solid angle is that of Van Oosterom and Strackee 1983. All angles are taken in double precision,
// which holds the relative error of direction and density below 1e-6 in the range used: above 6.22 sr (almost a half
// space) the formula degenerates.
//
// By area where the triangle is far or tiny, at a quarter of the cost. What a point sends to a reference goes with
// h / d^3, where h is the reference's height above the triangle's plane and the same for all points: so the estimate
// varies with the distance d alone, however flat the view. From 3.5 radii on (farthest vertex to centroid) its relative
// variance is at most 0.14 (a sliver seen along its length), and 0.001 from the front.
#include "dapple/sampling/warps.h"
#include "dapple/shapes/mesh.h"
#include "dapple/shapes/packed.h"
#include "dapple/shapes/primitive_kinds.h"

namespace dapple::detail {
namespace {

constexpr double min_solid_angle = 3e-4;
constexpr double max_solid_angle = 6.22;
constexpr float far_radii = 3.5f;

// The angle of the point (x, y), y >= 0, seen from the origin: std::atan2 without its branches. The polynomial is
// through arctan t / t at the Chebyshev nodes of t^2 in [0, 1]: within 7e-08 of it before rounding.
inline float upper_angle(float y, float x)
{
    const float size = std::fabs(x);
    const float high = std::max(y, size);
    const float t = high > 0.0f ? std::min(y, size) / high : 0.0f;
    const float t2 = t * t;
    const float angle =
        t *
        ((((((((0.00386673887f * t2 - 0.0200267471f) * t2 + 0.0489143208f) * t2 - 0.0800968185f) * t2 + 0.108657591f) *
                t2 -
            0.142570451f) *
               t2 +
           0.199986815f) *
              t2 -
          0.333333224f) *
             t2 +
         1.0f);
    const float acute = y > size ? 0.5f * pi - angle : angle;
    return x < 0.0f ? pi - acute : acute;
}

// A direction uniform in the spherical triangle abc (Arvo's names: the sub-triangle of area phi = u.x * solid angle
// with vertex c' on the arc ac, then a point on the arc from b to c'), as weights of the unit vectors a, b and c: all
// of it can be had from the cosines between these. Arvo's s and t, sine and cosine of phi - alpha, come from those of
// phi by the addition theorem, which needs no alpha.
struct SphericalWeights {
    double a, b, c;
};
SphericalWeights sample_spherical_triangle(const SphericalTriangle& triangle, const Vec2& u)
{
    const double cos_ab = triangle.cos_ab, cos_ac = triangle.cos_ac;
    // Sine and cosine of the angle alpha at a, both times the sines of the sides ab and ac.
    const double scaled_sin = triangle.volume;
    const double scaled_cos = triangle.cos_bc - cos_ab * cos_ac;
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

    // c' = q a + sqrt(1 - q^2) o, where o is the unit vector of c's part orthogonal to a.
    const double on_c = triangle.sin2_ac > 0.0 ? std::sqrt((1.0 - q * q) / triangle.sin2_ac) : 0.0;
    const double on_a = q - cos_ac * on_c;
    // The direction at height z = 1 - u.y (1 - c'.b) above the plane of b, on the great circle through b and c'; the
    // ratio of sines sqrt(1 - z^2) / sqrt(1 - (c'.b)^2) loses its factors 1 - c'.b.
    const double cos_b = std::clamp(on_a * cos_ab + on_c * triangle.cos_bc, -1.0, 1.0);
    const double z = 1.0 - u.y * (1.0 - cos_b);
    const double ratio = cos_b > -1.0 ? std::sqrt(u.y * (1.0 + z) / (1.0 + cos_b)) : 0.0;
    return {on_a * ratio, z - cos_b * ratio, on_c * ratio};
}

TriangleCorners corners_of(const Primitive& primitive)
{
    return {.p = {&primitive.p[0], &primitive.p[1], &primitive.p[2]},
            .n = {&primitive.n[0], &primitive.n[1], &primitive.n[2]},
            .uv = {&primitive.uv[0], &primitive.uv[1], &primitive.uv[2]},
            .s = {},
            .has_normals = primitive.has_normals,
            .has_uv = primitive.has_uv,
            .has_tangents = false,
            .flip = primitive.flip};
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
    SurfacePoint point;
    triangle_surface_point(corners_of(primitive), barycentrics, time, detail, point);
    return point;
}

void prepare_triangle(SampledShape& shape)
{
    const Primitive& primitive = shape.primitive;
    const Vec3(&p)[4] = primitive.p;
    shape.center = (p[0] + p[1] + p[2]) * (1.0f / 3.0f);
    float radius2 = 0.0f;
    for (int i = 0; i < 3; ++i) radius2 = std::max(radius2, length_squared(p[i] - shape.center));
    shape.far_distance2 = sqr(far_radii) * radius2;
    const double total = triangle_area(primitive);
    shape.density = total > 0.0 ? static_cast<float>(1.0 / total) : 0.0f;
    const SurfacePoint any =
        triangle_primitive_surface_point(primitive, Vec2(1.0f / 3.0f), 0.0f, SurfaceDetail::no_tangents);
    shape.normal = any.n_geometric;
    shape.error = any.error;
    shape.one_sided = true;
    for (int i = 0; i < 3 && primitive.has_normals; ++i)
        shape.one_sided = shape.one_sided && dapple::dot(primitive.n[i], shape.normal) > 0.0f;
}

namespace {

// The point with barycentric coordinates (b1, b2) of vertices 1 and 2.
ShapeSample point_at(const SampledShape& shape, double b1, double b2)
{
    const Primitive& primitive = shape.primitive;
    if (!shape.one_sided) {
        const Vec2 barycentrics(static_cast<float>(b1), static_cast<float>(b2));
        return to_sample(triangle_primitive_surface_point(primitive, barycentrics, 0.0f, SurfaceDetail::no_tangents));
    }
    const Double4 p0 = widen(pack(primitive.p[0]));
    const Double4 e1 = widen(pack(primitive.p[1])) - p0;
    const Double4 e2 = widen(pack(primitive.p[2])) - p0;
    ShapeSample sample;
    sample.position = narrow(p0 + e1 * b1 + e2 * b2);
    sample.error = shape.error;
    sample.normal = shape.normal;
    const auto w1 = static_cast<float>(b1), w2 = static_cast<float>(b2);
    const Vec2(&uv)[4] = primitive.uv;
    sample.uv = primitive.has_uv ? uv[0] + (uv[1] - uv[0]) * w1 + (uv[2] - uv[0]) * w2 : Vec2(w1 + w2, w2);
    return sample;
}

}  // namespace

ShapeSample triangle_sample_area(const SampledShape& shape, const Vec2& u)
{
    const Vec3 b = sample_triangle(u);
    ShapeSample sample = point_at(shape, b.y, b.z);
    sample.pdf = shape.density;
    return sample;
}

bool find_spherical_triangle(const SampledShape& shape, const Vec3& reference, SphericalTriangle& triangle)
{
    if (shape.primitive.kind != Primitive::Kind::triangle) return false;
    if (length_squared(reference - shape.center) > shape.far_distance2) return false;
    // Lane i: the direction to vertex i, by components; the fourth lane repeats the first.
    const Vec3(&p)[4] = shape.primitive.p;
    Double4 x = widen(Float4{p[0].x, p[1].x, p[2].x, p[0].x}) - static_cast<double>(reference.x);
    Double4 y = widen(Float4{p[0].y, p[1].y, p[2].y, p[0].y}) - static_cast<double>(reference.y);
    Double4 z = widen(Float4{p[0].z, p[1].z, p[2].z, p[0].z}) - static_cast<double>(reference.z);
    const Double4 len2 = x * x + y * y + z * z;
    if (!(len2[0] > 0.0 && len2[1] > 0.0 && len2[2] > 0.0)) return false;
    Double4 inv_length;
    for (int i = 0; i < 4; ++i) inv_length[i] = std::sqrt(len2[i]);
    inv_length = 1.0 / inv_length;
    x *= inv_length;
    y *= inv_length;
    z *= inv_length;
    // The cosines ab, bc, ca.
    const Double4 next_x = __builtin_shufflevector(x, x, 1, 2, 0, 3);
    const Double4 next_y = __builtin_shufflevector(y, y, 1, 2, 0, 3);
    const Double4 next_z = __builtin_shufflevector(z, z, 1, 2, 0, 3);
    const Double4 cosines = x * next_x + y * next_y + z * next_z;
    triangle.volume = std::abs(x[0] * (y[1] * z[2] - z[1] * y[2]) + y[0] * (z[1] * x[2] - x[1] * z[2]) +
                               z[0] * (x[1] * y[2] - y[1] * x[2]));
    // The ratio is exact enough; its arc tangent only has to be as good as the density, which is a float.
    const auto sum = static_cast<float>(1.0 + cosines[0] + cosines[1] + cosines[2]);
    triangle.solid_angle = 2.0 * upper_angle(static_cast<float>(triangle.volume), sum);
    triangle.cos_ab = cosines[0];
    triangle.cos_bc = cosines[1];
    triangle.cos_ac = cosines[2];
    // By the chord: 1 - cos^2 would lose the digits of short sides.
    const double chord2 = (x[2] - x[0]) * (x[2] - x[0]) + (y[2] - y[0]) * (y[2] - y[0]) + (z[2] - z[0]) * (z[2] - z[0]);
    triangle.sin2_ac = chord2 * (1.0 - 0.25 * chord2);
    for (int i = 0; i < 3; ++i) triangle.inv_length[i] = inv_length[i];
    return triangle.solid_angle >= min_solid_angle && triangle.solid_angle <= max_solid_angle;
}

bool triangle_sample_solid_angle(const SampledShape& shape, const SphericalTriangle& triangle, const Vec2& u,
                                 ShapeSample& sample)
{
    // The direction is a sum of the vertices' directions; so is its point on the triangle, of the vertices themselves.
    const SphericalWeights direction = sample_spherical_triangle(triangle, u);
    const double w0 = std::max(0.0, direction.a * triangle.inv_length[0]);
    const double w1 = std::max(0.0, direction.b * triangle.inv_length[1]);
    const double w2 = std::max(0.0, direction.c * triangle.inv_length[2]);
    const double sum = w0 + w1 + w2;
    if (!(sum > 0.0)) return false;
    const double scale = 1.0 / sum;
    sample = point_at(shape, w1 * scale, w2 * scale);
    sample.pdf = static_cast<float>(1.0 / triangle.solid_angle);
    return true;
}

}  // namespace dapple::detail
