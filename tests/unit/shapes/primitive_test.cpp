// Primitives: bounds, areas, intersections against dense triangulations, differential geometry, orientation.
#include "dapple/shapes/primitive.h"

#include "shape_fixtures.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

using Kind = Primitive::Kind;

// The surface as n x n quads of its parameter domain.
std::vector<Vec3> grid_positions(const Primitive& primitive, int n)
{
    std::vector<Vec3> positions;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
            const Vec2 uv(static_cast<float>(i) / n, static_cast<float>(j) / n);
            positions.push_back(surface_point(primitive, hit_at(primitive, uv), 0.0f).position);
        }
    return positions;
}

template <class F>
void for_each_triangle(const std::vector<Vec3>& positions, int n, const F& f)
{
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const size_t a = static_cast<size_t>(j * (n + 1) + i);
            const size_t c = a + static_cast<size_t>(n + 1);
            f(positions[a], positions[a + 1], positions[c]);
            f(positions[a + 1], positions[c + 1], positions[c]);
        }
}

TEST(Primitive, AreaMatchesTriangulation)
{
    constexpr int n = 200;
    for (const auto& [name, primitive] : all_primitives()) {
        double sum = 0.0;
        for_each_triangle(grid_positions(primitive, n), n,
                          [&](Vec3 a, Vec3 b, Vec3 c) { sum += 0.5 * length(cross(b - a, c - a)); });
        EXPECT_NEAR(area(primitive) / sum, 1.0, 5e-4) << name;
    }
}

TEST(Primitive, AreaOfKnownBodies)
{
    Primitive p;
    p.kind = Kind::sphere;
    p.radius = 2.0f;
    p.z_min = -2.0f;
    p.z_max = 2.0f;
    EXPECT_NEAR(area(p), 16.0f * pi, 1e-4f);
    // Oblate spheroid with half axes 2, 2, 1: 2 pi a^2 (1 + (1 - e^2) / e atanh e), e^2 = 3/4.
    p.world_from_object = Transform(scaling({1.0f, 1.0f, 0.5f}));
    const double e = std::sqrt(0.75);
    EXPECT_NEAR(area(p), 8.0 * 3.14159265358979 * (1.0 + 0.25 / e * std::atanh(e)), 1e-4);
}

TEST(Primitive, BoundsHoldThePointsAndAreTight)
{
    for (const auto& [name, primitive] : all_primitives()) {
        const Box3 box = bounds(primitive);
        Box3 seen;
        for (uint64_t i = 0; i < 20000; ++i) {
            const Vec3 a = surface_point(primitive, hit_at(primitive, random_2d(i, 1)), 0.0f).position;
            const Vec3 b = sample_area(primitive, random_2d(i, 2)).position;
            ASSERT_TRUE(box.intersects(a) && box.intersects(b)) << name;
            seen.extendBy(a);
            seen.extendBy(b);
        }
        const bool whole = primitive.phi_max > 6.28f && primitive.z_max - primitive.z_min > 1.99f;
        if (whole) {
            EXPECT_LT(length(box.size() - seen.size()), 0.05f) << name;
        }
    }
}

TEST(Primitive, IntersectionsMatchTriangulation)
{
    constexpr int n = 96;
    constexpr uint64_t rays = 300;
    for (const auto& [name, primitive] : all_primitives()) {
        if (primitive.kind == Kind::triangle) continue;
        const std::vector<Vec3> positions = grid_positions(primitive, n);
        int hits = 0, differ = 0;
        for (uint64_t r = 0; r < rays; ++r) {
            Ray ray;
            ray.origin = random_direction(r, 1) * 3.0f;
            const Vec3 target = surface_point(primitive, hit_at(primitive, random_2d(r, 2)), 0.0f).position;
            ray.direction = normalize(target + random_in_cube(r, 3) * 0.5f - ray.origin);
            double nearest = 1e30;
            for_each_triangle(positions, n, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
                const Vec3 e1 = b - a, e2 = c - a, h = cross(ray.direction, e2), s = ray.origin - a;
                const float det = dot(e1, h);
                if (det == 0.0f) return;
                const float u = dot(s, h) / det;
                const Vec3 q = cross(s, e1);
                const float v = dot(ray.direction, q) / det;
                const float t = dot(e2, q) / det;
                if (u >= 0 && v >= 0 && u + v <= 1 && t > 0) nearest = std::min(nearest, static_cast<double>(t));
            });
            PrimitiveHit hit;
            const bool found = intersect(primitive, ray, 0.0f, infinity, hit);
            hits += found;
            if (found != (nearest < 1e30) || (found && std::abs(hit.t - nearest) > 0.02))
                ++differ;  // only where the ray grazes an edge or a silhouette
            if (!found) continue;
            PrimitiveHit none;
            EXPECT_FALSE(intersect(primitive, ray, 0.0f, hit.t * 0.999f, none)) << name;
            for (const SurfacePoint& point :
                 {surface_point(primitive, hit, 0.0f), surface_point(primitive, ray, hit)}) {
                EXPECT_LT(length(point.position - ray.at(hit.t)), 5e-6f) << name;
                EXPECT_LT((point.uv - hit.uv).length(), 1e-5f) << name;
            }
        }
        EXPECT_GT(hits, 80) << name;
        EXPECT_LE(differ, 8) << name << " of " << hits;
    }
}

TEST(Primitive, HitsLieOnTheSurface)
{
    for (const auto& [name, primitive] : all_primitives()) {
        if (primitive.kind != Kind::sphere && primitive.kind != Kind::cylinder) continue;
        for (uint64_t r = 0; r < 2000; ++r) {
            Ray ray;
            ray.origin = random_direction(r, 1) * (r % 2 ? 3.0f : 3000.0f);
            ray.direction = normalize(sample_area(primitive, random_2d(r, 2)).position - ray.origin);
            PrimitiveHit hit;
            if (!intersect(primitive, ray, 0.0f, infinity, hit)) continue;
            const SurfacePoint point = surface_point(primitive, ray, hit);
            const Vec3 p = primitive.world_from_object.inverse().point(point.position);
            const float distance = primitive.kind == Kind::sphere ? length(p) : std::hypot(p.x, p.y);
            EXPECT_NEAR(distance / primitive.radius, 1.0f, 1e-6f) << name;
        }
    }
}

TEST(Primitive, RaysLeavingAHitDoNotMeetTheSurfaceAgain)
{
    for (auto [name, primitive] : all_primitives()) {
        if (primitive.kind == Kind::triangle) continue;
        for (float offset : {0.0f, 1e4f}) {
            const Vec3 shift(offset, -0.7f * offset, 0.3f * offset);
            primitive.world_from_object = Transform(translation(shift) * primitive.world_from_object.matrix());
            for (Vec3& p : primitive.p) p += shift;
            for (uint64_t i = 0; i < 2000; ++i) {
                const SurfacePoint at = surface_point(primitive, hit_at(primitive, random_2d(i, 1)), 0.0f);
                // A convex body is not met again from outside; flat ones from neither side.
                Vec3 d = random_direction(i, 2);
                const bool flat = primitive.kind == Kind::disk || name == "rectangle" || name == "flat quad";
                if (!flat && dot(d, at.n_geometric) < 0.0f) d = -d;
                if (name == "twisted patch") d = (random_float(i, 3) < 0.5f ? -1.0f : 1.0f) * at.n_geometric;
                Ray ray;
                ray.origin = offset_ray_origin(at.position, at.error, at.n_geometric, d);
                ray.direction = d;
                PrimitiveHit hit;
                EXPECT_FALSE(intersect(primitive, ray, 0.0f, infinity, hit)) << name << " " << offset << " " << hit.t;
                EXPECT_LT(length(ray.origin - at.position), 4e-6f * (1.0f + offset)) << name;
            }
        }
    }
}

// Flat primitives in a plane through the origin, where one coordinate is zero and tells nothing of the rounding of the
// others; edges that are no round numbers of the binary system.
TEST(Primitive, RaysLeavingAPlaneThroughTheOriginDoNotMeetItAgain)
{
    for (const Matrix4& turn : {Matrix4(), rotation(90.0f, {1, 0, 0}), rotation(90.0f, {0, 1, 0}),
                                rotation(180.0f, {1, 0, 0}), rotation(30.0f, {0, 0, 1})})
        for (Kind kind : {Kind::bilinear, Kind::disk}) {
            Primitive primitive;
            primitive.kind = kind;
            primitive.radius = 0.6f;
            primitive.phi_max = 2.0f * pi;
            primitive.world_from_object = Transform(turn);
            const Vec3 corners[4] = {{-0.6f, -0.6f, 0}, {0.6f, -0.6f, 0}, {-0.6f, 0.7f, 0}, {0.6f, 0.7f, 0}};
            for (int i = 0; i < 4; ++i) primitive.p[i] = Transform(turn).point(corners[i]);
            int met = 0;
            for (uint64_t i = 0; i < 2000; ++i) {
                const SurfacePoint at = surface_point(primitive, hit_at(primitive, random_2d(i, 1)), 0.0f);
                Ray ray;
                ray.direction = random_direction(i, 2);
                ray.origin = offset_ray_origin(at.position, at.error, at.n_geometric, ray.direction);
                PrimitiveHit hit;
                met += intersect(primitive, ray, 0.0f, infinity, hit);
            }
            EXPECT_EQ(met, 0) << (kind == Kind::disk ? "disk" : "rectangle");
        }
}

TEST(Primitive, DerivativesMatchFiniteDifferences)
{
    for (auto [name, primitive] : all_primitives()) {
        for (int variant = 0; variant < 3; ++variant) {
            const bool corners = primitive.kind == Kind::bilinear;
            if (variant > 0 && !corners) break;
            if (primitive.kind == Kind::triangle) break;  // see mesh_test.cpp
            primitive.has_uv = variant >= 1;
            primitive.has_normals = variant == 2;
            const Vec2 uv[4] = {{0.1f, 0.2f}, {2.1f, 0.4f}, {-0.2f, 1.3f}, {2.0f, 1.7f}};
            const Vec3 normal = surface_point(primitive, hit_at(primitive, {0.5f, 0.5f}), 0.0f).n_geometric;
            for (uint64_t i = 0; i < 4; ++i) {
                primitive.uv[i] = uv[i];
                primitive.n[i] = normalize(normal + random_in_cube(i, 9) * 0.4f);
            }
            for (uint64_t i = 0; i < 50; ++i) {
                const Vec2 at = random_2d(i, 1) * 0.8f + Vec2(0.1f, 0.1f);
                const SurfacePoint point = surface_point(primitive, hit_at(primitive, at), 0.0f);
                const float scale = length(point.dpdu) + length(point.dpdv);
                for (const Vec2& step : {Vec2(1e-3f, 0.0f), Vec2(0.0f, 1e-3f)}) {
                    const SurfacePoint a = surface_point(primitive, hit_at(primitive, at - step), 0.0f);
                    const SurfacePoint b = surface_point(primitive, hit_at(primitive, at + step), 0.0f);
                    const Vec2 duv = b.uv - a.uv;
                    const Vec3 dp = point.dpdu * duv.x + point.dpdv * duv.y;
                    const Vec3 dn = point.dndu * duv.x + point.dndv * duv.y;
                    EXPECT_LT(length(b.position - a.position - dp), 2e-5f * scale) << name << variant;
                    EXPECT_LT(length(b.n_shading - a.n_shading - dn), 2e-5f) << name << variant;
                }
                EXPECT_NEAR(length(point.n_geometric), 1.0f, 1e-6f);
                EXPECT_LT(abs_dot(point.n_geometric, normalize(point.dpdu)), 2e-6f) << name;
                EXPECT_LT(abs_dot(point.n_geometric, normalize(point.dpdv)), 2e-6f) << name;
                EXPECT_LT(abs_dot(point.n_shading, point.dpdu_shading), 1e-6f) << name;
                EXPECT_NEAR(length(point.dpdu_shading), 1.0f, 1e-5f) << name;
                EXPECT_GT(dot(point.n_shading, point.n_geometric), 0.0f) << name;
            }
        }
    }
}

TEST(Primitive, OutsideIsAwayFromTheCentreUnlessReversed)
{
    for (auto [name, primitive] : all_primitives()) {
        for (bool reversed : {false, true}) {
            primitive.flip = reversed != primitive.world_from_object.swaps_handedness();
            for (uint64_t i = 0; i < 20; ++i) {
                const SurfacePoint point = surface_point(primitive, hit_at(primitive, random_2d(i, 1)), 0.0f);
                Vec3 outward;
                const Vec3 local = primitive.world_from_object.inverse().point(point.position);
                switch (primitive.kind) {
                    case Kind::sphere: outward = primitive.world_from_object.normal(local); break;
                    case Kind::cylinder: outward = primitive.world_from_object.normal(Vec3(local.x, local.y, 0)); break;
                    case Kind::disk: outward = primitive.world_from_object.normal(Vec3(0, 0, 1)); break;
                    default: outward = cross(primitive.p[1] - primitive.p[0], primitive.p[2] - primitive.p[0]); break;
                }
                EXPECT_GT(dot(point.n_geometric, outward) * (reversed ? -1.0f : 1.0f), 0.0f) << name;
                const ShapeSample sample = sample_area(primitive, random_2d(i, 2));
                EXPECT_NEAR(length(sample.normal), 1.0f, 1e-6f);
                // In general: the side of cross(dpdu, dpdv), turned by flip.
                if (primitive.kind != Kind::triangle) {
                    const float side = dot(cross(point.dpdu, point.dpdv), point.n_geometric);
                    EXPECT_EQ(side < 0.0f, primitive.flip) << name;
                }
            }
        }
    }
}

TEST(Primitive, ALargeSphereIsFineAtItsTop)
{
    Primitive planet;
    planet.kind = Kind::sphere;
    planet.radius = 1e6f;
    planet.z_min = -1e6f;
    planet.z_max = 1e6f;
    planet.world_from_object = Transform(translation({0.0f, 0.0f, -1e6f}));
    for (uint64_t i = 0; i < 200; ++i) {
        Ray ray;
        ray.origin = Vec3(0.0f, 0.0f, 2.0f);
        ray.direction = normalize(Vec3(random_in_cube(i, 1).x, random_in_cube(i, 1).y, -1.0f));
        PrimitiveHit hit;
        ASSERT_TRUE(intersect(planet, ray, 0.0f, infinity, hit));
        EXPECT_LT(length(surface_point(planet, ray, hit).position - ray.at(hit.t)), 1e-5f);
    }
}

}  // namespace
}  // namespace dapple
