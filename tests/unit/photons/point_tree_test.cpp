#include "dapple/photons/point_tree.h"

#include "clouds.h"
#include "dapple/base/parallel.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

struct BuiltTree {
    std::vector<uint32_t> order;
    PointTree tree;

    explicit BuiltTree(const std::vector<Vec3>& points) : tree(points, order) {}
};

// Radii that hold none, few and many of the points around q.
std::vector<float> test_radii(const std::vector<Vec3>& points, const Vec3& q)
{
    std::vector<float> distances;
    for (const Vec3& p : points) distances.push_back(distance_squared_between(p, q));
    std::sort(distances.begin(), distances.end());
    std::vector<float> radii = {0.0f, 1e-3f};
    for (const size_t rank : {size_t{0}, size_t{3}, size_t{60}, distances.size() / 2, distances.size()})
        if (rank < distances.size()) radii.push_back(std::sqrt(distances[rank]));
    radii.push_back(1e8f);
    return radii;
}

TEST(PointTree, KeepsEveryPointOnceAtTheSlotItNames)
{
    for (const NamedCloud& cloud : test_clouds()) {
        const BuiltTree built(cloud.points);
        ASSERT_EQ(built.tree.size(), cloud.points.size()) << cloud.name;
        std::vector<int> seen(cloud.points.size(), 0);
        for (uint32_t slot = 0; slot < built.tree.size(); ++slot) {
            ++seen[built.order[slot]];
            EXPECT_EQ(built.tree.position(slot), cloud.points[built.order[slot]]) << cloud.name;
        }
        EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<long>(seen.size())) << cloud.name;
        Box3 box;
        for (const Vec3& p : cloud.points) box.extendBy(p);
        EXPECT_TRUE(built.tree.bounds() == box) << cloud.name;
    }
}

TEST(PointTree, RangeQueriesFindWhatBruteForceFinds)
{
    for (const NamedCloud& cloud : test_clouds()) {
        const BuiltTree built(cloud.points);
        for (const Vec3& q : test_queries(cloud.points)) {
            for (const float radius : test_radii(cloud.points, q)) {
                std::vector<uint32_t> found, expected;
                built.tree.for_each_within(BallRegion{q}, radius * radius, AcceptAll{}, [&](uint32_t slot, float d) {
                    found.push_back(built.order[slot]);
                    EXPECT_EQ(d, distance_squared_between(cloud.points[built.order[slot]], q));
                });
                for (uint32_t i = 0; i < cloud.points.size(); ++i)
                    if (distance_squared_between(cloud.points[i], q) < radius * radius) expected.push_back(i);
                std::sort(found.begin(), found.end());
                ASSERT_EQ(found, expected) << cloud.name << ", radius " << radius;
            }
        }
    }
}

TEST(PointTree, LimitsOfTheirOwnKeepPointsFarOff)
{
    for (const NamedCloud& cloud : test_clouds()) {
        const BuiltTree built(cloud.points);
        const Box3 bounds = built.tree.bounds();
        const float extent = cloud.points.empty() ? 0.0f : length(bounds.max - bounds.min);
        // From none to nearly all of the cloud.
        std::vector<float> squared(cloud.points.size());
        for (uint32_t slot = 0; slot < built.tree.size(); ++slot)
            squared[slot] = sqr(extent * std::pow(10.0f, -4.0f * uniform_number(slot, 9)));
        const PointLimits limits = built.tree.limits(squared);
        for (const Vec3& q : test_queries(cloud.points)) {
            std::vector<uint32_t> found, expected;
            built.tree.for_each_reaching(BallRegion{q}, limits, AcceptAll{}, [&](uint32_t slot, float d) {
                found.push_back(slot);
                EXPECT_EQ(d, distance_squared_between(built.tree.position(slot), q));
                EXPECT_EQ(limits.squared(slot), squared[slot]);
            });
            for (uint32_t slot = 0; slot < built.tree.size(); ++slot)
                if (distance_squared_between(built.tree.position(slot), q) < squared[slot]) expected.push_back(slot);
            std::sort(found.begin(), found.end());
            EXPECT_EQ(found, expected) << cloud.name;
        }
    }
}

TEST(PointTree, NearestQueriesFindTheSmallestDistances)
{
    for (const NamedCloud& cloud : test_clouds()) {
        const BuiltTree built(cloud.points);
        for (const int k : {1, 2, 7, 8, 50, 333}) {
            NearestPoints nearest(k);
            for (const Vec3& q : test_queries(cloud.points)) {
                for (const float radius : {infinity, 0.1f}) {
                    built.tree.find_nearest(BallRegion{q}, radius * radius, AcceptAll{}, nearest);
                    std::vector<float> found, expected;
                    std::vector<uint32_t> slots;
                    for (int i = 0; i < nearest.count(); ++i) {
                        found.push_back(nearest.distance_squared(i));
                        slots.push_back(nearest.index(i));
                        const Vec3 p = built.tree.position(nearest.index(i));
                        EXPECT_EQ(nearest.distance_squared(i), distance_squared_between(p, q));
                    }
                    for (const Vec3& p : cloud.points)
                        if (const float d = distance_squared_between(p, q); d < radius * radius) expected.push_back(d);
                    std::sort(expected.begin(), expected.end());
                    expected.resize(std::min(expected.size(), static_cast<size_t>(k)));
                    std::sort(found.begin(), found.end());
                    ASSERT_EQ(found, expected) << cloud.name << ", k " << k << ", radius " << radius;
                    std::sort(slots.begin(), slots.end());
                    EXPECT_EQ(std::unique(slots.begin(), slots.end()), slots.end()) << cloud.name;
                    if (!found.empty()) {
                        EXPECT_EQ(nearest.distance_squared(nearest.farthest()), found.back());
                    }
                }
            }
        }
    }
}

TEST(PointTree, DiscQueriesObeyTheirOwnDistance)
{
    for (const NamedCloud& cloud : test_clouds()) {
        const BuiltTree built(cloud.points);
        for (const Vec3& q : test_queries(cloud.points)) {
            const DiscRegion disc{q, normalize(Vec3(0.3f, -0.5f, 0.9f)), 10.0f};
            const auto distance_squared = [&](const Vec3& p) {
                const Vec3 n = disc.normal * disc.inverse_flatness;
                const Vec3 d = p - q;
                return std::max(distance_squared_between(p, q), sqr(d.x * n.x + d.y * n.y + d.z * n.z));
            };
            std::vector<float> all;
            for (const Vec3& p : cloud.points) all.push_back(distance_squared(p));
            std::sort(all.begin(), all.end());
            NearestPoints nearest(20);
            built.tree.find_nearest(disc, infinity, AcceptAll{}, nearest);
            std::vector<float> found;
            for (int i = 0; i < nearest.count(); ++i) found.push_back(nearest.distance_squared(i));
            std::sort(found.begin(), found.end());
            ASSERT_EQ(found, std::vector<float>(all.begin(), all.begin() + static_cast<long>(found.size())));
            ASSERT_EQ(found.size(), std::min<size_t>(20, all.size()));
            const float limit = all.empty() ? 1.0f : all[all.size() / 3];
            size_t count = 0;
            built.tree.for_each_within(disc, limit, AcceptAll{}, [&](uint32_t, float) { ++count; });
            EXPECT_EQ(count, static_cast<size_t>(std::lower_bound(all.begin(), all.end(), limit) - all.begin()));
        }
    }
}

TEST(PointTree, FiltersAreAskedBeforePointsCount)
{
    const std::vector<Vec3> points = test_clouds()[6].points;
    const BuiltTree built(points);
    const auto odd_slots = [](uint32_t) { return 0xaau; };
    NearestPoints nearest(30);
    for (const Vec3& q : test_queries(points)) {
        built.tree.find_nearest(BallRegion{q}, infinity, odd_slots, nearest);
        std::vector<float> found, expected;
        for (int i = 0; i < nearest.count(); ++i) found.push_back(nearest.distance_squared(i));
        for (uint32_t slot = 1; slot < built.tree.size(); slot += 2)
            expected.push_back(distance_squared_between(built.tree.position(slot), q));
        std::sort(found.begin(), found.end());
        std::sort(expected.begin(), expected.end());
        expected.resize(30);
        ASSERT_EQ(found, expected);
    }
}

// Large enough for every parallel path of the builder.
TEST(PointTree, DoesNotDependOnThreads)
{
    std::vector<Vec3> points;
    for (uint64_t i = 0; i < 150000; ++i) {
        const Vec3 p(uniform_number(i, 1), uniform_number(i, 2), uniform_number(i, 3));
        points.push_back(i % 4 == 0 ? Vec3(p.x, 0.5f, std::floor(p.z * 64.0f)) : p);
    }
    std::vector<uint32_t> first_order;
    for (const int threads : {1, 2, 7}) {
        set_thread_count(threads);
        const BuiltTree built(points);
        if (first_order.empty()) first_order = built.order;
        EXPECT_EQ(built.order, first_order) << threads << " threads";
    }
    set_thread_count(0);
    std::sort(first_order.begin(), first_order.end());
    for (uint32_t i = 0; i < points.size(); ++i) ASSERT_EQ(first_order[i], i);
}

TEST(PointTree, AnswersAtTheSizeOfTheParallelPaths)
{
    std::vector<Vec3> points;
    for (uint64_t i = 0; i < 150000; ++i)
        points.push_back({uniform_number(i, 1), uniform_number(i, 2), 0.01f * uniform_number(i, 3)});
    const BuiltTree built(points);
    NearestPoints nearest(50);
    for (uint64_t i = 0; i < 20; ++i) {
        const Vec3 q = points[mix64(i) % points.size()];
        built.tree.find_nearest(BallRegion{q}, infinity, AcceptAll{}, nearest);
        const float limit = nearest.distance_squared(nearest.farthest());
        long nearer = 0;
        for (const Vec3& p : points) nearer += distance_squared_between(p, q) < limit;
        EXPECT_EQ(nearer, 49);
    }
}

TEST(PointTree, CostsAtMostSixteenBytesPerPoint)
{
    std::vector<Vec3> points;
    for (uint64_t i = 0; i < 100000; ++i)
        points.push_back({uniform_number(i, 1), uniform_number(i, 2), uniform_number(i, 3)});
    EXPECT_LT(BuiltTree(points).tree.memory_bytes(), 15.5 * static_cast<double>(points.size()));
}

}  // namespace
}  // namespace dapple
