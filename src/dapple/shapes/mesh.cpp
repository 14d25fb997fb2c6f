// Triangle differential geometry in double precision (inputs and results single): slivers and tiny uv triangles keep
// their digits, and positions are correctly rounded. Three coordinates at a time: about 200 instructions a hit, of
// which the square root and the divisions take most of the time; tangents cost as much again.
#include "dapple/shapes/mesh.h"

#include "dapple/shapes/packed.h"

#include <cstring>

namespace dapple {
namespace {

using namespace detail;

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
// p: the corners; e1, e2: the edges from the first of them.
[[gnu::always_inline]] inline Vec3 error_bound(const Float4 (&p)[3], const Double4& e1, const Double4& e2,
                                               double twice_area)
{
    const Double4 e3 = e2 - e1;
    const double longest = std::max({dot(e1, e1), dot(e2, e2), dot(e3, e3)});
    constexpr double sliver_limit = 64.0;
    const auto sliver = static_cast<float>(twice_area * sliver_limit > longest ? longest / twice_area : sliver_limit);
    // Not zero even where the triangle lies in a coordinate plane: rays must leave it, not start in it.
    const float least = 0x1p-24f * std::sqrt(static_cast<float>(longest));
    const Float4 high = larger(larger(p[0], p[1]), p[2]);
    const Float4 low = smaller(smaller(p[0], p[1]), p[2]);
    const Float4 bound = 0x1p-24f * (4.0f * larger(high, -low) + 4.0f * sliver * (high - low));
    return {std::max(least, bound[0]), std::max(least, bound[1]), std::max(least, bound[2])};
}

// The direction that anisotropic lobes follow: the interpolated shading tangent, or dpdu where there is none.
Vec3 tangent_direction(const TriangleCorners& triangle, const Vec2& barycentrics, const Vec3& dpdu)
{
    if (!triangle.has_tangents) return dpdu;
    const Vec3 s = *triangle.s[0] * (1.0f - barycentrics.x - barycentrics.y) + *triangle.s[1] * barycentrics.x +
                   *triangle.s[2] * barycentrics.y;
    return length_squared(s) > 0.0f && is_finite(s) ? s : dpdu;
}

// dpdu, dpdv and what follows from them; `interpolated`: the shading normal before it was normalised, or null.
void set_tangents(const Vec3d (&edges)[2], double (&du)[2], double (&dv)[2], const TriangleCorners& triangle,
                  const Vec3& n, const Vec3d* interpolated, SurfacePoint& point)
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
    bool turns = false;  // the shading normal changes
    if (interpolated) {
        const Vec3d n0 = to_double(*triangle.n[0]);
        const Vec3d changes[2] = {to_double(*triangle.n[1]) - n0, to_double(*triangle.n[2]) - n0};
        Vec3d n_along_u, n_along_v;
        turns = solve_tangents(changes, du, dv, n_along_u, n_along_v);
        if (turns) {
            point.dndu = to_float(detail::normalized_change(*interpolated, n_along_u));
            point.dndv = to_float(detail::normalized_change(*interpolated, n_along_v));
        }
    }
    if (!turns) point.dndu = point.dndv = Vec3(0.0f);
}

}  // namespace

Vec3 mesh_error_bound(const Vec3& p0, const Vec3& p1, const Vec3& p2)
{
    const Float4 p[3] = {pack(p0), pack(p1), pack(p2)};
    const Double4 e1 = widen(p[1]) - widen(p[0]);
    const Double4 e2 = widen(p[2]) - widen(p[0]);
    const Double4 normal = cross(e1, e2);
    return error_bound(p, e1, e2, std::sqrt(dot(normal, normal)));
}

namespace {

// Position, error and geometric normal from the corners and the edges from the first of them.
[[gnu::always_inline]] inline void set_bare(const Float4 (&p)[3], const Double4& p0, const Double4& e1,
                                            const Double4& e2, bool flip, double b1, double b2, SurfacePoint& point)
{
    point.position = narrow(p0 + e1 * b1 + e2 * b2);
    const Double4 normal = cross(e1, e2);
    const double normal_length = std::sqrt(dot(normal, normal));
    point.error = error_bound(p, e1, e2, normal_length);
    const Vec3 n = normal_length > 0.0 ? narrow(normal * (1.0 / normal_length)) : Vec3(0.0f, 0.0f, 1.0f);
    point.n_geometric = point.n_shading = flip ? -n : n;
}

Float4 load(const Vec3* padded)
{
    Float4 p;
    std::memcpy(&p, padded, sizeof p);
    return p;
}

}  // namespace

void bare_surface_point(const Vec3* positions, const uint32_t* corners, bool flip, const Vec2& barycentrics, float time,
                        SurfacePoint& point)
{
    const Float4 p[3] = {load(positions + corners[0]), load(positions + corners[1]), load(positions + corners[2])};
    const Double4 p0 = widen(p[0]);
    point.time = time;
    set_bare(p, p0, widen(p[1]) - p0, widen(p[2]) - p0, flip, barycentrics.x, barycentrics.y, point);
}

void triangle_surface_point(const TriangleCorners& triangle, const Vec2& barycentrics, float time, SurfaceDetail detail,
                            SurfacePoint& point)
{
    const Float4 p[3] = {pack(*triangle.p[0]), pack(*triangle.p[1]), pack(*triangle.p[2])};
    const Double4 p0 = widen(p[0]);
    const Double4 e1 = widen(p[1]) - p0;
    const Double4 e2 = widen(p[2]) - p0;
    const double b1 = barycentrics.x;
    const double b2 = barycentrics.y;
    point.time = time;
    set_bare(p, p0, e1, e2, triangle.flip, b1, b2, point);
    const Vec3 n = point.n_geometric;

    Vec3d interpolated(0.0);
    bool has_normal = false;
    if (triangle.has_normals) {
        const Double4 sum = widen(pack(*triangle.n[0])) * (1.0 - b1 - b2) + widen(pack(*triangle.n[1])) * b1 +
                            widen(pack(*triangle.n[2])) * b2;
        const double len = std::sqrt(dot(sum, sum));
        has_normal = len > 0.0 && std::isfinite(len);
        if (has_normal) {
            point.n_shading = narrow(sum * (1.0 / len));
            point.n_geometric = face_forward(n, point.n_shading);
            interpolated = unpack(sum);
        }
    }

    if (detail == SurfaceDetail::bare) return;

    double du[2], dv[2];
    if (triangle.has_uv) {
        const Vec2& first = *triangle.uv[0];
        for (int i = 0; i < 2; ++i) {
            du[i] = static_cast<double>(triangle.uv[i + 1]->x) - first.x;
            dv[i] = static_cast<double>(triangle.uv[i + 1]->y) - first.y;
        }
        point.uv = Vec2(static_cast<float>(first.x + b1 * du[0] + b2 * du[1]),
                        static_cast<float>(first.y + b1 * dv[0] + b2 * dv[1]));
    } else {  // (0,0), (1,0), (1,1)
        du[0] = du[1] = dv[1] = 1.0;
        dv[0] = 0.0;
        point.uv = Vec2(static_cast<float>(b1 + b2), static_cast<float>(b2));
    }
    if (detail == SurfaceDetail::tangents) {
        const Vec3d edges[2] = {unpack(e1), unpack(e2)};
        set_tangents(edges, du, dv, triangle, n, has_normal ? &interpolated : nullptr, point);
        const Vec3 along = tangent_direction(triangle, barycentrics, point.dpdu);
        point.dpdu_shading = Frame::from_normal_tangent(point.n_shading, along).s;
    }
}

SurfacePoint mesh_surface_point(const MeshTriangle& triangle, const Vec2& barycentrics, float time,
                                SurfaceDetail detail)
{
    TriangleCorners corners;
    for (int i = 0; i < 3; ++i) {
        corners.p[i] = &triangle.p[i];
        corners.n[i] = &triangle.n[i];
        corners.uv[i] = &triangle.uv[i];
        corners.s[i] = &triangle.s[i];
    }
    corners.has_normals = triangle.has_normals;
    corners.has_uv = triangle.has_uv;
    corners.has_tangents = triangle.has_tangents;
    corners.flip = triangle.flip;
    SurfacePoint point;
    triangle_surface_point(corners, barycentrics, time, detail, point);
    return point;
}

}  // namespace dapple
