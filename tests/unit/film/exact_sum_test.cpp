#include "dapple/film/exact_sum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

namespace dapple {
namespace {

// A sum as films keep theirs.
class ExactSum {
public:
    // Adds a term and returns true; returns false and adds nothing if the term is refused.
    bool add(double term)
    {
        if (!exact_sum_accepts(term)) return false;
        sum_ += to_fixed(term);
        return true;
    }
    void add(const ExactSum& other) { sum_ += other.sum_; }
    double value() const { return from_fixed(sum_); }
    Fixed128 fixed() const { return sum_; }

private:
    Fixed128 sum_ = 0;
};

// Terms of either sign over many magnitudes.
std::vector<float> random_terms(int count)
{
    std::mt19937 random(7);
    std::uniform_real_distribution<float> mantissa(-1.0f, 1.0f);
    std::uniform_int_distribution<int> exponent(-30, 30);
    std::vector<float> terms(count);
    for (float& term : terms) term = std::ldexp(mantissa(random), exponent(random));
    return terms;
}

TEST(ExactSum, OrderLeavesNoTrace)
{
    std::vector<float> terms = random_terms(10000);
    ExactSum first;
    for (const float term : terms) ASSERT_TRUE(first.add(term));
    std::mt19937 random(3);
    for (int round = 0; round < 5; ++round) {
        std::shuffle(terms.begin(), terms.end(), random);
        ExactSum parts[3];
        for (size_t i = 0; i < terms.size(); ++i) parts[random() % 3].add(terms[i]);
        parts[0].add(parts[1]);
        parts[0].add(parts[2]);
        EXPECT_TRUE(parts[0].fixed() == first.fixed());
    }
}

TEST(ExactSum, AgreesWithLongDouble)
{
    long double expected = 0.0L;
    ExactSum sum;
    for (const float term : random_terms(10000)) {
        expected += term;
        sum.add(term);
    }
    EXPECT_NEAR(sum.value(), static_cast<double>(expected), 1e-9 * std::fabs(static_cast<double>(expected)) + 1e-9);
}

TEST(ExactSum, GridIsExactBetweenItsEnds)
{
    for (const double term :
         {0x1p-60, -0x1p-60, 1.0, -1.0, 0.1, 3.0e9, -0x1.fffffep43, 0x1p44, 4.0, -4.0, 0x1p2, 0x1p1}) {
        ExactSum sum;
        ASSERT_TRUE(sum.add(term));
        // 0.1 has bits below the grid; all others lie on it.
        if (term == 0.1)
            EXPECT_NEAR(sum.value(), term, 0x1p-61);
        else
            EXPECT_EQ(sum.value(), term);
        ASSERT_TRUE(sum.add(-term));
        EXPECT_EQ(sum.value(), 0.0);
    }
    ExactSum rounded;
    rounded.add(0x1p-62);
    EXPECT_EQ(rounded.value(), 0.0);
}

TEST(ExactSum, RefusesWhatItCannotHold)
{
    ExactSum sum;
    sum.add(2.5);
    for (const double term : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                              -std::numeric_limits<double>::infinity(), 0x1.1p44, -0x1.1p44, 1e30})
        EXPECT_FALSE(sum.add(term));
    EXPECT_EQ(sum.value(), 2.5);
}

TEST(ExactSum, ManyLargeTermsDoNotWrap)
{
    ExactSum sum;
    for (int i = 0; i < 1 << 20; ++i) sum.add(-0x1p44);
    EXPECT_EQ(sum.value(), -0x1p64);
}

}  // namespace
}  // namespace dapple
