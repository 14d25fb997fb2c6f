// The pieces primitive.cpp dispatches to, one group per kind of primitive. Internal to the shapes room; the meaning of
// each function is that of its namesake in primitive.h.
#pragma once

#include "dapple/shapes/double_math.h"
#include "dapple/shapes/primitive.h"

namespace dapple::detail {

// Spheres, disks and cylinders (quadrics.cpp).
Box3 quadric_bounds(const Primitive& primitive);
double quadric_area(const Primitive& primitive);
bool quadric_intersect(const Primitive& primitive, const Ray& ray, float t_min, float t_max, PrimitiveHit& hit);
SurfacePoint quadric_surface_point(const Primitive& primitive, const Vec2& uv, float time);
// The surface point below a position near the quadric.
SurfacePoint quadric_surface_point_near(const Primitive& primitive, const Vec3d& near, float time,
                                        SurfaceDetail detail = SurfaceDetail::tangents);
ShapeSample quadric_sample_area(const Primitive& primitive, const Vec2& u);
float quadric_pdf_area(const Primitive& primitive, const Vec3& position);

// Whole spheres by solid angle (quadrics_solid_angle.cpp).
bool is_whole_sphere(const Primitive& primitive);
bool sphere_meet(const Primitive& primitive, const Ray& ray, float t_min, float t_max, float& t);
bool sphere_sample_solid_angle(const Primitive& primitive, const Vec3& reference, const Vec2& u, ShapeSample& sample);
float sphere_pdf_solid_angle(const Primitive& primitive, const Vec3& reference, const Vec3& wi);

// Bilinear patches (bilinear.cpp).
double patch_area(const Primitive& primitive);
bool patch_intersect(const Primitive& primitive, const Ray& ray, float t_min, float t_max, PrimitiveHit& hit);
SurfacePoint patch_surface_point(const Primitive& primitive, const Vec2& uv, float time);
ShapeSample patch_sample_area(const Primitive& primitive, const Vec2& u);
float patch_pdf_area(const Primitive& primitive, const Vec3& position);

// Triangles (triangle.cpp).
double triangle_area(const Primitive& primitive);
SurfacePoint triangle_primitive_surface_point(const Primitive& primitive, const Vec2& barycentrics, float time,
                                              SurfaceDetail detail = SurfaceDetail::tangents);
void prepare_triangle(SampledShape& shape);
ShapeSample triangle_sample_area(const SampledShape& shape, const Vec2& u);
// A triangle as a reference point sees it.
struct SphericalTriangle {
    double inv_length[3];           // of the vertices' distances
    double cos_ab, cos_bc, cos_ac;  // between the directions to them
    double sin2_ac;
    double volume;       // triple product of the directions, positive
    double solid_angle;  // [sr]
};
// False where the shape is to be sampled by area.
bool find_spherical_triangle(const SampledShape& shape, const Vec3& reference, SphericalTriangle& triangle);
bool triangle_sample_solid_angle(const SampledShape& shape, const SphericalTriangle& triangle, const Vec2& u,
                                 ShapeSample& sample);

// The part of a SurfacePoint that a ShapeSample holds; pdf is left 0.
inline ShapeSample to_sample(const SurfacePoint& point)
{
    ShapeSample sample;
    sample.position = point.position;
    sample.error = point.error;
    sample.normal = point.n_geometric;
    sample.uv = point.uv;
    return sample;
}

}  // namespace dapple::detail
