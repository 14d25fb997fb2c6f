#include "dapple/density/kernels.h"
#include "dapple/density/schedule.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

// Integral over [0, 1] by the midpoint rule, in double precision apart from the kernel itself.
template <class F>
double integrate(const F& f)
{
    constexpr int steps = 20000;
    double sum = 0.0;
    for (int i = 0; i < steps; ++i) sum += f((i + 0.5) / steps);
    return sum / steps;
}

TEST(Kernels, IntegrateToOne)
{
    for (int k = 0; k < kernel_count; ++k) {
        const auto kind = static_cast<KernelKind>(k);
        const double pi_d = 3.14159265358979323846;
        EXPECT_NEAR(integrate([&](double t) { return 2 * pi_d * t * kernel_disc(kind, static_cast<float>(t)); }), 1.0,
                    1e-6)
            << kernel_names[static_cast<size_t>(k)];
        EXPECT_NEAR(integrate([&](double t) { return 4 * pi_d * t * t * kernel_ball(kind, static_cast<float>(t)); }),
                    1.0, 1e-6)
            << kernel_names[static_cast<size_t>(k)];
        EXPECT_NEAR(integrate([&](double t) { return 2 * kernel_segment(kind, static_cast<float>(t)); }), 1.0, 1e-6)
            << kernel_names[static_cast<size_t>(k)];
    }
}

TEST(Kernels, VanishOutsideAndFallWithDistance)
{
    for (int k = 0; k < kernel_count; ++k) {
        const auto kind = static_cast<KernelKind>(k);
        for (const auto kernel : {kernel_disc, kernel_ball, kernel_segment}) {
            EXPECT_EQ(kernel(kind, 1.0f), 0.0f);
            EXPECT_EQ(kernel(kind, 7.0f), 0.0f);
            EXPECT_EQ(kernel(kind, infinity), 0.0f);
            for (float t = 0.0f; t < 0.99f; t += 0.01f) {
                EXPECT_GT(kernel(kind, t), 0.0f);
                EXPECT_LE(kernel(kind, t + 0.01f), kernel(kind, t));
            }
        }
    }
}

TEST(Kernels, HaveTheShapesOfTheirNames)
{
    EXPECT_FLOAT_EQ(kernel_disc(KernelKind::constant, 0.9f), 1.0f / pi);
    EXPECT_FLOAT_EQ(kernel_disc(KernelKind::cone, 0.25f), 3.0f / pi * 0.75f);
    EXPECT_FLOAT_EQ(kernel_disc(KernelKind::epanechnikov, 0.5f), 2.0f / pi * 0.75f);
    EXPECT_FLOAT_EQ(kernel_disc(KernelKind::silverman, 0.5f), 3.0f / pi * 0.5625f);
    EXPECT_FLOAT_EQ(kernel_ball(KernelKind::constant, 0.1f), 0.75f / pi);
    EXPECT_FLOAT_EQ(kernel_ball(KernelKind::silverman, 0.5f), 105.0f / (32.0f * pi) * 0.5625f);
    EXPECT_FLOAT_EQ(kernel_segment(KernelKind::epanechnikov, 0.5f), 0.5625f);
    EXPECT_FLOAT_EQ(kernel_disc(KernelKind::gaussian, 0.4f) / kernel_disc(KernelKind::gaussian, 0.0f), std::exp(-0.5f));
}

TEST(Schedule, FollowsTheRecurrence)
{
    for (const double alpha : {0.3, 2.0 / 3.0, 0.9, 1.0}) {
        double product = 1.0;
        for (int64_t pass = 1; pass <= 200000; ++pass) {
            if (pass < 300 || pass % 9973 == 0) {
                ASSERT_NEAR(progressive_shrinkage(pass, alpha) / product, 1.0, 2e-10) << pass;
                for (const int d : {1, 2, 3})
                    ASSERT_NEAR(std::pow(progressive_radius(0.3, pass, d, alpha) / 0.3, d) / product, 1.0, 2e-10);
            }
            product *= (static_cast<double>(pass) + alpha) / (static_cast<double>(pass) + 1.0);
        }
    }
}

TEST(Schedule, AgreesWithTheGammaFunction)
{
    for (const int64_t pass : {int64_t{1}, int64_t{2}, int64_t{70}, int64_t{5000}}) {
        const double i = static_cast<double>(pass);
        const double a = progressive_alpha;
        EXPECT_NEAR(
            progressive_shrinkage(pass) / std::exp(std::lgamma(i + a) - std::lgamma(1 + a) - std::lgamma(i + 1)), 1.0,
            1e-9);
    }
    EXPECT_EQ(progressive_radius(0.25, 1, 2), 0.25);
    EXPECT_NEAR(progressive_radius(1.0, 2, 2), std::sqrt((1 + progressive_alpha) / 2), 1e-12);
}

}  // namespace
}  // namespace dapple
