#include "dapple/film/filter.h"

#include "dapple/base/error.h"
#include "dapple/math/hash.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace dapple {
namespace {

std::vector<FilterShape> shapes()
{
    std::vector<FilterShape> result;
    for (const auto kind : {FilterShape::Kind::box, FilterShape::Kind::triangle, FilterShape::Kind::gaussian,
                            FilterShape::Kind::mitchell, FilterShape::Kind::sinc}) {
        FilterShape shape;
        shape.kind = kind;
        shape.radius = FilterShape::default_radius(kind);
        result.push_back(shape);
        shape.radius = {2.75f, 1.25f};
        result.push_back(shape);
    }
    return result;
}

std::string name(const FilterShape& shape)
{
    return "kind " + std::to_string(static_cast<int>(shape.kind)) + " radius " + std::to_string(shape.radius.x);
}

// Integral of g over the axis' support by the midpoint rule.
template <class Function>
double integrate(double low, double high, const Function& g)
{
    const int steps = 40000;
    double sum = 0.0;
    for (int i = 0; i < steps; ++i) sum += g(low + (high - low) * (i + 0.5) / steps);
    return sum * (high - low) / steps;
}

TEST(Filter, IntegratesToOne)
{
    for (const FilterShape& shape : shapes()) {
        const Filter filter(shape);
        for (int axis = 0; axis < 2; ++axis) {
            const double r = shape.radius[axis];
            EXPECT_NEAR(integrate(-r, r, [&](double x) { return filter.evaluate_axis(axis, float(x)); }), 1.0, 2e-5)
                << name(shape);
        }
        EXPECT_EQ(filter.evaluate({shape.radius.x, 0.0f}), 0.0f);
        EXPECT_EQ(filter.evaluate({-shape.radius.x * 1.001f, 0.0f}), 0.0f);
        EXPECT_EQ(filter.evaluate({0.0f, shape.radius.y * 1.5f}), 0.0f);
    }
}

// Each filter against its published formula, normalised by quadrature.
TEST(Filter, FollowsTheFormulas)
{
    const auto compare = [](const FilterShape& shape, const auto& formula, double tolerance) {
        const Filter filter(shape);
        const double r = shape.radius.x;
        const double norm = 1.0 / integrate(-r, r, formula);
        for (double x = -r * 0.999; x < r; x += r / 37.3)
            EXPECT_NEAR(filter.evaluate_axis(0, float(x)), formula(x) * norm, tolerance) << name(shape) << " at " << x;
    };
    FilterShape shape;
    compare(
        shape, [](double x) { return std::exp(-2 * x * x) - std::exp(-2 * 1.5 * 1.5); }, 1e-4);
    shape.kind = FilterShape::Kind::box;
    shape.radius = Vec2(0.5f);
    compare(
        shape, [](double) { return 1.0; }, 1e-6);
    shape.kind = FilterShape::Kind::triangle;
    shape.radius = Vec2(2.0f);
    compare(
        shape, [](double x) { return 2 - std::fabs(x); }, 1e-6);
    shape.kind = FilterShape::Kind::sinc;
    shape.radius = Vec2(4.0f);
    compare(
        shape,
        [](double x) {
            const double t = M_PI * x + 1e-12;
            return std::sin(t) / t * std::sin(t / 3) / (t / 3);
        },
        2e-4);
    // Mitchell with B = C = 1/3: 16/18 at 0, 1/18 at 1, 0 at 2, integral 1.
    shape.kind = FilterShape::Kind::mitchell;
    shape.radius = Vec2(2.0f);
    EXPECT_NEAR(Filter(shape).evaluate_axis(0, 0.0f), 16.0 / 18.0, 1e-4);
    EXPECT_NEAR(Filter(shape).evaluate_axis(0, 1.0f), 1.0 / 18.0, 1e-4);
    EXPECT_LT(Filter(shape).evaluate_axis(0, 1.5f), 0.0f);
}

// Chi-squared test of the offsets against |value| at 1 % significance, and the weights against value / density.
TEST(Filter, SamplesInProportionToTheMagnitude)
{
    constexpr int bins = 16, samples = 60000;
    for (const FilterShape& shape : shapes()) {
        const Filter filter(shape);
        std::vector<double> expected(bins * bins);
        double absolute[2];
        std::vector<double> share[2];
        for (int axis = 0; axis < 2; ++axis) {
            const double r = shape.radius[axis];
            for (int b = 0; b < bins; ++b)
                share[axis].push_back(integrate(-r + 2 * r * b / bins, -r + 2 * r * (b + 1) / bins, [&](double x) {
                    return std::fabs(filter.evaluate_axis(axis, float(x)));
                }));
            absolute[axis] = 0.0;
            for (const double s : share[axis]) absolute[axis] += s;
        }
        std::vector<int> found(bins * bins);
        double weight_sum = 0.0;
        for (int i = 0; i < samples; ++i) {
            const uint64_t bits = hash_words(1, i);  // independent numbers: the test wants no stratification
            const Filter::Sample sample = filter.sample({to_unit_float(bits), to_unit_float(mix64(bits))});
            ASSERT_LE(std::fabs(sample.offset.x), shape.radius.x);
            ASSERT_LE(std::fabs(sample.offset.y), shape.radius.y);
            const float value = filter.evaluate(sample.offset);
            if (std::fabs(value) > 1e-4f) {
                ASSERT_NEAR(sample.weight, std::copysign(absolute[0] * absolute[1], value), 2e-4) << name(shape);
            }
            weight_sum += sample.weight;
            const auto bin = [&](float x, float r) { return std::min(int((x + r) / (2 * r) * bins), bins - 1); };
            ++found[bin(sample.offset.y, shape.radius.y) * bins + bin(sample.offset.x, shape.radius.x)];
        }
        double chi_squared = 0.0, pooled_expected = 0.0, pooled_found = 0.0;
        int freedom = -1;
        const auto close_cell = [&] {
            if (pooled_expected <= 0.0) return;
            chi_squared += sqr(pooled_found - pooled_expected) / pooled_expected;
            pooled_expected = pooled_found = 0.0;
            ++freedom;
        };
        for (int y = 0; y < bins; ++y)
            for (int x = 0; x < bins; ++x) {
                pooled_expected += samples * share[0][x] * share[1][y] / (absolute[0] * absolute[1]);
                pooled_found += found[y * bins + x];
                if (pooled_expected >= 10.0) close_cell();
            }
        close_cell();
        // Wilson and Hilferty's approximation of the 99 % quantile.
        const double k = freedom,
                     quantile = k * std::pow(1.0 - 2.0 / (9.0 * k) + 2.3263 * std::sqrt(2.0 / (9.0 * k)), 3);
        EXPECT_LT(chi_squared, quantile) << name(shape);
        // The mean weight is the filter's integral.
        EXPECT_NEAR(weight_sum / samples, 1.0,
                    4.0 * std::sqrt(std::max(0.0, sqr(absolute[0] * absolute[1]) - 1.0) + 1e-8) / std::sqrt(samples))
            << name(shape);
    }
}

TEST(Filter, EndsOfTheUnitIntervalStayInside)
{
    for (const FilterShape& shape : shapes()) {
        const Filter filter(shape);
        for (const float u : {0.0f, 0x1p-24f, 0.5f - 0x1p-25f, 0.5f, 0.5f + 0x1p-24f, one_minus_epsilon}) {
            const Filter::Sample sample = filter.sample({u, u});
            EXPECT_TRUE(std::isfinite(sample.offset.x) && std::isfinite(sample.weight)) << name(shape) << ' ' << u;
            EXPECT_LE(std::fabs(sample.offset.x), shape.radius.x);
        }
    }
}

TEST(Filter, RefusesImpossibleShapes)
{
    FilterShape shape;
    shape.radius.x = 0.0f;
    EXPECT_THROW(Filter{shape}, UserError);
    shape.radius.x = 17.0f;
    EXPECT_THROW(Filter{shape}, UserError);
    shape.radius.x = NAN;
    EXPECT_THROW(Filter{shape}, UserError);
    shape = {};
    shape.sigma = 0.0f;
    EXPECT_THROW(Filter{shape}, UserError);
    shape = {};
    shape.kind = FilterShape::Kind::sinc;
    shape.tau = -1.0f;
    EXPECT_THROW(Filter{shape}, UserError);
}

}  // namespace
}  // namespace dapple
