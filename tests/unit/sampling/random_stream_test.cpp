// RandomStream: uniform in every dimension, stratified in the first ones, independent between dimensions and streams,
// and a pure function of its arguments.
#include "dapple/sampling/random_stream.h"

#include "statistics.h"

#include <gtest/gtest.h>

#include <set>

namespace dapple {
namespace {

using testing_support::chi_squared_limit;
using testing_support::chi_squared_passes;

// The number of one dimension, drawn one by one.
float number(uint64_t seed, uint64_t stream, uint32_t index, uint32_t dimension)
{
    RandomStream random(seed, stream, index);
    for (uint32_t d = 0; d < dimension; ++d) random.next();
    return random.next();
}

Vec2 pair(uint64_t seed, uint64_t stream, uint32_t index, uint32_t dimension)
{
    RandomStream random(seed, stream, index);
    for (uint32_t d = 0; d < dimension; d += 2) random.next_2d();
    return random.next_2d();
}

// Chi-squared statistic of pairs in a grid of side x side cells.
template <class Draw>
double grid_statistic(int n, int side, const Draw& draw)
{
    std::vector<double> counts(static_cast<size_t>(side) * side);
    for (int i = 0; i < n; ++i) {
        const Vec2 p = draw(i);
        EXPECT_TRUE(p.x >= 0.0f && p.x < 1.0f && p.y >= 0.0f && p.y < 1.0f);
        ++counts[static_cast<int>(p.y * side) * side + static_cast<int>(p.x * side)];
    }
    const double expected = static_cast<double>(n) / counts.size();
    double statistic = 0.0;
    for (const double count : counts) statistic += (count - expected) * (count - expected) / expected;
    return statistic;
}

TEST(RandomStream, IsAPureFunction)
{
    RandomStream a(1, 2, 3), b(1, 2, 3);
    for (int i = 0; i < 100; ++i) {
        EXPECT_EQ(a.next(), b.next());
        EXPECT_EQ(a.next_2d(), b.next_2d());
        EXPECT_EQ(a.dimension(), static_cast<uint32_t>(3 * (i + 1)));
    }
    const float here = number(1, 2, 3, 5);
    EXPECT_NE(here, number(2, 2, 3, 5));
    EXPECT_NE(here, number(1, 3, 3, 5));
    EXPECT_NE(here, number(1, 2, 4, 5));
    EXPECT_NE(here, number(1, 2, 3, 6));
}

TEST(RandomStream, KeepsItsValuesAcrossVersions)
{
    // Replayed paths depend on these.
    EXPECT_EQ(hash_words(42, 7), 0x16062d6c1339e500ull);
    RandomStream random(42, 7, 1000);
    EXPECT_FLOAT_EQ(random.next(), 0.0226078033f);
    const Vec2 p = random.next_2d();
    EXPECT_FLOAT_EQ(p.x, 0.712992787f);
    EXPECT_FLOAT_EQ(p.y, 0.578911066f);
}

TEST(RandomStream, FirstDimensionsAreStratified)
{
    // Any aligned block of 2^k indices puts one point into each of 2^k intervals.
    for (const uint32_t dimension : {0u, 1u, 2u, 17u, 63u})
        for (const int log_n : {3, 6, 10}) {
            const uint32_t n = 1u << log_n;
            for (const uint32_t block : {0u, 1u, 5u}) {
                std::set<uint32_t> intervals;
                for (uint32_t i = 0; i < n; ++i)
                    intervals.insert(static_cast<uint32_t>(number(3, 9, block * n + i, dimension) * n));
                EXPECT_EQ(intervals.size(), n) << dimension << " " << n;
            }
        }
}

TEST(RandomStream, PairsAreANet)
{
    // Of 2^k points, one lies in each elementary interval of 2^a x 2^(k-a) cells: a (0, k, 2)-net.
    const int log_n = 8;
    const uint32_t n = 1u << log_n;
    for (const uint32_t dimension : {0u, 2u, 30u, 62u})
        for (int a = 0; a <= log_n; ++a) {
            const uint32_t columns = 1u << a, rows = n / columns;
            std::set<uint32_t> cells;
            for (uint32_t i = 0; i < n; ++i) {
                const Vec2 p = pair(4, 1, i, dimension);
                cells.insert(static_cast<uint32_t>(p.y * rows) * columns + static_cast<uint32_t>(p.x * columns));
            }
            EXPECT_EQ(cells.size(), n) << dimension << " " << a;
        }
}

TEST(RandomStream, LaterDimensionsAreUniform)
{
    for (const uint32_t dimension : {64u, 65u, 100u, 301u}) {
        const int n = 20000, cells = 50;
        std::vector<double> counts(cells), expected(cells, n / double(cells));
        for (int i = 0; i < n; ++i) ++counts[static_cast<int>(number(5, 0, i, dimension) * cells)];
        EXPECT_TRUE(chi_squared_passes(counts, expected)) << dimension;
    }
    EXPECT_LT(grid_statistic(20000, 12, [](int i) { return pair(5, 1, i, 70); }), chi_squared_limit(143));
}

TEST(RandomStream, OnePathIsUniformOverItsStreams)
{
    // Pixels: the first points of many streams are random, not a lattice.
    for (const uint32_t dimension : {0u, 2u, 40u})
        EXPECT_LT(grid_statistic(20000, 12, [=](int i) { return pair(6, i, 0, dimension); }), chi_squared_limit(143));
    for (const uint32_t index : {1u, 77u})
        EXPECT_LT(grid_statistic(20000, 12, [=](int i) { return pair(6, i, index, 4); }), chi_squared_limit(143));
}

TEST(RandomStream, DimensionsAreIndependent)
{
    // Numbers of different dimensions of one stream, as pairs: uniform in the square (stratification only helps).
    const uint32_t dimensions[][2] = {{0, 1}, {0, 2}, {1, 2}, {3, 10}, {0, 63}, {62, 64}, {64, 65}, {5, 90}};
    for (const auto& d : dimensions) {
        const auto draw = [&](int i) { return Vec2(number(7, 3, i, d[0]), number(7, 3, i, d[1])); };
        EXPECT_LT(grid_statistic(8192, 16, draw), chi_squared_limit(255)) << d[0] << " " << d[1];
    }
    // The y of one pair against the x of the next.
    EXPECT_LT(grid_statistic(8192, 16, [](int i) { return Vec2(pair(7, 3, i, 0).y, pair(7, 3, i, 2).x); }),
              chi_squared_limit(255));
}

TEST(RandomStream, StreamsAndSeedsAreIndependent)
{
    EXPECT_LT(grid_statistic(8192, 16, [](int i) { return Vec2(number(8, 1, i, 0), number(8, 2, i, 0)); }),
              chi_squared_limit(255));
    EXPECT_LT(grid_statistic(8192, 16, [](int i) { return Vec2(number(8, 1, i, 4), number(9, 1, i, 4)); }),
              chi_squared_limit(255));
    // Successive indices of one stream far apart in dimension.
    EXPECT_LT(grid_statistic(8192, 16, [](int i) { return Vec2(number(8, 1, i, 80), number(8, 1, i + 1, 80)); }),
              chi_squared_limit(255));
}

TEST(RandomStream, IntegratesFasterThanChance)
{
    // Mean of x y over 1024 points: an independent sampler errs by 0.22 / 32 = 7e-3, a scrambled net by far less.
    double squares = 0.0;
    for (uint64_t stream = 0; stream < 32; ++stream) {
        double sum = 0.0;
        for (uint32_t i = 0; i < 1024; ++i) {
            const Vec2 p = pair(10, stream, i, 0);
            sum += static_cast<double>(p.x) * p.y;
        }
        squares += (sum / 1024.0 - 0.25) * (sum / 1024.0 - 0.25) / 32.0;
    }
    EXPECT_LT(std::sqrt(squares), 4e-4);
}

TEST(RandomStream, IndicesCoverTheirRange)
{
    std::vector<double> counts(7), expected(7, 1000.0);
    for (uint32_t i = 0; i < 7000; ++i) {
        RandomStream random(11, i, 0);
        ++counts[random.next_index(7)];
    }
    EXPECT_TRUE(chi_squared_passes(counts, expected));
    RandomStream random(12, 0, 0);
    for (int i = 0; i < 100; ++i) {
        EXPECT_EQ(random.next_index(1), 0u);
        EXPECT_LT(random.next_index(0xffffffffu), 0xffffffffu);
    }
}

TEST(RandomStream, SecondSobolDimensionIsTheSumOfItsDirectionNumbers)
{
    for (uint32_t i = 0; i < 2000; ++i) {
        const uint32_t index = i < 1000 ? i : static_cast<uint32_t>(mix64(i));
        uint32_t expected = 0;
        for (uint32_t bit = 0, direction = 1u << 31; bit < 32; ++bit, direction ^= direction >> 1)
            if (index >> bit & 1u) expected ^= direction;
        ASSERT_EQ(detail::reverse_bits(detail::sobol_second_reversed(index)), expected) << index;
    }
}

}  // namespace
}  // namespace dapple
