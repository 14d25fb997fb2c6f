// RGB -> reflectance -> RGB, exactly and by table, measured with the 1 nm tables of observer and white.
#include "dapple/spectrum/sigmoid.h"

#include "dapple/math/hash.h"
#include "dapple/spectrum/spectrum_value.h"
#include "dapple/spectrum/standard_tables.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

Vec3 rgb_of(const ColorSpace& space, const SigmoidCoefficients& sigmoid)
{
    std::vector<float> lit(spectrum_table_size);
    for (int i = 0; i < spectrum_table_size; ++i)
        lit[i] = sigmoid.at(lambda_min + static_cast<float>(i)) * space.illuminant[i];
    return multiply(space.rgb_from_xyz, xyz_of_table(lit) * (1.0f / cie_y_integral));
}

float largest_difference(const Vec3& a, const Vec3& b) { return max_component(abs(a - b)); }

Vec3 color(uint64_t seed, uint64_t i)
{
    return {to_unit_float(hash_words(seed, i, 0)), to_unit_float(hash_words(seed, i, 1)),
            to_unit_float(hash_words(seed, i, 2))};
}

TEST(Sigmoid, ExactFitsReturnTheColorInsideTheGamut)
{
    for (const std::string_view name : {"srgb", "dci-p3"}) {
        const ColorSpace& space = color_space(name);
        float worst = 0.0f;
        for (int i = 0; i < 400; ++i) {
            const Vec3 rgb = color(1, i);
            worst = std::max(worst, largest_difference(rgb_of(space, rgb_to_sigmoid(space, rgb)), rgb));
        }
        EXPECT_LT(worst, name == "srgb" ? 2e-5f : 5e-3f) << name;  // P3's edge is not all within reach
    }
    // The wide spaces hold colours that no reflectance has; towards grey they hold only real ones.
    for (const std::string_view name : {"rec2020", "aces2065-1"}) {
        const ColorSpace& space = color_space(name);
        for (int i = 0; i < 200; ++i) {
            const Vec3 rgb = Vec3(0.3f) + color(2, i) * 0.3f;
            ASSERT_LT(largest_difference(rgb_of(space, rgb_to_sigmoid(space, rgb)), rgb), 2e-5f) << name;
        }
    }
}

TEST(Sigmoid, DarkColorsKeepTheirHue)
{
    for (int i = 0; i < 100; ++i) {
        const Vec3 rgb = (Vec3(0.1f) + color(3, i) * 0.9f) * 1e-3f;
        ASSERT_LT(largest_difference(rgb_of(srgb(), rgb_to_sigmoid(srgb(), rgb)), rgb), 2e-7f);
        ASSERT_LT(largest_difference(rgb_of(srgb(), sigmoid_table(srgb()).lookup(rgb)), rgb), 1e-4f);
    }
}

TEST(Sigmoid, GreysAreConstantAndBlackAndWhiteExact)
{
    for (const float grey : {0.0f, 1e-4f, 0.18f, 0.5f, 0.999f, 1.0f})
        for (const auto& sigmoid : {rgb_to_sigmoid(srgb(), Vec3(grey)), sigmoid_table(srgb()).lookup(Vec3(grey))})
            for (const float lambda : {360.0f, 500.0f, 830.0f}) EXPECT_NEAR(sigmoid.at(lambda), grey, 3e-7f);
    EXPECT_EQ(rgb_to_sigmoid(srgb(), Vec3(0.0f)).at(500.0f), 0.0f);
    EXPECT_EQ(rgb_to_sigmoid(srgb(), Vec3(1.0f)).at(500.0f), 1.0f);
    EXPECT_EQ(rgb_to_sigmoid(srgb(), Vec3(-3.0f, -1.0f, -2.0f)).at(500.0f), 0.0f);
    EXPECT_EQ(rgb_to_sigmoid(srgb(), Vec3(7.0f)).at(500.0f), 1.0f);
}

TEST(Sigmoid, CornersOfSrgbAreMet)
{
    // The corners of sRGB: full primaries and secondaries.
    float worst = 0.0f;
    for (int corner = 1; corner < 7; ++corner) {
        const Vec3 rgb(corner & 1 ? 1.0f : 0.0f, corner & 2 ? 1.0f : 0.0f, corner & 4 ? 1.0f : 0.0f);
        const SigmoidCoefficients sigmoid = rgb_to_sigmoid(srgb(), rgb);
        for (int lambda = 360; lambda <= 830; ++lambda) {
            const float r = sigmoid.at(static_cast<float>(lambda));
            ASSERT_TRUE(r >= 0.0f && r <= 1.0f);
        }
        const float error = largest_difference(rgb_of(srgb(), sigmoid), rgb);
        worst = std::max(worst, error);
    }
    EXPECT_LT(worst, 2e-5f);
}

TEST(Sigmoid, TableAgreesWithExactFits)
{
    const SigmoidTable& table = sigmoid_table(srgb());
    float worst_inside = 0.0f, worst = 0.0f;
    double mean = 0.0;
    const int n = 4000;
    for (int i = 0; i < n; ++i) {
        const Vec3 rgb = color(4, i);
        const float error = largest_difference(rgb_of(srgb(), table.lookup(rgb)), rgb);
        mean += error / n;
        worst = std::max(worst, error);
        const float low = std::min({rgb.x, rgb.y, rgb.z}), high = max_component(rgb);
        if (low > 0.1f * high && high < 0.95f) worst_inside = std::max(worst_inside, error);
    }
    EXPECT_LT(mean, 6e-4);
    EXPECT_LT(worst_inside, 2.5e-3f);
    EXPECT_LT(worst, 0.02f);
}

TEST(Sigmoid, TableIsContinuousWhereTheLargestChannelChanges)
{
    const SigmoidTable& table = sigmoid_table(srgb());
    for (int i = 0; i < 200; ++i) {
        const Vec3 c = color(5, i) * 0.9f + Vec3(0.02f);
        const float high = std::max(c.x, c.y);
        const Vec3 a = rgb_of(srgb(), table.lookup({high + 1e-5f, high, std::min(c.z, high)}));
        const Vec3 b = rgb_of(srgb(), table.lookup({high, high + 1e-5f, std::min(c.z, high)}));
        EXPECT_LT(largest_difference(a, b), 2e-3f);
    }
}

}  // namespace
}  // namespace dapple
