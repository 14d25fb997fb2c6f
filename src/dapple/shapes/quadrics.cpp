// Spheres, disks and cylinders with pbrt's partial parameters, in double precision.
//
// Rays are taken to object space, where the quadric is round; roots come from the ray's point closest to the centre (or
// axis), which does not cancel far away. Positions are rebuilt from the parameters, so they lie on the surface to the
// last rounding. A linear map M stretches object-space area with normal n by |det M| |M^-T n|, which turns densities
// and areas into world space. Normals in world space are M^-T n (see Primitive::flip for why det M never shows).
#include "dapple/shapes/primitive_kinds.h"

namespace dapple::detail {
namespace {

using Kind = Primitive::Kind;

// Parameter ranges in double. Angles within 1e-6 of a full turn count as full: no slit from rounded radians.
struct Ranges {
    double z0, z1;          // sphere, cylinder
    double theta0, theta1;  // sphere: polar angles at v = 0 (z0) and v = 1 (z1)
    double phi_max;
    bool full_turn;
    bool cut_below, cut_above;  // sphere: z0 or z1 cuts something off
};

bool is_full_turn(const Primitive& primitive) { return primitive.phi_max > 2.0 * pi_d * (1.0 - 1e-6); }

Ranges ranges(const Primitive& primitive)
{
    Ranges r{};
    const double radius = primitive.radius;
    r.phi_max = primitive.phi_max;
    r.full_turn = is_full_turn(primitive);
    if (r.full_turn) r.phi_max = 2.0 * pi_d;
    r.z0 = std::min(primitive.z_min, primitive.z_max);
    r.z1 = std::max(primitive.z_min, primitive.z_max);
    if (primitive.kind == Kind::sphere) {
        r.cut_below = r.z0 > -radius;
        r.cut_above = r.z1 < radius;
        r.z0 = std::clamp(r.z0, -radius, radius);
        r.z1 = std::clamp(r.z1, -radius, radius);
        r.theta0 = std::acos(r.z0 / radius);
        r.theta1 = std::acos(r.z1 / radius);
    }
    return r;
}

// Position and derivatives in object space; normal is cross(dpdu, dpdv) normalised: away from the centre or axis, +z.
struct LocalPoint {
    Vec3d p, dpdu, dpdv, normal, dndu, dndv;
};

LocalPoint local_point(const Primitive& primitive, const Ranges& r, double u, double v)
{
    const double phi = u * r.phi_max;
    const double cos_phi = std::cos(phi);
    const double sin_phi = std::sin(phi);
    const double radius = primitive.radius;
    LocalPoint point;
    switch (primitive.kind) {
        case Kind::sphere: {
            const double d_theta = r.theta1 - r.theta0;
            const double theta = r.theta0 + v * d_theta;
            const double sin_t = std::sin(theta);
            point.normal = Vec3d(sin_t * cos_phi, sin_t * sin_phi, std::cos(theta));
            // At the poles dpdu vanishes; a small remainder keeps its direction.
            const double ring = std::max(sin_t, 1e-6);
            point.dndu = Vec3d(-ring * sin_phi, ring * cos_phi, 0.0) * r.phi_max;
            point.dndv = Vec3d(std::cos(theta) * cos_phi, std::cos(theta) * sin_phi, -sin_t) * d_theta;
            point.p = point.normal * radius;
            point.dpdu = point.dndu * radius;
            point.dpdv = point.dndv * radius;
            break;
        }
        case Kind::cylinder:
            point.normal = Vec3d(cos_phi, sin_phi, 0.0);
            point.p = Vec3d(radius * cos_phi, radius * sin_phi, r.z0 + v * (r.z1 - r.z0));
            point.dndu = Vec3d(-sin_phi, cos_phi, 0.0) * r.phi_max;
            point.dndv = Vec3d(0.0);
            point.dpdu = point.dndu * radius;
            point.dpdv = Vec3d(0.0, 0.0, r.z1 - r.z0);
            break;
        default: {
            const double inner = primitive.inner_radius;
            const double distance = radius + v * (inner - radius);
            point.normal = Vec3d(0.0, 0.0, 1.0);
            point.p = Vec3d(distance * cos_phi, distance * sin_phi, primitive.height);
            point.dpdu = Vec3d(-sin_phi, cos_phi, 0.0) * (std::max(distance, 1e-6 * radius) * r.phi_max);
            point.dpdv = Vec3d(cos_phi, sin_phi, 0.0) * (inner - radius);
            point.dndu = point.dndv = Vec3d(0.0);
            break;
        }
    }
    return point;
}

// The parameters of an object-space position on (or near) the whole quadric; false when it is cut away.
bool locate(const Primitive& primitive, const Ranges& r, const Vec3d& p, double& u, double& v)
{
    double phi = std::atan2(p.y, p.x);
    if (phi < 0.0) phi += 2.0 * pi_d;
    bool inside = r.full_turn || phi <= r.phi_max;
    const double distance = std::hypot(p.x, p.y);
    switch (primitive.kind) {
        case Kind::sphere:
            inside = inside && !(r.cut_below && p.z < r.z0) && !(r.cut_above && p.z > r.z1);
            v = (std::atan2(distance, p.z) - r.theta0) / (r.theta1 - r.theta0);
            break;
        case Kind::cylinder:
            inside = inside && p.z >= r.z0 && p.z <= r.z1;
            v = (p.z - r.z0) / (r.z1 - r.z0);
            break;
        default:
            inside = inside && distance <= primitive.radius && distance >= primitive.inner_radius;
            v = (primitive.radius - distance) / (static_cast<double>(primitive.radius) - primitive.inner_radius);
            break;
    }
    u = std::clamp(phi / r.phi_max, 0.0, 1.0);
    v = std::clamp(v, 0.0, 1.0);
    return inside;
}

// How much more world than object-space area an element with this object-space normal has.
double area_stretch(const Primitive& primitive, const Vec3d& normal)
{
    const Transform& world = primitive.world_from_object;
    return std::abs(determinant3(world.matrix())) * transform_normal(world.inverse_matrix(), normal).length();
}

// The object-space area of the part that remains.
double local_area(const Primitive& primitive, const Ranges& r)
{
    const double radius = primitive.radius;
    if (primitive.kind == Kind::disk) return 0.5 * r.phi_max * (radius * radius - sqr<double>(primitive.inner_radius));
    return r.phi_max * radius * (r.z1 - r.z0);  // spheres too (Archimedes)
}

// True when |M^-T n| is the same for all n, so that the area stretches evenly.
bool is_similarity(const Matrix4& matrix)
{
    const auto& m = matrix.m;
    const auto product = [&](int a, int b) { return m[0][a] * m[0][b] + m[1][a] * m[1][b] + m[2][a] * m[2][b]; };
    const double size = product(0, 0);
    const double tolerance = 1e-6 * size;
    return std::abs(product(1, 1) - size) < tolerance && std::abs(product(2, 2) - size) < tolerance &&
           std::abs(product(0, 1)) < tolerance && std::abs(product(1, 2)) < tolerance &&
           std::abs(product(0, 2)) < tolerance;
}

double outside_sign(const Primitive& primitive)
{
    return (determinant3(primitive.world_from_object.matrix()) < 0.0) != primitive.flip ? -1.0 : 1.0;
}

// What is wanted of a point at least; local_p and local_normal in object space.
SurfacePoint bare_point(const Primitive& primitive, const Vec3d& local_p, const Vec3d& local_normal, float time)
{
    const Matrix4& matrix = primitive.world_from_object.matrix();
    SurfacePoint point;
    point.time = time;
    const Vec3d position = transform_point(matrix, local_p);
    point.position = to_float(position);
    const Vec3d normal =
        transform_normal(primitive.world_from_object.inverse_matrix(), local_normal) * outside_sign(primitive);
    point.n_geometric = point.n_shading = to_float(normal / normal.length());
    // Rounding to single precision, and the double arithmetic of the transform where its terms cancel.
    for (int i = 0; i < 3; ++i) {
        const auto& row = matrix.m[i];
        const double terms =
            (std::abs(row[0]) + std::abs(row[1]) + std::abs(row[2])) * (primitive.radius + std::abs(local_p.z)) +
            std::abs(row[3]);
        point.error[i] = static_cast<float>(0x1p-22 * std::abs(position[i]) + 0x1p-46 * terms);
    }
    return point;
}

SurfacePoint to_world(const Primitive& primitive, const LocalPoint& local, double u, double v, float time)
{
    const Matrix4& matrix = primitive.world_from_object.matrix();
    const Matrix4& inverse = primitive.world_from_object.inverse_matrix();
    SurfacePoint point = bare_point(primitive, local.p, local.normal, time);
    point.uv = Vec2(static_cast<float>(u), static_cast<float>(v));
    point.dpdu = to_float(transform_vector(matrix, local.dpdu));
    point.dpdv = to_float(transform_vector(matrix, local.dpdv));
    const double sign = outside_sign(primitive);
    const Vec3d normal = transform_normal(inverse, local.normal) * sign;
    point.dndu = to_float(normalized_change(normal, transform_normal(inverse, local.dndu) * sign));
    point.dndv = to_float(normalized_change(normal, transform_normal(inverse, local.dndv) * sign));
    point.dpdu_shading = Frame::from_normal_tangent(point.n_shading, point.dpdu).s;
    return point;
}

// The roots t of an upright quadric whose rays see a circle: o and d are the coordinates in which it is one.
bool circle_roots(const Vec3d& o, const Vec3d& d, double radius, double roots[2])
{
    const double a = d.dot(d);
    if (!(a > 0.0)) return false;
    const double closest = -o.dot(d) / a;
    const Vec3d offset = o + d * closest;
    const double rest = radius * radius - offset.dot(offset);
    if (rest < 0.0) return false;
    const double half_chord = std::sqrt(rest / a);
    roots[0] = closest - half_chord;
    roots[1] = closest + half_chord;
    return true;
}

}  // namespace

Box3 quadric_bounds(const Primitive& primitive)
{
    const Ranges r = ranges(primitive);
    const auto& m = primitive.world_from_object.matrix().m;
    const double radius = primitive.radius;
    const double z0 = primitive.kind == Kind::disk ? primitive.height : r.z0;
    const double z1 = primitive.kind == Kind::disk ? primitive.height : r.z1;
    Box3 box;
    for (int i = 0; i < 3; ++i) {
        // The circles at both ends of the z range bound disks, cylinders and all of a sphere's zone inside the cylinder
        // around it; the whole sphere's own extent may be nearer.
        const double circle = radius * std::hypot(m[i][0], m[i][1]);
        double low = m[i][3] + std::min(m[i][2] * z0, m[i][2] * z1) - circle;
        double high = m[i][3] + std::max(m[i][2] * z0, m[i][2] * z1) + circle;
        if (primitive.kind == Kind::sphere) {
            const double extent = radius * std::sqrt(sqr(m[i][0]) + sqr(m[i][1]) + sqr(m[i][2]));
            low = std::max(low, m[i][3] - extent);
            high = std::min(high, m[i][3] + extent);
        }
        box.min[i] = std::nextafter(static_cast<float>(low), -infinity);
        box.max[i] = std::nextafter(static_cast<float>(high), infinity);
    }
    return box;
}

double quadric_area(const Primitive& primitive)
{
    const Ranges r = ranges(primitive);
    if (primitive.kind == Kind::disk || is_similarity(primitive.world_from_object.matrix()))
        return local_area(primitive, r) * area_stretch(primitive, Vec3d(0.0, 0.0, 1.0));
    constexpr int panels = 24;
    return integrate(
        [&](double u) {
            if (primitive.kind == Kind::cylinder)
                return local_area(primitive, r) * area_stretch(primitive, local_point(primitive, r, u, 0.5).normal);
            const auto ring = [&](double v) {
                const LocalPoint point = local_point(primitive, r, u, v);
                return point.dpdu.cross(point.dpdv).length() * area_stretch(primitive, point.normal);
            };
            return integrate(ring, 0.0, 1.0, panels);
        },
        0.0, 1.0, panels);
}

bool quadric_intersect(const Primitive& primitive, const Ray& ray, float t_min, float t_max, PrimitiveHit& hit)
{
    const Matrix4& inverse = primitive.world_from_object.inverse_matrix();
    const Vec3d o = transform_point(inverse, to_double(ray.origin));
    const Vec3d d = transform_vector(inverse, to_double(ray.direction));
    double roots[2];
    int count = 2;
    if (primitive.kind == Kind::sphere) {
        if (!circle_roots(o, d, primitive.radius, roots)) return false;
    } else if (primitive.kind == Kind::cylinder) {
        if (!circle_roots(Vec3d(o.x, o.y, 0.0), Vec3d(d.x, d.y, 0.0), primitive.radius, roots)) return false;
    } else {
        if (d.z == 0.0) return false;
        roots[0] = (primitive.height - o.z) / d.z;
        count = 1;
    }
    const Ranges r = ranges(primitive);
    for (int i = 0; i < count; ++i) {
        if (!(roots[i] > t_min && roots[i] < t_max)) continue;
        double u, v;
        if (!locate(primitive, r, o + d * roots[i], u, v)) continue;
        hit.t = static_cast<float>(roots[i]);
        hit.uv = Vec2(static_cast<float>(u), static_cast<float>(v));
        return true;
    }
    return false;
}

SurfacePoint quadric_surface_point(const Primitive& primitive, const Vec2& uv, float time)
{
    return to_world(primitive, local_point(primitive, ranges(primitive), uv.x, uv.y), uv.x, uv.y, time);
}

SurfacePoint quadric_surface_point_near(const Primitive& primitive, const Vec3d& near, float time, SurfaceDetail detail)
{
    const Vec3d local = transform_point(primitive.world_from_object.inverse_matrix(), near);
    if (detail == SurfaceDetail::bare && is_whole_sphere(primitive)) {
        const double distance = local.length();
        if (distance > 0.0) {
            const Vec3d normal = local * (1.0 / distance);
            return bare_point(primitive, normal * static_cast<double>(primitive.radius), normal, time);
        }
    }
    const Ranges r = ranges(primitive);
    double u, v;
    locate(primitive, r, local, u, v);
    return to_world(primitive, local_point(primitive, r, u, v), u, v, time);
}

ShapeSample quadric_sample_area(const Primitive& primitive, const Vec2& u)
{
    const Ranges r = ranges(primitive);
    double v;
    if (primitive.kind == Kind::sphere) {
        const double z = r.z0 + u.y * (r.z1 - r.z0);
        const double radius = primitive.radius;
        const double theta = std::atan2(std::sqrt(std::max(0.0, (radius - z) * (radius + z))), z);
        v = std::clamp((theta - r.theta0) / (r.theta1 - r.theta0), 0.0, 1.0);
    } else if (primitive.kind == Kind::cylinder) {
        v = u.y;
    } else {
        const double outer = primitive.radius;
        const double inner = primitive.inner_radius;
        const double distance = std::sqrt(outer * outer + u.y * (inner * inner - outer * outer));
        v = (outer - distance) / (outer - inner);
    }
    const LocalPoint local = local_point(primitive, r, u.x, v);
    ShapeSample sample = to_sample(to_world(primitive, local, u.x, v, 0.0f));
    const double density = 1.0 / (local_area(primitive, r) * area_stretch(primitive, local.normal));
    sample.pdf = std::isfinite(density) ? static_cast<float>(density) : 0.0f;
    return sample;
}

float quadric_pdf_area(const Primitive& primitive, const Vec3& position)
{
    const Ranges r = ranges(primitive);
    double u, v;
    locate(primitive, r, transform_point(primitive.world_from_object.inverse_matrix(), to_double(position)), u, v);
    const Vec3d normal = local_point(primitive, r, u, v).normal;
    const double density = 1.0 / (local_area(primitive, r) * area_stretch(primitive, normal));
    return std::isfinite(density) ? static_cast<float>(density) : 0.0f;
}

bool is_whole_sphere(const Primitive& primitive)
{
    if (primitive.kind != Kind::sphere || !is_full_turn(primitive)) return false;
    return std::min(primitive.z_min, primitive.z_max) <= -primitive.radius &&
           std::max(primitive.z_min, primitive.z_max) >= primitive.radius;
}

bool sphere_meet(const Primitive& primitive, const Ray& ray, float t_min, float t_max, float& t)
{
    const Matrix4& inverse = primitive.world_from_object.inverse_matrix();
    const Vec3d o = transform_point(inverse, to_double(ray.origin));
    const Vec3d d = transform_vector(inverse, to_double(ray.direction));
    double roots[2];
    if (!circle_roots(o, d, primitive.radius, roots)) return false;
    for (const double root : roots)
        if (root > t_min && root < t_max) {
            t = static_cast<float>(root);
            return true;
        }
    return false;
}

}  // namespace dapple::detail
