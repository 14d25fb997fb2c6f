// Triangle differential geometry in double precision (inputs and results single): slivers and tiny uv triangles keep
// their digits, and positions are correctly rounded. About 60 multiplications per hit, 90 more with tangents.
#include "dapple/shapes/mesh.h"

#include "dapple/shapes/double_math.h"

namespace dapple {
namespace {

using detail::to_double;
using detail::to_float;
using detail::Vec3d;

// Tangents with p(u, v) linear over the triangle, given each edge's change of (u, v); false when these are dependent.
bool solve_tangents(const Vec3d edges[2], const double du[2], const double dv[2], Vec3d& along_u, Vec3d& along_v)
{
    const double det = du[0] * dv[1] - dv[0] * du[1];
    const double size = std::sqrt((du[0] * du[0] + dv[0] * dv[0]) * (du[1] * du[1] + dv[1] * dv[1]));
    // Single-precision uv that are collinear but for rounding carry no direction.
    if (!(std::abs(det) > 1e-7 * size)) return false;
    along_u = (edges[0] * dv[1] - edges[1] * dv[0]) / det;
    along_v = (edges[1] * du[0] - edges[0] * du[1]) / det;
    return true;
}

// Why this bound: the test computes C = p0 - O and the edges with a relative rounding of 2^-24 each, and the sign of
// the plane's side from dot(cross(e1, e2), C). C and the edges are as long as the triangle is wide, so each product
// carries a few roundings of 2^-24 times the extent along the axes concerned; the position itself adds the rounding of
// its coordinates. Along the normal these weigh with |n| per axis, which is how offset_ray_origin combines them. The
// cross product of a sliver loses more: cancellation multiplies by longest^2 / (2 area), about length over width, which
// is followed up to a limit; beyond it the offset would be longer than the sliver is wide.
Vec3 error_bound(const Vec3& p0, const Vec3& p1, const Vec3& p2, const Vec3d& e1, const Vec3d& e2, double twice_area)
{
    const double longest = std::max({e1.dot(e1), e2.dot(e2), (e2 - e1).dot(e2 - e1)});
    constexpr double sliver_limit = 64.0;
    const auto sliver = static_cast<float>(twice_area * sliver_limit > longest ? longest / twice_area : sliver_limit);
    // Not zero even where the triangle lies in a coordinate plane: rays must leave it, not start in it.
    const float least = 0x1p-24f * std::sqrt(static_cast<float>(longest));
    Vec3 bound;
    for (int axis = 0; axis < 3; ++axis) {
        const float high = std::max({p0[axis], p1[axis], p2[axis]});
        const float low = std::min({p0[axis], p1[axis], p2[axis]});
        bound[axis] = std::max(least, 0x1p-24f * (4.0f * std::max(high, -low) + 4.0f * sliver * (high - low)));
    }
    return bound;
}

// The direction that anisotropic lobes follow: the interpolated shading tangent, or dpdu where there is none.
Vec3 tangent_direction(const MeshTriangle& triangle, const Vec2& barycentrics, const Vec3& dpdu)
{
    if (!triangle.has_tangents) return dpdu;
    const Vec3 s = triangle.s[0] * (1.0f - barycentrics.x - barycentrics.y) + triangle.s[1] * barycentrics.x +
                   triangle.s[2] * barycentrics.y;
    return length_squared(s) > 0.0f && is_finite(s) ? s : dpdu;
}

// dpdu, dpdv and what follows from them; `interpolated`: the shading normal before it was normalised, or null.
void set_tangents(const Vec3d edges[2], double du[2], double dv[2], const MeshTriangle& triangle, const Vec3& n,
                  const Vec3d* interpolated, SurfacePoint& point)
{
    Vec3d along_u, along_v;
    bool solved = solve_tangents(edges, du, dv, along_u, along_v);
    if (solved) {
        point.dpdu = to_float(along_u);
        point.dpdv = to_float(along_v);
        solved = is_finite(point.dpdu) && is_finite(point.dpdv);
    }
    if (!solved) {
        // Parametrise by distances along a tangent frame instead, so that dndu still matches dpdu.
        const Frame frame(n);
        for (int i = 0; i < 2; ++i) {
            du[i] = edges[i].dot(to_double(frame.s));
            dv[i] = edges[i].dot(to_double(frame.t));
        }
        point.dpdu = frame.s;
        point.dpdv = frame.t;
    }
    if (interpolated) {
        const Vec3d n0 = to_double(triangle.n[0]);
        const Vec3d changes[2] = {to_double(triangle.n[1]) - n0, to_double(triangle.n[2]) - n0};
        Vec3d n_along_u, n_along_v;
        if (solve_tangents(changes, du, dv, n_along_u, n_along_v)) {
            point.dndu = to_float(detail::normalized_change(*interpolated, n_along_u));
            point.dndv = to_float(detail::normalized_change(*interpolated, n_along_v));
        }
    }
}

}  // namespace

Vec3 mesh_error_bound(const Vec3& p0, const Vec3& p1, const Vec3& p2)
{
    const Vec3d e1 = to_double(p1) - to_double(p0);
    const Vec3d e2 = to_double(p2) - to_double(p0);
    return error_bound(p0, p1, p2, e1, e2, e1.cross(e2).length());
}

SurfacePoint mesh_surface_point(const MeshTriangle& triangle, const Vec2& barycentrics, float time,
                                SurfaceDetail detail)
{
    const Vec3d p0 = to_double(triangle.p[0]);
    const Vec3d edges[2] = {to_double(triangle.p[1]) - p0, to_double(triangle.p[2]) - p0};
    const double b1 = barycentrics.x;
    const double b2 = barycentrics.y;

    SurfacePoint point;
    point.time = time;
    point.position = to_float(p0 + edges[0] * b1 + edges[1] * b2);

    const Vec3d normal = edges[0].cross(edges[1]);
    const double normal_length = normal.length();
    point.error = error_bound(triangle.p[0], triangle.p[1], triangle.p[2], edges[0], edges[1], normal_length);
    Vec3 n = normal_length > 0.0 ? to_float(normal * (1.0 / normal_length)) : Vec3(0.0f, 0.0f, 1.0f);
    if (triangle.flip) n = -n;
    point.n_geometric = point.n_shading = n;

    Vec3d interpolated(0.0);
    bool has_normal = false;
    if (triangle.has_normals) {
        interpolated =
            to_double(triangle.n[0]) * (1.0 - b1 - b2) + to_double(triangle.n[1]) * b1 + to_double(triangle.n[2]) * b2;
        const double len = interpolated.length();
        has_normal = len > 0.0 && std::isfinite(len);
        if (has_normal) {
            point.n_shading = to_float(interpolated * (1.0 / len));
            point.n_geometric = face_forward(n, point.n_shading);
        }
    }

    double du[2], dv[2];
    if (triangle.has_uv) {
        for (int i = 0; i < 2; ++i) {
            du[i] = static_cast<double>(triangle.uv[i + 1].x) - triangle.uv[0].x;
            dv[i] = static_cast<double>(triangle.uv[i + 1].y) - triangle.uv[0].y;
        }
        point.uv = Vec2(static_cast<float>(triangle.uv[0].x + b1 * du[0] + b2 * du[1]),
                        static_cast<float>(triangle.uv[0].y + b1 * dv[0] + b2 * dv[1]));
    } else {  // (0,0), (1,0), (1,1)
        du[0] = du[1] = dv[1] = 1.0;
        dv[0] = 0.0;
        point.uv = Vec2(static_cast<float>(b1 + b2), static_cast<float>(b2));
    }
    if (detail == SurfaceDetail::tangents) {
        set_tangents(edges, du, dv, triangle, n, has_normal ? &interpolated : nullptr, point);
        const Vec3 along = tangent_direction(triangle, barycentrics, point.dpdu);
        point.dpdu_shading = Frame::from_normal_tangent(point.n_shading, along).s;
    }
    return point;
}

}  // namespace dapple
