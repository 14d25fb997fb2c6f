// Alias table and piecewise constant densities: chi-squared, densities by quadrature, inverses, degenerate tables.
#include "dapple/sampling/piecewise.h"

#include "dapple/math/hash.h"
#include "statistics.h"

#include <gtest/gtest.h>

#include <set>

namespace dapple {
namespace {

using testing_support::chi_squared_passes;

float uniform(uint64_t seed, uint64_t i) { return to_unit_float(hash_words(seed, i)); }

TEST(AliasTable, FollowsItsWeights)
{
    const std::vector<float> weights = {1.0f, 0.0f, 3.0f, 0.25f, 10.0f, 0.0f, 2.5f};
    const AliasTable table(weights);
    const int n = 200000;
    std::vector<double> counts(weights.size()), expected(weights.size());
    for (int i = 0; i < n; ++i) ++counts[table.sample(uniform(1, i))];
    double sum = 0.0;
    for (uint32_t i = 0; i < weights.size(); ++i) {
        expected[i] = n * weights[i] / 16.75;
        EXPECT_NEAR(table.probability(i), weights[i] / 16.75f, 1e-7f);
        sum += table.probability(i);
    }
    EXPECT_NEAR(sum, 1.0, 1e-6);
    EXPECT_TRUE(chi_squared_passes(counts, expected));
    counts[0] += 0.01 * n;  // the test itself can tell a wrong table
    EXPECT_FALSE(chi_squared_passes(counts, expected));
}

TEST(AliasTable, RemapsWhatIsLeftOfTheNumberUniformly)
{
    const std::vector<float> weights = {5.0f, 1.0f, 2.0f};
    const AliasTable table(weights);
    const int n = 120000, cells = 8;
    std::vector<double> counts(3 * cells), expected(3 * cells);
    for (int i = 0; i < n; ++i) {
        float rest = -1.0f;
        const uint32_t index = table.sample(uniform(2, i), &rest);
        ASSERT_GE(rest, 0.0f);
        ASSERT_LT(rest, 1.0f);
        ++counts[index * cells + static_cast<int>(rest * cells)];
    }
    for (int i = 0; i < 3 * cells; ++i) expected[i] = n * weights[i / cells] / 8.0 / cells;
    EXPECT_TRUE(chi_squared_passes(counts, expected));
}

// A number that chose something improbable has few bits left: a millionth leaves 17 values, a thousandth enough.
TEST(AliasTable, KnowsWhetherRemappedNumbersAreFine)
{
    const auto table = [](float weight) { return AliasTable(std::vector<float>{1.0f, weight, 0.0f}); };
    const auto values = [](const AliasTable& of) {
        std::set<float> rest;
        for (uint32_t i = 0; i < 1u << 24; ++i) {
            float remapped = 0.0f;
            if (of.sample(static_cast<float>(i) * 0x1p-24f, &remapped) == 1) rest.insert(remapped);
        }
        return rest.size();
    };
    EXPECT_FALSE(table(1e-6f).remaps_finely());
    EXPECT_LT(values(table(1e-6f)), 40u);
    EXPECT_TRUE(table(1e-3f).remaps_finely());
    EXPECT_GT(values(table(1e-3f)), 10000u);
    EXPECT_TRUE(table(1.0f).remaps_finely());
    EXPECT_FALSE(AliasTable(std::vector<float>(2000, 1.0f)).remaps_finely());
}

TEST(AliasTable, NeverChoosesZeroWeights)
{
    std::vector<float> weights(1000, 0.0f);
    for (size_t i = 0; i < weights.size(); i += 7) weights[i] = 0.1f + uniform(3, i);
    const AliasTable table(weights);
    for (int i = 0; i < 200000; ++i) ASSERT_GT(weights[table.sample(uniform(4, i))], 0.0f);
    for (uint32_t i = 0; i < 1u << 16; ++i)  // both ends of every bin
        ASSERT_GT(weights[table.sample(static_cast<float>(i) * 0x1p-16f)], 0.0f);
    EXPECT_GT(weights[table.sample(one_minus_epsilon)], 0.0f);
}

TEST(AliasTable, AllZeroMeansUniform)
{
    const AliasTable table(std::vector<float>(4, 0.0f));
    for (uint32_t i = 0; i < 4; ++i) {
        EXPECT_FLOAT_EQ(table.probability(i), 0.25f);
        EXPECT_EQ(table.sample((static_cast<float>(i) + 0.5f) / 4.0f), i);
    }
}

TEST(Distribution1D, SamplesItsDensity)
{
    const std::vector<float> values = {0.0f, 2.0f, 1.0f, 0.0f, 5.0f, 0.5f, 0.0f};
    const Distribution1D distribution(values);
    EXPECT_FLOAT_EQ(distribution.integral(), 8.5f / 7.0f);
    const int n = 200000, cells = 70;
    std::vector<double> counts(cells), expected(cells);
    for (int i = 0; i < n; ++i) {
        float density = 0.0f;
        const float x = distribution.sample(uniform(5, i), &density);
        ASSERT_GE(x, 0.0f);
        ASSERT_LT(x, 1.0f);
        ASSERT_EQ(density, distribution.density(x));
        ASSERT_GT(density, 0.0f);
        ++counts[static_cast<int>(x * cells)];
    }
    for (int i = 0; i < cells; ++i) expected[i] = n * distribution.density((i + 0.5f) / cells) / cells;
    EXPECT_TRUE(chi_squared_passes(counts, expected));
}

TEST(Distribution1D, SampleInvertsTheCumulativeDensity)
{
    const std::vector<float> values = {0.5f, 2.0f, 0.0f, 1.0f, 4.5f};
    const Distribution1D distribution(values);
    for (int i = 0; i < 1000; ++i) {
        const float u = (static_cast<float>(i) + 0.5f) / 1000.0f;
        const float x = distribution.sample(u, nullptr);
        double cumulative = 0.0;
        for (int cell = 0; cell < 5; ++cell) cumulative += std::clamp(x * 5.0 - cell, 0.0, 1.0) * values[cell] / 8.0;
        EXPECT_NEAR(cumulative, u, 1e-6);
    }
}

TEST(Distribution1D, BordersBelongToTheSampledCell)
{
    for (const int size : {1, 3, 61, 1023}) {
        std::vector<float> values(size);
        for (int i = 0; i < size; ++i) values[i] = i % 3 == 1 ? 0.0f : 1.0f + static_cast<float>(i % 5);
        const Distribution1D distribution(values);
        for (uint32_t i = 0; i <= 1u << 14; ++i) {
            float density = 0.0f;
            const float x = distribution.sample(std::min(static_cast<float>(i) * 0x1p-14f, 1.0f), &density);
            ASSERT_EQ(density, distribution.density(x));
            ASSERT_GT(density, 0.0f);
            ASSERT_LT(x, 1.0f);
        }
    }
}

TEST(Distribution1D, AllZeroMeansUniform)
{
    const Distribution1D distribution(std::vector<float>(3, 0.0f));
    float density = 0.0f;
    EXPECT_NEAR(distribution.sample(0.4f, &density), 0.4f, 1e-6f);
    EXPECT_EQ(density, 1.0f);
    EXPECT_EQ(distribution.integral(), 0.0f);
}

TEST(Distribution2D, SamplesItsDensity)
{
    const int width = 6, height = 4;
    std::vector<float> values(width * height);
    for (int i = 0; i < width * height; ++i) values[i] = i % 5 == 0 ? 0.0f : 0.2f + 3.0f * uniform(6, i);
    for (int i = 0; i < width; ++i) values[2 * width + i] = 0.0f;  // one empty row
    const Distribution2D distribution(values, width, height);

    const int n = 300000, fine = 2;
    std::vector<double> counts(values.size() * fine * fine), expected(counts.size());
    for (int i = 0; i < n; ++i) {
        float density = 0.0f;
        const Vec2 p = distribution.sample({uniform(7, i), uniform(8, i)}, &density);
        ASSERT_NEAR(density, distribution.density(p), 1e-6f * density);
        ++counts[static_cast<int>(p.y * height * fine) * width * fine + static_cast<int>(p.x * width * fine)];
    }
    double integral = 0.0;
    for (int y = 0; y < height * fine; ++y)
        for (int x = 0; x < width * fine; ++x) {
            const Vec2 centre((x + 0.5f) / (width * fine), (y + 0.5f) / (height * fine));
            const double mass = distribution.density(centre) / static_cast<double>(counts.size());
            integral += mass;
            expected[y * width * fine + x] = n * mass;
        }
    EXPECT_NEAR(integral, 1.0, 1e-6);
    EXPECT_TRUE(chi_squared_passes(counts, expected));

    double mean = 0.0;
    for (const float v : values) mean += v / (width * height);
    EXPECT_NEAR(distribution.integral(), mean, 1e-6);
}

}  // namespace
}  // namespace dapple
