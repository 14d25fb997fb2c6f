#include "dapple/photons/hash_grid.h"

#include "clouds.h"
#include "dapple/base/parallel.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

TEST(HashGrid, FindsWhatBruteForceFinds)
{
    for (const NamedCloud& cloud : test_clouds()) {
        for (const float radius : {1e-44f, 1e-30f, 1e-12f, 1e-4f, 0.03f, 0.2f, 3.0f, 1e6f, 1e30f, infinity}) {
            const HashGrid grid(cloud.points, radius);
            ASSERT_EQ(grid.size(), cloud.points.size());
            for (const Vec3& q : test_queries(cloud.points)) {
                std::vector<uint32_t> found, expected;
                grid.for_each_within(q, [&](uint32_t i, float d) {
                    found.push_back(i);
                    EXPECT_EQ(d, distance_squared_between(cloud.points[i], q));
                });
                for (uint32_t i = 0; i < cloud.points.size(); ++i)
                    if (distance_squared_between(cloud.points[i], q) < radius * radius) expected.push_back(i);
                std::sort(found.begin(), found.end());
                ASSERT_EQ(found, expected) << cloud.name << ", radius " << radius;
            }
        }
    }
}

TEST(HashGrid, VisitsInAnOrderThatDoesNotDependOnThreads)
{
    std::vector<Vec3> points;
    for (uint64_t i = 0; i < 200000; ++i)
        points.push_back({uniform_number(i, 1), uniform_number(i, 2), uniform_number(i, 3)});
    std::vector<uint32_t> first;
    for (const int threads : {1, 2, 7}) {
        set_thread_count(threads);
        const HashGrid grid(points, 0.05f);
        std::vector<uint32_t> visited;
        for (uint64_t i = 0; i < 200; ++i)
            grid.for_each_within(points[i * 999], [&](uint32_t index, float) { visited.push_back(index); });
        if (first.empty()) first = visited;
        EXPECT_EQ(visited, first) << threads << " threads";
    }
    set_thread_count(0);
    EXPECT_GT(first.size(), 2000u);
}

}  // namespace
}  // namespace dapple
