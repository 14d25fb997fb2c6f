// Whole spheres by solid angle, also under uneven scales. Directions are chosen in object space, uniformly in the cone
// around the sphere (from within it: in all directions), and taken to world space, where the density changes by
// |det of the map on the sphere of directions| = |M d|^3 / |det M| for a unit object-space direction d. Under a
// similarity this is 1, and the density constant.
//
// Near and far keep their digits: the cone is held by its versine 1 - cos = sin^2 / (1 + cos), and the point on the
// sphere follows from its height above the centre, d sin^2 + cos sqrt(r^2 - d^2 sin^2), rather than from the difference
// of two long distances.
#include "dapple/sampling/warps.h"
#include "dapple/shapes/primitive_kinds.h"

namespace dapple::detail {
namespace {

// The sphere as seen from a reference, in object space.
struct View {
    Vec3d reference;
    double distance2;  // to the centre
    bool inside;
    float versine;  // 1 - cos of the cone's half angle, outside
};

View view_from(const Primitive& primitive, const Vec3& reference)
{
    View view;
    view.reference = transform_point(primitive.world_from_object.inverse_matrix(), to_double(reference));
    view.distance2 = view.reference.dot(view.reference);
    const double radius2 = sqr<double>(primitive.radius);
    view.inside = view.distance2 <= radius2;
    const double sin2 = view.inside ? 1.0 : radius2 / view.distance2;
    view.versine = static_cast<float>(sin2 / (1.0 + std::sqrt(1.0 - sin2)));
    return view;
}

// The object-space position in a direction given around the axis from the reference to the centre. False from the
// surface itself when the direction leaves it.
bool position_outside(double radius, const View& view, const Frame& frame, const Vec3& local, Vec3d& position)
{
    const double distance = std::sqrt(view.distance2);
    const double sin2 = std::min(static_cast<double>(local.x) * local.x + static_cast<double>(local.y) * local.y,
                                 radius * radius / view.distance2);
    const double half_chord = std::sqrt(std::max(0.0, radius * radius - view.distance2 * sin2));
    const double height = distance * sin2 + local.z * half_chord;  // from the centre towards the reference
    const double along = distance * local.z - half_chord;          // from the reference to the point
    position = (to_double(frame.s) * local.x + to_double(frame.t) * local.y) * along - to_double(frame.n) * height;
    return along > 0.0;
}

bool position_inside(double radius, const View& view, const Vec3& direction, Vec3d& position)
{
    const Vec3d d = to_double(direction);
    const double b = view.reference.dot(d) / d.dot(d);
    const double c = (view.distance2 - radius * radius) / d.dot(d);
    const double root = std::sqrt(std::max(0.0, b * b - c));
    const double t = b < 0.0 ? root - b : -c / (root + b);
    position = view.reference + d * t;
    return t > 1e-7 * radius;
}

}  // namespace

bool sphere_sample_solid_angle(const Primitive& primitive, const Vec3& reference, const Vec2& u, ShapeSample& sample)
{
    const View view = view_from(primitive, reference);
    const double radius = primitive.radius;
    Vec3d position;
    if (view.inside) {
        if (!position_inside(radius, view, sample_uniform_sphere(u), position)) return false;
    } else {
        const Frame frame(to_float(view.reference / -std::sqrt(view.distance2)));
        const Vec3 local = sample_uniform_cone_versine(u, view.versine);
        if (!position_outside(radius, view, frame, local, position)) return false;
    }
    const Vec3d world = transform_point(primitive.world_from_object.matrix(), position);
    sample = to_sample(quadric_surface_point_near(primitive, world, 0.0f));
    sample.pdf = sphere_pdf_solid_angle(primitive, reference, normalize(sample.position - reference));
    return sample.pdf > 0.0f;
}

float sphere_pdf_solid_angle(const Primitive& primitive, const Vec3& reference, const Vec3& wi)
{
    const View view = view_from(primitive, reference);
    const Transform& world = primitive.world_from_object;
    const double local_density = view.inside ? pdf_uniform_sphere() : pdf_uniform_cone_versine(view.versine);
    // wi is M d / |M d|, so M^-1 wi has the length 1 / |M d|.
    const double shrink = transform_vector(world.inverse_matrix(), to_double(wi)).length();
    const double density = local_density / (shrink * shrink * shrink * std::abs(determinant3(world.matrix())));
    return std::isfinite(density) ? static_cast<float>(density) : 0.0f;
}

}  // namespace dapple::detail
