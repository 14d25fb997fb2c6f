#include "dapple/film/sensor.h"

#include "dapple/base/error.h"
#include "dapple/spectrum/color_space.h"
#include "dapple/spectrum/spectrum_value.h"
#include "dapple/spectrum/standard_tables.h"

#include <gtest/gtest.h>

#include <cmath>

namespace dapple {
namespace {

// The mean of to_rgb over wavelength sets, for a light tabulated on the grid, scaled to Y = 1; and the standard error
// of the mean, were the sets independent (they are stratified, so the true error is far smaller).
Vec3 mean_rgb(const Sensor& sensor, const std::vector<float>& table, const std::vector<float>* reflectance = nullptr)
{
    const float scale = 1.0f / xyz_of_table(table).y;
    Imath::V3d sum(0.0);
    const int sets = 20000;
    for (int i = 0; i < sets; ++i) {
        const Wavelengths wavelengths = Wavelengths::sample_visible((i + 0.5f) / sets);
        Spectrum radiance;
        for (int lane = 0; lane < Spectrum::lanes; ++lane) {
            const int index = static_cast<int>(std::lround(wavelengths.lambda[lane] - lambda_min));
            radiance[lane] = scale * table.at(index) * (reflectance ? reflectance->at(index) : 1.0f);
        }
        sum += Imath::V3d(sensor.to_rgb(radiance, wavelengths));
    }
    return Vec3(sum / double(sets));
}

void expect_near(const Vec3& a, const Vec3& b, float tolerance)
{
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << "channel " << c;
}

TEST(Sensor, WhiteOfUnitLuminanceIsOne)
{
    for (const std::string_view name : color_space_names()) {
        const Sensor sensor = make_sensor("cie1931", std::string(name), 0.0f, 1.0f);
        SCOPED_TRACE(std::string(name));
        expect_near(mean_rgb(sensor, color_space(name).illuminant), Vec3(1.0f), 3e-3f);
    }
}

// A constant spectrum has the chromaticity (1/3, 1/3); in linear sRGB that is (1.2048, 0.9483, 0.9087) at Y = 1.
TEST(Sensor, ConstantLightIsEqualEnergyWhite)
{
    const std::vector<float> constant(spectrum_table_size, 1.0f);
    expect_near(mean_rgb(make_sensor("cie1931", "srgb", 0.0f, 1.0f), constant), Vec3(1.2048f, 0.9483f, 0.9087f), 4e-3f);
    // The imaging ratio is a factor.
    expect_near(mean_rgb(make_sensor("cie1931", "srgb", 0.0f, 2.5f), constant), Vec3(1.2048f, 0.9483f, 0.9087f) * 2.5f,
                1e-2f);
}

// Balanced for the light it sees, cie1931 shows that light as white of the same luminance.
TEST(Sensor, WhiteBalanceTakesDaylightToWhite)
{
    for (const float kelvin : {4500.0f, 5000.0f, 6500.0f, 9000.0f})
        expect_near(mean_rgb(make_sensor("cie1931", "srgb", kelvin, 1.0f), daylight_table(kelvin)), Vec3(1.0f), 4e-3f);
    const Vec3 unbalanced = mean_rgb(make_sensor("cie1931", "srgb", 0.0f, 1.0f), daylight_table(4500.0f));
    EXPECT_GT(unbalanced.x, 1.1f);
    EXPECT_LT(unbalanced.z, 0.8f);
}

// A camera's fitted matrix reproduces the patches' colours: white and greys to 2 %, all patches to a few percent.
TEST(Sensor, CamerasReproduceTheColorChecker)
{
    for (const char* name : {"canon_eos_5d_mkiv", "nikon_d850", "sony_ilce_9"}) {
        const Sensor camera = make_sensor(name, "srgb", 6500.0f, 1.0f);
        const Sensor eye = make_sensor("cie1931", "srgb", 0.0f, 1.0f);
        const std::vector<float> light = daylight_table(6500.0f);
        for (size_t i = 0; i < swatch_reflectances().size(); ++i) {
            const Vec3 a = mean_rgb(camera, light, &swatch_reflectances()[i]);
            const Vec3 b = mean_rgb(eye, light, &swatch_reflectances()[i]);
            SCOPED_TRACE(std::string(name) + " patch " + std::to_string(i));
            expect_near(a, b, i >= 18 ? 0.02f : 0.06f);
        }
    }
}

TEST(Sensor, RgbModelPassesThreeLanes)
{
    const Sensor sensor = make_sensor("cie1931", "srgb", 0.0f, 2.0f);
    const Vec3 rgb = sensor.to_rgb(Spectrum(1.0f, 2.0f, 3.0f, 99.0f), Wavelengths::rgb());
    EXPECT_EQ(rgb, Vec3(2.0f, 4.0f, 6.0f));
}

TEST(Sensor, DeadLanesAndEndsOfTheRange)
{
    const Sensor sensor = make_sensor("cie1931", "srgb", 0.0f, 1.0f);
    Wavelengths wavelengths;
    wavelengths.lambda[0] = lambda_min;
    wavelengths.lambda[1] = lambda_max;
    wavelengths.pdf[2] = 0.0f;
    EXPECT_TRUE(is_finite(sensor.to_rgb(Spectrum(1.0f), wavelengths)));
}

TEST(Sensor, UnknownNamesAreUserErrors)
{
    try {
        make_sensor("canon_eos_5d_mk4", "srgb", 0.0f, 1.0f);
        FAIL();
    } catch (const UserError& error) {
        EXPECT_NE(std::string(error.what()).find("did you mean 'canon_eos_5d_mk"), std::string::npos) << error.what();
    }
    EXPECT_THROW(make_sensor("cie1931", "no-such-space", 0.0f, 1.0f), UserError);
    EXPECT_THROW(make_sensor("cie1931", "srgb", -1.0f, 1.0f), UserError);
    EXPECT_THROW(make_sensor("cie1931", "srgb", 0.0f, 0.0f), UserError);
}

}  // namespace
}  // namespace dapple
