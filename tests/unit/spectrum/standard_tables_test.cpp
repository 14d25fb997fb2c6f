// Standard tables, colour spaces and photometry against the numbers their standards print.
#include "dapple/spectrum/standard_tables.h"

#include "dapple/base/error.h"
#include "dapple/spectrum/color_space.h"
#include "dapple/spectrum/photometry.h"
#include "dapple/spectrum/spectrum_value.h"

#include <gtest/gtest.h>

#include <numeric>

namespace dapple {
namespace {

Vec2 chromaticity(const std::vector<float>& table)
{
    const Vec3 xyz = xyz_of_table(table);
    const float sum = xyz.x + xyz.y + xyz.z;
    return {xyz.x / sum, xyz.y / sum};
}

TEST(StandardTables, MatchingFunctionsHaveTheirIntegrals)
{
    const auto& matching = cie_matching_functions();
    double sums[3];
    for (size_t i = 0; i < 3; ++i) {
        ASSERT_EQ(matching[i].size(), static_cast<size_t>(spectrum_table_size));
        sums[i] = std::accumulate(matching[i].begin(), matching[i].end(), 0.0);
    }
    EXPECT_NEAR(sums[1], cie_y_integral, 5e-5);
    EXPECT_NEAR(sums[0], 106.8655, 1e-2);  // equal energy is white at x = y = 1/3
    EXPECT_NEAR(sums[2], 106.8922, 4e-2);
    EXPECT_FLOAT_EQ(matching[1][555 - 360], 1.0f);
}

TEST(StandardTables, IlluminantsHaveTheirChromaticities)
{
    // CIE 15:2018, tables T.3 and T.6.2; D60 of the ACES white: SMPTE ST 2065-1.
    const struct {
        const char* name;
        float x, y;
    } expected[] = {{"stdillum-A", 0.44758f, 0.40745f},      {"stdillum-D50", 0.34567f, 0.35851f},
                    {"stdillum-D65", 0.31272f, 0.32903f},    {"illum-acesD60", 0.32168f, 0.33767f},
                    {"stdillum-F2", 0.37208f, 0.37529f},     {"stdillum-F7", 0.31292f, 0.32933f},
                    {"stdillum-F11", 0.38052f, 0.37713f},    {"stdillum-LED-B1", 0.4560f, 0.4078f},
                    {"stdillum-E", 1.0f / 3.0f, 1.0f / 3.0f}};
    for (const auto& illuminant : expected) {
        const std::vector<float>* table = illuminant_table(illuminant.name);
        ASSERT_NE(table, nullptr) << illuminant.name;
        EXPECT_NEAR(chromaticity(*table).x, illuminant.x, 2e-4f) << illuminant.name;
        EXPECT_NEAR(chromaticity(*table).y, illuminant.y, 2e-4f) << illuminant.name;
        EXPECT_NEAR(xyz_of_table(*table).y, cie_y_integral, 1e-3f) << illuminant.name;
    }
    EXPECT_EQ(illuminant_table("stdillum-D64"), nullptr);
}

TEST(StandardTables, DaylightSeriesGivesItsMembers)
{
    const Vec2 d65 = chromaticity(daylight_table(6500.0f));
    EXPECT_NEAR(d65.x, 0.3127f, 2e-4f);
    EXPECT_NEAR(d65.y, 0.3290f, 2e-4f);
    const Vec2 d50 = chromaticity(daylight_table(5000.0f));
    EXPECT_NEAR(d50.x, 0.3457f, 3e-4f);
    EXPECT_NEAR(d50.y, 0.3585f, 3e-4f);
    const Vec2 d75 = chromaticity(daylight_table(7500.0f));
    EXPECT_NEAR(d75.x, 0.2990f, 3e-4f);
    EXPECT_NEAR(d75.y, 0.3149f, 3e-4f);
    const Vec2 warm = chromaticity(daylight_table(2856.0f));  // a black body: illuminant A but for its old constants
    EXPECT_NEAR(warm.x, 0.4476f, 1e-3f);
    EXPECT_NEAR(warm.y, 0.4075f, 1e-3f);
}

TEST(StandardTables, ResamplingInterpolatesAndEnds)
{
    const std::vector<float> lambdas = {400.5f, 500.0f, 600.0f}, values = {1.0f, 3.0f, 2.0f};
    const std::vector<float> zero = resample(lambdas, values, TableEnds::zero);
    EXPECT_EQ(zero[40], 0.0f);
    EXPECT_NEAR(zero[41], 1.0f + 2.0f * 0.5f / 99.5f, 1e-6f);
    EXPECT_EQ(zero[140], 3.0f);
    EXPECT_FLOAT_EQ(zero[190], 2.5f);
    EXPECT_EQ(zero[240], 2.0f);
    EXPECT_EQ(zero[241], 0.0f);
    const std::vector<float> clamped = resample(lambdas, values, TableEnds::clamp);
    EXPECT_EQ(clamped[0], 1.0f);
    EXPECT_EQ(clamped[470], 2.0f);
}

TEST(StandardTables, SensorsAndSwatches)
{
    EXPECT_EQ(sensor_names().size(), 18u);
    EXPECT_EQ(*sensor_curve("cie1931", 1), cie_matching_functions()[1]);
    EXPECT_EQ(sensor_curve("kodak", 0), nullptr);
    for (const std::string_view name : sensor_names())
        for (int channel = 0; channel < 3; ++channel) {
            const std::vector<float>& curve = *sensor_curve(name, channel);
            const auto peak = std::max_element(curve.begin(), curve.end()) - curve.begin() + 360;
            const int low[3] = {570, 500, 430}, high[3] = {630, 570, 490};
            EXPECT_GE(peak, low[channel]) << name;
            EXPECT_LE(peak, high[channel]) << name;
        }
    EXPECT_FLOAT_EQ((*sensor_curve("canon_eos_100d", 1))[160], 1.0f);  // greens are scaled to a peak of 1 at 520 nm
    // Patch 19 is white, 24 black, and the greys between them flat and falling.
    for (int patch = 18; patch < 23; ++patch)
        EXPECT_GT(swatch_reflectances()[patch][190], swatch_reflectances()[patch + 1][190]);
    EXPECT_NEAR(swatch_reflectances()[18][190], 0.9f, 0.03f);
    EXPECT_NEAR(swatch_reflectances()[23][190], 0.031f, 0.005f);
}

TEST(ColorSpace, MatricesOfTheStandards)
{
    // IEC 61966-2-1 prints four digits of sRGB's matrix.
    const float expected[3][3] = {
        {0.4124f, 0.3576f, 0.1805f}, {0.2126f, 0.7152f, 0.0722f}, {0.0193f, 0.1192f, 0.9505f}};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) EXPECT_NEAR(srgb().xyz_from_rgb[i][j], expected[i][j], 4e-4f);
    const ColorSpace& rec2020 = color_space("rec2020");
    const float luma[3] = {0.2627f, 0.6780f, 0.0593f};  // ITU-R BT.2020
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(rec2020.xyz_from_rgb[1][j], luma[j], 2e-4f);
    const ColorSpace& aces = color_space("ACES2065-1");
    const float aces_y[3] = {0.3439664f, 0.7281661f, -0.0721325f};  // SMPTE ST 2065-1
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(aces.xyz_from_rgb[1][j], aces_y[j], 3e-4f);
}

TEST(ColorSpace, WhiteOfEverySpaceIsOne)
{
    for (const std::string_view name : color_space_names()) {
        const ColorSpace& space = color_space(name);
        const Vec3 rgb = multiply(space.rgb_from_xyz, xyz_of_table(space.illuminant) * (1.0f / cie_y_integral));
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(rgb[i], 1.0f, 1e-5f) << name;
        const Vec3 c(0.2f, 0.5f, 0.7f);
        const Vec3 back = multiply(space.rgb_from_xyz, multiply(space.xyz_from_rgb, c));
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(back[i], c[i], 1e-5f) << name;
    }
    EXPECT_EQ(to_srgb(srgb(), Vec3(0.1f, 0.2f, 0.3f)), Vec3(0.1f, 0.2f, 0.3f));
    const Vec3 p3_red = to_srgb(color_space("dci-p3"), Vec3(1, 0, 0));
    EXPECT_NEAR(p3_red.x, 1.2249f, 1e-3f);
    EXPECT_NEAR(p3_red.y, -0.0420f, 1e-3f);
}

TEST(ColorSpace, UnknownNameIsAUserError)
{
    try {
        color_space("rec2002");
        FAIL();
    } catch (const UserError& error) {
        EXPECT_NE(std::string(error.what()).find("rec2020"), std::string::npos);
    }
}

TEST(Photometry, BlackbodyFollowsPlanck)
{
    // Stefan-Boltzmann: the integral over all wavelengths is sigma T^4 / pi.
    const double kelvin = 3000.0, sigma = 5.670374419e-8;
    double sum = 0.0;
    for (int i = 0; i < 400000; ++i) sum += blackbody(100.0f + 0.5f * static_cast<float>(i), 3000.0f) * 0.5;
    EXPECT_NEAR(sum / (sigma * kelvin * kelvin * kelvin * kelvin / 3.14159265358979), 1.0, 2e-3);
    // Wien: the peak is where it says.
    const float peak = blackbody_peak(3000.0f);
    EXPECT_NEAR(peak, 965.924f, 1e-2f);
    EXPECT_GT(blackbody(peak, 3000.0f), blackbody(peak - 5.0f, 3000.0f));
    EXPECT_GT(blackbody(peak, 3000.0f), blackbody(peak + 5.0f, 3000.0f));
    EXPECT_EQ(blackbody(500.0f, 0.0f), 0.0f);
    EXPECT_EQ(blackbody(500.0f, -10.0f), 0.0f);
    EXPECT_GE(blackbody(360.0f, 30.0f), 0.0f);
}

TEST(Photometry, LumensAndBack)
{
    EXPECT_FLOAT_EQ(photometric_from_y(1.0f), 683.0f);
    EXPECT_FLOAT_EQ(y_from_photometric(photometric_from_y(0.37f)), 0.37f);
}

}  // namespace
}  // namespace dapple
