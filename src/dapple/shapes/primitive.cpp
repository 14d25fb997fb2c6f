// Dispatch over the kinds of primitives, and the conversion of area densities to solid angle.
#include "dapple/shapes/primitive.h"

#include "dapple/shapes/primitive_kinds.h"

namespace dapple {
namespace {

using Kind = Primitive::Kind;

// Density per solid angle of a point sampled with density pdf per area: times distance^2 over cosine. 0 where the
// surface is seen edge-on or the distance vanishes.
float area_to_solid_angle(float pdf, const Vec3& reference, const Vec3& at, const Vec3& wi, const Vec3& n)
{
    const float density = pdf * length_squared(at - reference) / abs_dot(n, wi);
    return std::isfinite(density) ? density : 0.0f;
}

}  // namespace

Box3 bounds(const Primitive& primitive)
{
    if (primitive.kind != Kind::triangle && primitive.kind != Kind::bilinear) return detail::quadric_bounds(primitive);
    Box3 box;
    for (int i = 0; i < (primitive.kind == Kind::triangle ? 3 : 4); ++i) box.extendBy(primitive.p[i]);
    // Interpolated positions may round beyond the vertices by one unit in the last place.
    for (int axis = 0; axis < 3; ++axis) {
        box.min[axis] = std::nextafter(box.min[axis], -infinity);
        box.max[axis] = std::nextafter(box.max[axis], infinity);
    }
    return box;
}

float area(const Primitive& primitive)
{
    switch (primitive.kind) {
        case Kind::triangle: return static_cast<float>(detail::triangle_area(primitive));
        case Kind::bilinear: return static_cast<float>(detail::patch_area(primitive));
        default: return static_cast<float>(detail::quadric_area(primitive));
    }
}

bool intersect(const Primitive& primitive, const Ray& ray, float t_min, float t_max, PrimitiveHit& hit)
{
    switch (primitive.kind) {
        case Kind::triangle: return false;
        case Kind::bilinear: return detail::patch_intersect(primitive, ray, t_min, t_max, hit);
        default: return detail::quadric_intersect(primitive, ray, t_min, t_max, hit);
    }
}

bool meet(const Primitive& primitive, const Ray& ray, float t_min, float t_max, PrimitiveHit& hit)
{
    if (!detail::is_whole_sphere(primitive)) return intersect(primitive, ray, t_min, t_max, hit);
    return detail::sphere_meet(primitive, ray, t_min, t_max, hit.t);
}

SurfacePoint surface_point(const Primitive& primitive, const PrimitiveHit& hit, float time)
{
    switch (primitive.kind) {
        case Kind::triangle: return detail::triangle_primitive_surface_point(primitive, hit.uv, time);
        case Kind::bilinear: return detail::patch_surface_point(primitive, hit.uv, time);
        default: return detail::quadric_surface_point(primitive, hit.uv, time);
    }
}

SurfacePoint surface_point(const Primitive& primitive, const Ray& ray, const PrimitiveHit& hit, SurfaceDetail wanted)
{
    if (primitive.kind == Kind::triangle || primitive.kind == Kind::bilinear)
        return surface_point(primitive, hit, ray.time);
    const detail::Vec3d near =
        detail::to_double(ray.origin) + detail::to_double(ray.direction) * static_cast<double>(hit.t);
    return detail::quadric_surface_point_near(primitive, near, ray.time, wanted);
}

SampledShape::SampledShape(const Primitive& shape) : primitive(shape)
{
    whole_sphere = detail::is_whole_sphere(shape);
    if (shape.kind == Kind::triangle) detail::prepare_triangle(*this);
}

ShapeSample sample_area(const SampledShape& shape, const Vec2& u)
{
    switch (shape.primitive.kind) {
        case Kind::triangle: return detail::triangle_sample_area(shape, u);
        case Kind::bilinear: return detail::patch_sample_area(shape.primitive, u);
        default: return detail::quadric_sample_area(shape.primitive, u);
    }
}

float pdf_area(const SampledShape& shape, const Vec3& position)
{
    switch (shape.primitive.kind) {
        case Kind::triangle: return shape.density;
        case Kind::bilinear: return detail::patch_pdf_area(shape.primitive, position);
        default: return detail::quadric_pdf_area(shape.primitive, position);
    }
}

bool sample_solid_angle(const SampledShape& shape, const Vec3& reference, const Vec2& u, ShapeSample& sample)
{
    if (shape.whole_sphere) return detail::sphere_sample_solid_angle(shape.primitive, reference, u, sample);
    detail::SphericalTriangle triangle;
    if (detail::find_spherical_triangle(shape, reference, triangle))
        return detail::triangle_sample_solid_angle(shape, triangle, u, sample);
    sample = sample_area(shape, u);
    const Vec3 wi = normalize(sample.position - reference);
    sample.pdf = area_to_solid_angle(sample.pdf, reference, sample.position, wi, sample.normal);
    return sample.pdf > 0.0f;
}

float pdf_solid_angle(const SampledShape& shape, const Vec3& reference, const Vec3& wi, const Vec3& at, const Vec3& n)
{
    if (shape.whole_sphere) return detail::sphere_pdf_solid_angle(shape.primitive, reference, wi);
    detail::SphericalTriangle triangle;
    if (detail::find_spherical_triangle(shape, reference, triangle))
        return static_cast<float>(1.0 / triangle.solid_angle);
    return area_to_solid_angle(pdf_area(shape, at), reference, at, wi, n);
}

}  // namespace dapple
