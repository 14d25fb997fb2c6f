// The equal-area map: unit length, inverse, equal areas (chi-squared over bands and sectors), orientation, seams.
#include "dapple/sampling/equal_area.h"

#include "dapple/math/hash.h"

#include <gtest/gtest.h>

#include <vector>

namespace dapple {
namespace {

Vec2 random_square(uint64_t i) { return {to_unit_float(hash_words(7, i, 0)), to_unit_float(hash_words(7, i, 1))}; }

TEST(EqualArea, InverseReturnsThePointAndDirectionsAreUnit)
{
    for (uint64_t i = 0; i < 20000; ++i) {
        const Vec2 p = random_square(i);
        const Vec3 d = equal_area_square_to_sphere(p);
        ASSERT_NEAR(length(d), 1.0f, 1e-6f);
        const Vec2 q = equal_area_sphere_to_square(d);
        ASSERT_NEAR(p.x, q.x, 2e-6f);
        ASSERT_NEAR(p.y, q.y, 2e-6f);
    }
}

TEST(EqualArea, InverseIsAccurateAtThePoles)
{
    for (float step : {1e-3f, 1e-5f, 1e-6f}) {
        for (float sign : {1.0f, -1.0f}) {
            const Vec3 d = normalize(Vec3(step, 0.5f * step, sign));
            const Vec3 e = equal_area_square_to_sphere(equal_area_sphere_to_square(d));
            EXPECT_NEAR(d.x, e.x, 2e-7f);
            EXPECT_NEAR(d.y, e.y, 2e-7f);
            EXPECT_EQ(std::signbit(d.z), std::signbit(e.z));
        }
    }
}

TEST(EqualArea, UniformPointsAreUniformOnTheSphere)
{
    // Bins of equal solid angle: 8 bands of z times 16 sectors of phi. Chi-squared with 127 degrees of freedom exceeds
    // 166.99 with probability 1 %.
    constexpr int bands = 8, sectors = 16, count = 128 * 1024;
    std::vector<int> bins(bands * sectors, 0);
    for (uint64_t i = 0; i < count; ++i) {
        const Vec3 d = equal_area_square_to_sphere(random_square(i));
        const int band = std::min(bands - 1, static_cast<int>((d.z + 1.0f) * 0.5f * bands));
        const float turn = std::atan2(d.y, d.x) / (2.0f * pi) + 0.5f;
        ++bins[static_cast<size_t>(band * sectors + std::min(sectors - 1, static_cast<int>(turn * sectors)))];
    }
    const double expected = static_cast<double>(count) / (bands * sectors);
    double chi2 = 0.0;
    for (int n : bins) chi2 += sqr(n - expected) / expected;
    EXPECT_LT(chi2, 166.99);
}

TEST(EqualArea, OrientationFollowsPbrt)
{
    const auto expect_direction = [](Vec2 p, Vec3 d) {
        EXPECT_LT(length(equal_area_square_to_sphere(p) - d), 1e-6f) << p.x << " " << p.y;
    };
    expect_direction({0.5f, 0.5f}, {0, 0, 1});
    expect_direction({0.0f, 0.0f}, {0, 0, -1});
    expect_direction({1.0f, 1.0f}, {0, 0, -1});
    expect_direction({1.0f, 0.5f}, {1, 0, 0});
    expect_direction({0.5f, 1.0f}, {0, 1, 0});
    expect_direction({0.0f, 0.5f}, {-1, 0, 0});
}

TEST(EqualArea, WrappingFollowsTheSphereAcrossTheRim)
{
    constexpr float step = 1e-3f;
    for (float s : {0.1f, 0.3f, 0.77f}) {
        for (const auto& [outside, inside] :
             {std::pair{Vec2(-step, s), Vec2(step, s)}, std::pair{Vec2(1 + step, s), Vec2(1 - step, s)},
              std::pair{Vec2(s, -step), Vec2(s, step)}, std::pair{Vec2(s, 1 + step), Vec2(s, 1 - step)}}) {
            const Vec2 wrapped = wrap_equal_area_square(outside);
            EXPECT_TRUE(wrapped.x >= 0 && wrapped.x <= 1 && wrapped.y >= 0 && wrapped.y <= 1);
            EXPECT_LT(length(equal_area_square_to_sphere(wrapped) - equal_area_square_to_sphere(inside)), 10 * step);
        }
    }
}

}  // namespace
}  // namespace dapple
