// Bilinear patches P(u,v) = lerp(v, lerp(u, p00, p10), lerp(u, p01, p11)) in double precision.
//
// Intersection in the manner of Reshetov 2019, "Cool patches: a geometric approach to ray/bilinear patch
// intersections": the patch is swept by the segments from a(u) = A + u B on one edge to a(u) + s(u), s(u) = C + u D, on
// the other. The line of such a segment meets the ray o + t d where (a(u) - o) . (d x s(u)) = 0, a quadratic in u. With
// w = a - o and m = d x s, the meeting point w + v s = t d has v = (w x d) . m / m.m and t = (w x s) . m / m.m (cross
// with d, with s).
//
// Area sampling takes the density bilinear in (u,v) that has the area stretch |dP/du x dP/dv| at the corners; it is
// uniform for parallelograms. Its density at a position needs (u,v), found in the projection along the patch's mean
// normal, where P(u,v) = p again is a quadratic, and polished by Newton steps in space.
#include "dapple/shapes/primitive_kinds.h"

namespace dapple::detail {
namespace {

// P(u,v) = origin + u along_u + v along_v + u v twist.
struct Patch {
    Vec3d origin, along_u, along_v, twist;

    explicit Patch(const Primitive& primitive)
        : origin(to_double(primitive.p[0])),
          along_u(to_double(primitive.p[1]) - origin),
          along_v(to_double(primitive.p[2]) - origin),
          twist(to_double(primitive.p[3]) - to_double(primitive.p[2]) - along_u)
    {
    }

    Vec3d at(double u, double v) const { return origin + along_u * u + along_v * v + twist * (u * v); }
    Vec3d dpdu(double v) const { return along_u + twist * v; }
    Vec3d dpdv(double u) const { return along_v + twist * u; }
    Vec3d normal(double u, double v) const { return dpdu(v).cross(dpdv(u)); }
};

// Real roots of a + b x + c x^2 without cancellation; returns how many.
int solve_quadratic(double a, double b, double c, double roots[2])
{
    const double scale = std::abs(a) + std::abs(b) + std::abs(c);
    if (std::abs(c) <= 1e-14 * scale) {
        if (b == 0.0) return 0;
        roots[0] = -a / b;
        return 1;
    }
    const double discriminant = b * b - 4.0 * a * c;
    if (discriminant < 0.0) return 0;
    const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
    roots[0] = q / c;
    if (q == 0.0) return 1;
    roots[1] = a / q;
    return 2;
}

// Area stretches at the corners (0,0), (1,0), (0,1), (1,1), or equal ones where all vanish.
struct CornerWeights {
    double w[4];

    explicit CornerWeights(const Patch& patch)
    {
        for (int i = 0; i < 4; ++i) w[i] = patch.normal(i & 1, i >> 1).length();
        if (!(w[0] + w[1] + w[2] + w[3] > 0.0)) std::fill(w, w + 4, 1.0);
    }
    // Density on the unit square.
    double density(double u, double v) const
    {
        const double value = (1 - v) * ((1 - u) * w[0] + u * w[1]) + v * ((1 - u) * w[2] + u * w[3]);
        return 4.0 * value / (w[0] + w[1] + w[2] + w[3]);
    }
};

// x in [0,1] with density proportional to lerp(x, a, b).
double sample_linear(double u, double a, double b)
{
    if (!(a + b > 0.0)) return u;
    return std::clamp(u * (a + b) / (a + std::sqrt((1.0 - u) * a * a + u * b * b)), 0.0, 1.0);
}

// The parameters of a position on the patch.
void invert(const Patch& patch, const Vec3d& position, double& u, double& v)
{
    const Vec3d mean_normal = patch.normal(0.5, 0.5);
    const Vec3d p = position - patch.origin;
    // In projection p = u U + v V + u v T; crossing with V + u T removes v.
    const auto flat_cross = [&](const Vec3d& a, const Vec3d& b) { return a.cross(b).dot(mean_normal); };
    double roots[2];
    const int count = solve_quadratic(flat_cross(p, patch.along_v),
                                      flat_cross(p, patch.twist) - flat_cross(patch.along_u, patch.along_v),
                                      -flat_cross(patch.along_u, patch.twist), roots);
    u = v = 0.5;
    double best = (patch.at(u, v) - position).length2();
    for (int i = 0; i < count; ++i) {
        const double u_root = std::clamp(roots[i], 0.0, 1.0);
        const Vec3d across = patch.dpdv(u_root);
        const double v_root =
            std::clamp((p - patch.along_u * u_root).dot(across) / std::max(across.length2(), 1e-300), 0.0, 1.0);
        const double distance = (patch.at(u_root, v_root) - position).length2();
        if (distance < best) {
            best = distance;
            u = u_root;
            v = v_root;
        }
    }
    for (int step = 0; step < 3; ++step) {
        const Vec3d du = patch.dpdu(v);
        const Vec3d dv = patch.dpdv(u);
        const Vec3d rest = position - patch.at(u, v);
        const double det = du.length2() * dv.length2() - sqr(du.dot(dv));
        if (!(det > 1e-20 * du.length2() * dv.length2())) return;
        u = std::clamp(u + (rest.dot(du) * dv.length2() - rest.dot(dv) * du.dot(dv)) / det, 0.0, 1.0);
        v = std::clamp(v + (rest.dot(dv) * du.length2() - rest.dot(du) * du.dot(dv)) / det, 0.0, 1.0);
    }
}

template <class T>
T interpolate(const T values[4], double u, double v)
{
    const float fu = static_cast<float>(u);
    const float fv = static_cast<float>(v);
    return (values[0] * (1.0f - fu) + values[1] * fu) * (1.0f - fv) + (values[2] * (1.0f - fu) + values[3] * fu) * fv;
}

// Changes of a function of the patch's (u,v) into changes by the user's texture coordinates.
struct TextureFrame {
    double u_s = 1.0, u_t = 0.0, v_s = 0.0, v_t = 1.0;  // d(u,v) / d(s,t)

    Vec3d by_s(const Vec3d& by_u, const Vec3d& by_v) const { return by_u * u_s + by_v * v_s; }
    Vec3d by_t(const Vec3d& by_u, const Vec3d& by_v) const { return by_u * u_t + by_v * v_t; }
};

TextureFrame texture_frame(const Primitive& primitive, double u, double v)
{
    TextureFrame frame;
    if (!primitive.has_uv) return frame;
    const Vec2* uv = primitive.uv;
    const double s_u = lerp(static_cast<float>(v), uv[1].x - uv[0].x, uv[3].x - uv[2].x);
    const double t_u = lerp(static_cast<float>(v), uv[1].y - uv[0].y, uv[3].y - uv[2].y);
    const double s_v = lerp(static_cast<float>(u), uv[2].x - uv[0].x, uv[3].x - uv[1].x);
    const double t_v = lerp(static_cast<float>(u), uv[2].y - uv[0].y, uv[3].y - uv[1].y);
    const double det = s_u * t_v - s_v * t_u;
    if (!(std::abs(det) > 1e-7 * std::hypot(s_u, t_u) * std::hypot(s_v, t_v))) return frame;
    frame.u_s = t_v / det;
    frame.v_s = -t_u / det;
    frame.u_t = -s_v / det;
    frame.v_t = s_u / det;
    return frame;
}

}  // namespace

double patch_area(const Primitive& primitive)
{
    const Patch patch(primitive);
    constexpr int panels = 8;
    return integrate(
        [&](double u) { return integrate([&](double v) { return patch.normal(u, v).length(); }, 0.0, 1.0, panels); },
        0.0, 1.0, panels);
}

bool patch_intersect(const Primitive& primitive, const Ray& ray, float t_min, float t_max, PrimitiveHit& hit)
{
    const Patch patch(primitive);
    const Vec3d d = to_double(ray.direction);
    const Vec3d to_origin = patch.origin - to_double(ray.origin);
    const Vec3d across_c = d.cross(patch.along_v);
    const Vec3d across_d = d.cross(patch.twist);
    double roots[2];
    const int count = solve_quadratic(to_origin.dot(across_c), to_origin.dot(across_d) + patch.along_u.dot(across_c),
                                      patch.along_u.dot(across_d), roots);
    double nearest = t_max;
    bool found = false;
    for (int i = 0; i < count; ++i) {
        const double u = roots[i];
        if (!(u >= 0.0 && u <= 1.0)) continue;
        const Vec3d w = to_origin + patch.along_u * u;
        const Vec3d s = patch.dpdv(u);
        const Vec3d m = d.cross(s);
        const double m2 = m.length2();
        if (!(m2 > 0.0)) continue;
        const double v = w.cross(d).dot(m) / m2;
        const double t = w.cross(s).dot(m) / m2;
        if (!(v >= 0.0 && v <= 1.0 && t > t_min && t < nearest)) continue;
        nearest = t;
        found = true;
        hit.t = static_cast<float>(t);
        hit.uv = Vec2(static_cast<float>(u), static_cast<float>(v));
    }
    return found;
}

SurfacePoint patch_surface_point(const Primitive& primitive, const Vec2& uv, float time)
{
    const Patch patch(primitive);
    const double u = uv.x;
    const double v = uv.y;
    const Vec3d position = patch.at(u, v);
    const Vec3d du = patch.dpdu(v);
    const Vec3d dv = patch.dpdv(u);
    Vec3d normal = du.cross(dv);
    // At a collapsed edge one tangent is zero: the patch's middle lends its normal.
    if (!(normal.length2() > 0.0)) normal = patch.normal(0.5, 0.5);
    if (!(normal.length2() > 0.0)) normal = Vec3d(0.0, 0.0, 1.0);
    if (primitive.flip) normal = -normal;
    const TextureFrame texture = texture_frame(primitive, u, v);

    SurfacePoint point;
    point.time = time;
    point.position = to_float(position);
    point.uv = primitive.has_uv ? interpolate(primitive.uv, u, v) : uv;
    point.dpdu = to_float(texture.by_s(du, dv));
    point.dpdv = to_float(texture.by_t(du, dv));
    point.n_geometric = point.n_shading = to_float(normal / normal.length());

    // Change of the normal: of cross(dpdu, dpdv), whose own second derivatives are the twist, or of the normals given.
    Vec3d changing = normal;
    Vec3d change_u = du.cross(patch.twist) * (primitive.flip ? -1.0 : 1.0);
    Vec3d change_v = patch.twist.cross(dv) * (primitive.flip ? -1.0 : 1.0);
    if (primitive.has_normals) {
        const Vec3d interpolated = to_double(interpolate(primitive.n, u, v));
        if (interpolated.length2() > 0.0) {
            const Vec3* n = primitive.n;
            point.n_shading = to_float(interpolated / interpolated.length());
            point.n_geometric = face_forward(point.n_geometric, point.n_shading);
            changing = interpolated;
            change_u = to_double(lerp(uv.y, n[1] - n[0], n[3] - n[2]));
            change_v = to_double(lerp(uv.x, n[2] - n[0], n[3] - n[1]));
        }
    }
    const Vec3d dndu = normalized_change(changing, change_u);
    const Vec3d dndv = normalized_change(changing, change_v);
    point.dndu = to_float(texture.by_s(dndu, dndv));
    point.dndv = to_float(texture.by_t(dndu, dndv));
    point.dpdu_shading = Frame::from_normal_tangent(point.n_shading, point.dpdu).s;
    // Single-precision rounding of the position, and double arithmetic where the corners' terms cancel. The latter has
    // the size of the largest coordinate on every axis: of a ray that starts on a patch in the plane z = 0, x and y are
    // what rounds the distance to the patch.
    const Vec3 terms = abs(primitive.p[0]) + abs(primitive.p[1]) + abs(primitive.p[2]) + abs(primitive.p[3]);
    point.error = abs(point.position) * 0x1p-22f + Vec3(max_component(terms) * 0x1p-46f);
    return point;
}

ShapeSample patch_sample_area(const Primitive& primitive, const Vec2& u)
{
    const Patch patch(primitive);
    const CornerWeights weights(patch);
    const auto& w = weights.w;
    const double v_chosen = sample_linear(u.y, w[0] + w[1], w[2] + w[3]);
    const double u_chosen =
        sample_linear(u.x, (1.0 - v_chosen) * w[0] + v_chosen * w[2], (1.0 - v_chosen) * w[1] + v_chosen * w[3]);
    const Vec2 uv(static_cast<float>(u_chosen), static_cast<float>(v_chosen));
    ShapeSample sample = to_sample(patch_surface_point(primitive, uv, 0.0f));
    const double density = weights.density(uv.x, uv.y) / patch.normal(uv.x, uv.y).length();
    sample.pdf = std::isfinite(density) ? static_cast<float>(density) : 0.0f;
    return sample;
}

float patch_pdf_area(const Primitive& primitive, const Vec3& position)
{
    const Patch patch(primitive);
    double u, v;
    invert(patch, to_double(position), u, v);
    const double density = CornerWeights(patch).density(u, v) / patch.normal(u, v).length();
    return std::isfinite(density) ? static_cast<float>(density) : 0.0f;
}

}  // namespace dapple::detail
