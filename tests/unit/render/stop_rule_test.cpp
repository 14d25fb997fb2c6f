// Stop rules: passes are exact, times are kept as nearly as whole passes allow.
#include "dapple/render/stop_rule.h"

#include <gtest/gtest.h>

#include <cmath>

namespace dapple {
namespace {

TEST(StopRule, CountsPasses)
{
    const StopRule rule{3, 0};
    EXPECT_TRUE(rule.another(0, 0, 0));
    EXPECT_TRUE(rule.another(2, 1e9, 1e9));
    EXPECT_FALSE(rule.another(3, 0, 0));
}

TEST(StopRule, AlwaysHasAFirstPass)
{
    const StopRule rule{0, 1e-9};
    EXPECT_TRUE(rule.another(0, 5, 0));
    EXPECT_FALSE(rule.another(1, 5, 5));
}

// Passes of a tenth of the limit or less keep it within 5 %, whatever their length.
TEST(StopRule, KeepsTheTimeWithinFivePercent)
{
    const StopRule rule{0, 60};
    for (double pass = 0.05; pass <= 6; pass *= 1.17) {
        PassTimes times;
        double elapsed = 0;
        uint32_t done = 0;
        while (rule.another(done, elapsed, times.expected())) {
            const double taken = pass * (done % 2 ? 1.02 : 0.98);  // passes vary a little
            elapsed += taken;
            times.add(taken);
            ++done;
        }
        EXPECT_LE(std::abs(elapsed - 60), 0.0521 * 60) << "passes of " << pass << " s";
    }
}

TEST(StopRule, WhicheverComesFirst)
{
    const StopRule rule{10, 60};
    EXPECT_FALSE(rule.another(10, 1, 0.1));
    EXPECT_FALSE(rule.another(2, 61, 0.1));
    EXPECT_TRUE(rule.another(2, 1, 0.1));
}

TEST(StopRule, KnowsTheLastPassAndTheOverdueOne)
{
    const StopRule rule{0, 10};
    EXPECT_FALSE(rule.last_by_time(5, 2));
    EXPECT_TRUE(rule.last_by_time(8, 2));
    EXPECT_FALSE(rule.overdue(10.39));
    EXPECT_TRUE(rule.overdue(10.41));
    EXPECT_FALSE((StopRule{5, 0}.overdue(1e9)));
}

TEST(StopRule, FractionStaysBelowOneAndDoesNotRunIntoTheNextPass)
{
    const StopRule rule{4, 0};
    EXPECT_DOUBLE_EQ(rule.fraction(1, 0, 0.5, 1), 0.375);
    EXPECT_LT(rule.fraction(1, 0, 50, 1), 0.5);
    EXPECT_LT(rule.fraction(4, 0, 0, 1), 1.0);
    EXPECT_LT((StopRule{0, 10}.fraction(1, 1000, 0, 1)), 1.0);
}

TEST(StopRule, RemainingIsTheNearerEnd)
{
    EXPECT_DOUBLE_EQ((StopRule{4, 0}.remaining(1, 0, 0.5, 2)), 5.5);
    EXPECT_DOUBLE_EQ((StopRule{4, 3}.remaining(1, 1, 0.5, 2)), 2);
    EXPECT_LT((StopRule{4, 0}.remaining(0, 1, 1, 0)), 0);
    EXPECT_DOUBLE_EQ((StopRule{4, 0}.remaining(3, 0, 9, 2)), 0);
}

TEST(PassTimes, ForgetTheFirstPassWhenItWasSlower)
{
    PassTimes times;
    EXPECT_EQ(times.expected(), 0);
    times.add(10);
    EXPECT_DOUBLE_EQ(times.expected(), 10);
    times.add(2);
    EXPECT_DOUBLE_EQ(times.expected(), 2);
    times.add(4);
    EXPECT_DOUBLE_EQ(times.expected(), 3);
    for (int i = 0; i < 20; ++i) times.add(1);
    EXPECT_DOUBLE_EQ(times.expected(), 1);
}

TEST(StopRule, SaysThatAnErrorIsNotReached)
{
    const StopRule rule{0, 10, 0.05};
    EXPECT_EQ(rule.error_missed(0.0912), "; the estimated error is 9.12 %, not yet 5 %");
    EXPECT_EQ(rule.error_missed(0.05), "");
    EXPECT_EQ((StopRule{0, 10}).error_missed(1), "");
}

TEST(StopRule, LeavesTimeForWhatComesAfter)
{
    EXPECT_DOUBLE_EQ((StopRule{0, 10}).leaving(1.5).seconds, 8.5);
    EXPECT_GT((StopRule{0, 1}).leaving(2).seconds, 0.0);  // 0 would be no limit
    EXPECT_EQ((StopRule{5, 0}).leaving(2).seconds, 0.0);
}

}  // namespace
}  // namespace dapple
