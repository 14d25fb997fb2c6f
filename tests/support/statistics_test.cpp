// The statistics that judge the renders, held to tabulated values of Student's distribution.
#include "support/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace dapple::testing {
namespace {

TEST(Statistics, StudentsDistributionMeetsTheTables)
{
    // Two-sided 5 % and 0.1 % points, from any table.
    EXPECT_NEAR(student_two_sided(12.706, 1), 0.05, 1e-5);
    EXPECT_NEAR(student_two_sided(2.131, 15), 0.05, 5e-5);
    EXPECT_NEAR(student_two_sided(4.073, 15), 0.001, 1e-6);
    EXPECT_NEAR(student_two_sided(3.291, 1e7), 0.001, 2e-6);
    EXPECT_NEAR(student_two_sided(0, 7), 1, 1e-12);
}

TEST(Statistics, EstimatesMeanAndErrorOfTheMean)
{
    const Estimate e = estimate({1, 2, 3, 4});
    EXPECT_DOUBLE_EQ(e.mean, 2.5);
    EXPECT_NEAR(e.error, std::sqrt(5.0 / 3 / 4), 1e-12);
}

TEST(Statistics, DistancesBeyondTheAllowanceCount)
{
    const Estimate a{1, 0.01, 16};
    EXPECT_LT(p_value(a, 1.2), 1e-9);
    EXPECT_EQ(p_value(a, 1.2, 0.2 + 1e-9), 1);
    EXPECT_NEAR(p_value(a, 1 + 2.131 * 0.01), 0.05, 1e-4);
    EXPECT_NEAR(p_value(a, Estimate{1 + 0.02, 0.01, 16}), 0.168, 0.005);  // t = 1.414 with 30 degrees of freedom
}

TEST(Statistics, WithoutErrorOnlyEqualityWillDo)
{
    EXPECT_EQ(p_value(Estimate{0, 0, 16}, 0.0), 1);
    EXPECT_EQ(p_value(Estimate{1e-6, 0, 16}, 0.0), 0);
}

}  // namespace
}  // namespace dapple::testing
