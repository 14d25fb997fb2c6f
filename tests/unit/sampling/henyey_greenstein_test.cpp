// The Henyey-Greenstein phase function: normalisation, mean cosine, side, sampling.

#include "dapple/sampling/henyey_greenstein.h"

#include "../media/numbers.h"
#include "statistics.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

using namespace testing_support;

// P(cosine of the scattering angle <= c), from the antiderivative of the phase function.
double cumulative(double g, double c)
{
    if (g == 0.0) return 0.5 * (1.0 + c);
    return (1.0 - g * g) / (2.0 * g) * (1.0 / std::sqrt(1.0 + g * g - 2.0 * g * c) - 1.0 / (1.0 + g));
}

TEST(HenyeyGreenstein, IntegratesToOneWithMeanCosineG)
{
    const Vec3 wo = normalize(Vec3(0.3f, -0.8f, 0.5f));
    const Frame frame(-wo);
    for (const float g : {-0.9f, -0.4f, 0.0f, 1e-4f, 0.3f, 0.8f, 0.97f}) {
        // In angle, which resolves the peak at either end; the midpoint rule.
        double sum = 0.0, mean = 0.0;
        const int n = 20000;
        for (int i = 0; i < n; ++i) {
            const double angle = M_PI * (i + 0.5) / n;
            const Vec3 wi = frame.to_world(
                spherical_direction(static_cast<float>(std::sin(angle)), static_cast<float>(std::cos(angle)), 1.0f));
            const double p = henyey_greenstein(g, wo, wi) * 2.0 * M_PI * std::sin(angle) * M_PI / n;
            sum += p;
            mean += p * std::cos(angle);
        }
        EXPECT_NEAR(sum, 1.0, 2e-5) << g;
        EXPECT_NEAR(mean, g, 2e-5) << g;
    }
}

TEST(HenyeyGreenstein, PositiveGScattersOnwards)
{
    const Vec3 wo(0, 0, 1);
    EXPECT_GT(henyey_greenstein(0.5f, wo, -wo), 10.0f * henyey_greenstein(0.5f, wo, wo));
    EXPECT_GT(henyey_greenstein(-0.5f, wo, wo), 10.0f * henyey_greenstein(-0.5f, wo, -wo));
    EXPECT_NEAR(henyey_greenstein(0.5f, wo, -wo), 0.25 * inv_pi * 0.75 / 0.125, 1e-5);
}

TEST(HenyeyGreenstein, SamplesFollowTheFunction)
{
    Numbers numbers(1);
    for (const float g : {-0.95f, -0.3f, 0.0f, 1e-5f, 0.6f, 0.9f, 0.99f}) {
        const Vec3 wo = numbers.direction();
        const Frame frame(-wo);
        // Cells of equal probability in v, cut in azimuth: all expect the same.
        constexpr int rows = 20, columns = 8, count = 40000;
        std::vector<double> counts(rows * columns, 0.0), expected(rows * columns, double(count) / (rows * columns));
        double mean = 0.0;
        for (int i = 0; i < count; ++i) {
            Vec3 wi;
            const float pdf = sample_henyey_greenstein(g, wo, numbers.next_2d(), wi);
            ASSERT_NEAR(length(wi), 1.0f, 1e-5f);
            const float value = henyey_greenstein(g, wo, wi);
            ASSERT_NEAR(pdf, value, 2e-3f * value + 1e-6f) << g;
            const Vec3 local = frame.to_local(wi);
            const double c = std::clamp<double>(local.z, -1.0, 1.0);
            mean += c / count;
            const int row = std::clamp(static_cast<int>(cumulative(g, c) * rows), 0, rows - 1);
            const double turn = std::atan2(local.y, local.x) / (2.0 * M_PI) + 0.5;
            counts[row * columns + std::clamp(static_cast<int>(turn * columns), 0, columns - 1)] += 1.0;
        }
        EXPECT_TRUE(chi_squared_passes(counts, expected)) << g;
        EXPECT_NEAR(mean, g, 4.0 * std::sqrt((1.0 - g * g) / count)) << g;
    }
}

TEST(HenyeyGreenstein, ExtremeValuesStayFinite)
{
    Numbers numbers(2);
    for (const float g : {-1.0f, -0.99999f, 0.99999f, 1.0f})
        for (const float u : {0.0f, 0.5f, one_minus_epsilon}) {
            Vec3 wi;
            const Vec3 wo = numbers.direction();
            const float pdf = sample_henyey_greenstein(g, wo, {u, 0.25f}, wi);
            EXPECT_TRUE(std::isfinite(pdf) && pdf > 0.0f && is_finite(wi)) << g << " " << u;
            EXPECT_NEAR(length(wi), 1.0f, 1e-4f);
            EXPECT_TRUE(std::isfinite(henyey_greenstein(g, wo, -wo)));
        }
}

}  // namespace
}  // namespace dapple
