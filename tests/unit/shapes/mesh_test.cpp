// Mesh triangles: tangents and normal derivatives against finite differences, orientation, and ray origins that clear
// the triangle in the single-precision test Embree uses.
#include "dapple/shapes/mesh.h"

#include "shape_fixtures.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

MeshTriangle random_triangle(uint64_t i, float scale, const Vec3& offset)
{
    MeshTriangle t;
    for (uint64_t k = 0; k < 3; ++k) {
        t.p[k] = offset + random_in_cube(i, k) * scale;
        t.uv[k] = random_2d(i, 20 + k);
    }
    const Vec3 n = normalize(cross(t.p[1] - t.p[0], t.p[2] - t.p[0]));
    for (uint64_t k = 0; k < 3; ++k) t.n[k] = normalize(n + random_in_cube(i, 40 + k) * 0.4f);
    return t;
}

TEST(Mesh, DerivativesMatchFiniteDifferences)
{
    for (uint64_t i = 0; i < 300; ++i) {
        MeshTriangle t = random_triangle(i, 1.0f, Vec3(0.5f, 1.0f, -1.0f));
        t.has_uv = i % 3 != 0;
        t.has_normals = true;
        const SurfacePoint at = mesh_surface_point(t, {0.3f, 0.4f}, 0.25f);
        EXPECT_EQ(at.time, 0.25f);
        for (const Vec2& step : {Vec2(5e-3f, 0.0f), Vec2(0.0f, 5e-3f)}) {
            const SurfacePoint a = mesh_surface_point(t, Vec2(0.3f, 0.4f) - step, 0.0f);
            const SurfacePoint b = mesh_surface_point(t, Vec2(0.3f, 0.4f) + step, 0.0f);
            const Vec2 duv = b.uv - a.uv;
            const float size = 1.0f + length(at.dpdu) + length(at.dpdv);
            EXPECT_LT(length(b.position - a.position - at.dpdu * duv.x - at.dpdv * duv.y), 2e-6f * size);
            EXPECT_LT(length(b.n_shading - a.n_shading - at.dndu * duv.x - at.dndv * duv.y), 3e-6f * size);
        }
        EXPECT_LT(abs_dot(at.dpdu_shading, at.n_shading), 1e-6f);
        EXPECT_NEAR(length(at.dpdu_shading), 1.0f, 1e-5f);
    }
}

TEST(Mesh, OrientationFollowsVertexOrderFlipAndShadingNormals)
{
    for (uint64_t i = 0; i < 100; ++i) {
        MeshTriangle t = random_triangle(i, 1.0f, Vec3(0.0f));
        const Vec3 n = normalize(cross(t.p[1] - t.p[0], t.p[2] - t.p[0]));
        EXPECT_LT(length(mesh_surface_point(t, {0.2f, 0.3f}, 0).n_geometric - n), 1e-4f);
        t.flip = true;
        EXPECT_LT(length(mesh_surface_point(t, {0.2f, 0.3f}, 0).n_geometric + n), 1e-4f);
        t.has_normals = true;  // these point along n, and overrule the flip
        const SurfacePoint point = mesh_surface_point(t, {0.2f, 0.3f}, 0);
        EXPECT_LT(length(point.n_geometric - n), 1e-4f);
        EXPECT_GT(dot(point.n_shading, point.n_geometric), 0.0f);
    }
}

TEST(Mesh, DegenerateUvAndTrianglesStayFinite)
{
    MeshTriangle t = random_triangle(1, 1.0f, Vec3(0.0f));
    t.has_uv = t.has_normals = true;
    t.uv[0] = t.uv[1] = t.uv[2] = Vec2(0.5f, 0.5f);
    const SurfacePoint collapsed_uv = mesh_surface_point(t, {0.2f, 0.3f}, 0);
    EXPECT_NEAR(length(cross(collapsed_uv.dpdu, collapsed_uv.dpdv)), 1.0f, 1e-5f);
    EXPECT_EQ(collapsed_uv.uv, Vec2(0.5f, 0.5f));
    t.p[2] = t.p[1] = t.p[0];
    t.n[0] = t.n[1] = t.n[2] = Vec3(0.0f);
    const SurfacePoint point = mesh_surface_point(t, {0.2f, 0.3f}, 0);
    for (const Vec3& v : {point.n_geometric, point.n_shading, point.dpdu, point.dpdv, point.dpdu_shading, point.dndu})
        EXPECT_TRUE(is_finite(v));
    EXPECT_NEAR(length(point.n_geometric), 1.0f, 1e-6f);
}

// Shading tangents turn the frame of anisotropic lobes and leave the parametrisation alone.
TEST(Mesh, ShadingTangentsOrientLobes)
{
    for (uint64_t i = 0; i < 100; ++i) {
        MeshTriangle t = random_triangle(i, 1.0f, Vec3(0.0f));
        t.has_uv = true;
        t.has_normals = i % 2 == 0;
        const SurfacePoint without = mesh_surface_point(t, {0.2f, 0.3f}, 0);
        t.has_tangents = true;
        for (uint64_t k = 0; k < 3; ++k) t.s[k] = random_in_cube(i, 60 + k) * 3.0f;
        const SurfacePoint with = mesh_surface_point(t, {0.2f, 0.3f}, 0);
        const Vec3 s = t.s[0] * 0.5f + t.s[1] * 0.2f + t.s[2] * 0.3f;
        const Vec3 expected = normalize(s - with.n_shading * dot(s, with.n_shading));
        EXPECT_LT(length(with.dpdu_shading - expected), 1e-4f);
        EXPECT_EQ(with.dpdu, without.dpdu);
        EXPECT_EQ(with.dndv, without.dndv);
        t.s[0] = t.s[1] = t.s[2] = Vec3(0.0f);  // no direction: the parametrisation's
        EXPECT_EQ(mesh_surface_point(t, {0.2f, 0.3f}, 0).dpdu_shading, without.dpdu_shading);
    }
}

// The single-precision test of Moeller and Trumbore in the form Embree evaluates: everything relative to the ray's
// origin, the normal from the edges, accepted when t > 0.
bool float_hit(const MeshTriangle& t, const Vec3& origin, const Vec3& direction, float& distance)
{
    const Vec3 e1 = t.p[0] - t.p[1];
    const Vec3 e2 = t.p[2] - t.p[0];
    const Vec3 normal = cross(e2, e1);
    const Vec3 c = t.p[0] - origin;
    const Vec3 r = cross(c, direction);
    const float det = dot(normal, direction);
    if (det == 0.0f) return false;
    const float sign = det < 0.0f ? -1.0f : 1.0f;
    const float u = dot(r, e2) * sign;
    const float v = dot(r, e1) * sign;
    if (u < 0.0f || v < 0.0f || u + v > std::fabs(det)) return false;
    distance = dot(normal, c) * sign / std::fabs(det);
    return distance > 0.0f;
}

// The watertight form (Pluecker coordinates), which Embree takes for robust scenes: the edges come from vertices that
// have been made relative to the ray's origin, and inside is decided by edge against direction.
bool float_hit_robust(const MeshTriangle& t, const Vec3& origin, const Vec3& direction, float& distance)
{
    const Vec3 v0 = t.p[0] - origin, v1 = t.p[1] - origin, v2 = t.p[2] - origin;
    const Vec3 e0 = v2 - v0, e1 = v0 - v1, e2 = v1 - v2;
    const float u = dot(cross(e0, v2 + v0), direction);
    const float v = dot(cross(e1, v0 + v1), direction);
    const float w = dot(cross(e2, v1 + v2), direction);
    if (std::min({u, v, w}) < 0.0f && std::max({u, v, w}) > 0.0f) return false;
    const Vec3 normal = cross(e1, e0);
    const float det = dot(normal, direction);
    if (det == 0.0f) return false;
    distance = dot(normal, v0) / det;
    return distance > 0.0f;
}

TEST(Mesh, RaysLeavingATriangleDoNotHitItAgain)
{
    int grazing = 0;
    for (float scale : {1e-3f, 1.0f, 1e3f}) {
        for (float offset : {0.0f, 1.0f, 1e4f}) {
            const Vec3 shift = Vec3(0.6f, -0.9f, 0.3f) * offset;
            int hits = 0, tests = 0;
            for (uint64_t i = 0; i < 3000; ++i) {
                const MeshTriangle t = random_triangle(i, scale, shift);
                // At a large offset a small triangle may collapse to a line in single precision.
                const Vec3 e1 = t.p[1] - t.p[0], e2 = t.p[2] - t.p[0];
                const float longest = std::max(length(e1), length(e2));
                const float height = length(cross(e1, e2)) / longest;
                if (!(height > 0.02f * longest)) continue;
                for (uint64_t k = 0; k < 10; ++k) {
                    const Vec2 uv = random_2d(10 * i + k, 60);
                    const Vec2 b = uv.x + uv.y > 1.0f ? Vec2(1 - uv.x, 1 - uv.y) : uv;
                    const SurfacePoint p = mesh_surface_point(t, b, 0.0f);
                    Vec3 d = random_direction(10 * i + k, 70);
                    if (k % 2) d = normalize(d - p.n_geometric * (dot(d, p.n_geometric) * 0.999f));
                    grazing += abs_dot(d, p.n_geometric) < 1e-3f;
                    const Vec3 origin = offset_ray_origin(p.position, p.error, p.n_geometric, d);
                    float distance;
                    hits += float_hit(t, origin, d, distance);
                    hits += float_hit_robust(t, origin, d, distance);
                    ++tests;
                    // Bounded: a few units in the last place of the vertices and, for slivers, of the edges.
                    const float largest = max_component(abs(t.p[0])) + 2.0f * scale;
                    ASSERT_LT(length(origin - p.position), 2e-6f * largest + 1e-4f * scale);
                }
            }
            EXPECT_GT(tests, 10000);
            EXPECT_EQ(hits, 0) << "scale " << scale << " offset " << offset << " of " << tests;
        }
    }
    EXPECT_GT(grazing, 1000);
}

TEST(Mesh, LeavingOutTangentsChangesNothingElse)
{
    for (uint64_t i = 0; i < 300; ++i) {
        MeshTriangle t = random_triangle(i, 1.0f, Vec3(0.5f, 1.0f, -1.0f));
        t.has_uv = i % 3 != 0;
        t.has_normals = i % 2 != 0;
        t.flip = i % 5 == 0;
        const SurfacePoint full = mesh_surface_point(t, {0.3f, 0.4f}, 0.25f);
        const SurfacePoint plain = mesh_surface_point(t, {0.3f, 0.4f}, 0.25f, SurfaceDetail::no_tangents);
        EXPECT_EQ(plain.position, full.position);
        EXPECT_EQ(plain.error, full.error);
        EXPECT_EQ(plain.n_geometric, full.n_geometric);
        EXPECT_EQ(plain.n_shading, full.n_shading);
        EXPECT_EQ(plain.uv, full.uv);
        EXPECT_EQ(plain.time, full.time);
    }
}

}  // namespace
}  // namespace dapple
