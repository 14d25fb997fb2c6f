// What a render under a time limit can afford, with trials that take what the test says.
#include "dapple/render/pilot.h"

#include <gtest/gtest.h>

#include <vector>

namespace dapple {
namespace {

constexpr Effort million{"photons", "light paths per pass", 1'000'000, 8192, 1.0 / 3};

// Trials of `base` seconds and `each` more for each light path.
struct FakeWork {
    double base = 0.0, each = 0.0;
    std::vector<int64_t> tried{};
    double operator()(int64_t n)
    {
        tried.push_back(n);
        return base + each * static_cast<double>(n);
    }
    double spent() const
    {
        double sum = 0.0;
        for (int64_t n : tried) sum += base + each * static_cast<double>(n);
        return sum;
    }
};

TEST(Pilot, LeavesWhatTakesLittle)
{
    FakeWork work{0.0, 1e-6};  // a second for all
    EXPECT_EQ(affordable(million, 60.0, std::ref(work)), 1'000'000);
    EXPECT_EQ(work.tried, std::vector<int64_t>{8192});
}

TEST(Pilot, HalvesWhatTakesLong)
{
    FakeWork work{0.0, 10e-6};  // ten seconds for all, a limit of ten
    const int64_t chosen = affordable(million, 10.0, std::ref(work));
    EXPECT_EQ(chosen, 250'000);
    EXPECT_LE(work(chosen), 10.0 / 3);
}

TEST(Pilot, TriesGrowUntilTheyTell)
{
    for (const double limit : {1.0, 5.0, 10.0, 60.0, 600.0})
        for (const double each : {1e-7, 1e-6, 1e-5, 1e-4}) {
            FakeWork work{0.001, each};
            const int64_t chosen = affordable(million, limit, std::ref(work));
            const double expected = 0.001 + each * static_cast<double>(chosen);
            EXPECT_TRUE(chosen == million.least || expected <= limit / 3 * 1.001) << limit << ' ' << each;
            // No smaller than it must be.
            const double twice = 0.001 + 2.0 * each * static_cast<double>(chosen);
            EXPECT_TRUE(chosen == million.automatic || twice > limit / 3 * 0.999) << limit << ' ' << each;
            // Unless the very least takes longer, trials are cheap.
            const double least = 0.001 + each * static_cast<double>(million.least);
            EXPECT_TRUE(least > 0.015 * limit || work.spent() < 0.09 * limit) << limit << ' ' << each;
        }
}

// What the maps of another number would take as well is no reason to lower this one.
TEST(Pilot, DoesNotBlameTheNumberForWhatIsFixed)
{
    FakeWork work{0.1, 1e-6};
    EXPECT_EQ(affordable(million, 10.0, std::ref(work)), 1'000'000);
}

TEST(Pilot, LeavesAFewHoweverSlow)
{
    FakeWork work{0.0, 1.0};
    EXPECT_EQ(affordable(million, 5.0, std::ref(work)), million.least);
    const Effort few{"photons", "light paths per pass", 100, 8192, 1.0 / 3};
    EXPECT_EQ(affordable(few, 5.0, std::ref(work)), 100);
}

// As a clock that stands still would say.
TEST(Pilot, TakesWorkOfNoTime)
{
    FakeWork work{0.0, 0.0};
    EXPECT_EQ(affordable(million, 1e-3, std::ref(work)), 1'000'000);
}

}  // namespace
}  // namespace dapple
