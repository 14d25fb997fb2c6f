// What media are at a point: interpolation, emission, presets.

#include "dapple/media/grid.h"
#include "dapple/spectrum/photometry.h"
#include "media_support.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

using namespace testing_support;

TEST(GridLookup, IsTrilinearBetweenCellCentresAndZeroOutside)
{
    Grid grid{4, 3, 2, 1, {}};
    const auto linear = [](float x, float y, float z) { return 1.0f + 2.0f * x + 3.0f * y + 5.0f * z; };
    for (int z = 0; z < 2; ++z)
        for (int y = 0; y < 3; ++y)
            for (int x = 0; x < 4; ++x) grid.values.push_back(linear((x + 0.5f) / 4, (y + 0.5f) / 3, (z + 0.5f) / 2));
    for (const Vec3& p : {Vec3(0.125f, 0.5f, 0.25f), Vec3(0.3f, 0.4f, 0.6f), Vec3(0.87f, 0.2f, 0.75f)})
        EXPECT_NEAR(lookup_grid<1>(grid, p)[0], linear(p.x, p.y, p.z), 1e-5f);
    // Half of the outermost sample on the box's face, nothing half a cell beyond.
    EXPECT_NEAR(lookup_grid<1>(grid, Vec3(0, 0.5f, 0.25f))[0], 0.5f * linear(0.125f, 0.5f, 0.25f), 1e-5f);
    EXPECT_EQ(lookup_grid<1>(grid, Vec3(-0.125f, 0.5f, 0.25f))[0], 0.0f);
    EXPECT_EQ(lookup_grid<1>(grid, Vec3(1.2f, 0.5f, 0.25f))[0], 0.0f);
    EXPECT_EQ(lookup_grid<1>(grid, Vec3(0.5f, 1e30f, 0.25f))[0], 0.0f);
    EXPECT_EQ(lookup_grid<1>(grid, Vec3(0.5f, 0.5f, std::nanf("")))[0], 0.0f);
}

TEST(Medium, DensityScalesAbsorptionScatteringAndEmission)
{
    GridScene scene;
    scene.medium.emission = make_constant(4.0f);
    const Wavelengths wavelengths = Wavelengths::sample_visible(0.7f);
    const Vec3 unit(4.5f / 12, 2.5f / 7, 3.5f / 40);  // a cell's centre
    const float density = scene.media.grids[0].values[(3 * 7 + 2) * 12 + 4];
    const Vec3 p = scene.world_from_medium.point(Vec3(-1, -0.5f, 0) + unit * Vec3(2, 1.5f, 3));
    const MediumPoint point = evaluate(scene.media, scene.pool, scene.medium, p, wavelengths);
    const Spectrum sigma_a = scene.pool.evaluate(scene.medium.sigma_a, wavelengths);
    for (int i = 0; i < Spectrum::lanes; ++i) {
        EXPECT_NEAR(point.sigma_s[i], 0.4f * density, 1e-5f);
        EXPECT_NEAR(point.sigma_a[i], sigma_a[i] * density, 1e-5f);
        EXPECT_NEAR(point.emission[i], 4.0f * sigma_a[i] * density, 1e-4f);
    }
    scene.media.grids.push_back(Grid{1, 1, 1, 1, {0.25f}});
    scene.medium.emission_scale = 1;
    const Spectrum dimmed = evaluate(scene.media, scene.pool, scene.medium,
                                     scene.world_from_medium.point(Vec3(0, 0.25f, 1.5f)), wavelengths)
                                .emission;
    const Spectrum there = evaluate(scene.media, scene.pool, scene.medium,
                                    scene.world_from_medium.point(Vec3(0, 0.25f, 1.5f)), wavelengths)
                               .sigma_a;
    EXPECT_NEAR(dimmed[0], there[0] * 4.0f * 0.25f, 1e-4f);
}

TEST(Medium, TemperatureGlowsAsABlackBodyOfPeakOne)
{
    GridScene scene;
    scene.media.grids.push_back(Grid{1, 1, 1, 1, {2.5f}});
    scene.medium.temperature = 1;
    scene.medium.temperature_scale = 1000.0f;
    scene.medium.temperature_offset = 0.5f;  // (2.5 - 0.5) * 1000 = 2000 K
    scene.medium.emission_grid_scale = 3.0f;
    build_majorants(scene.media, scene.medium);
    const Vec3 p = scene.world_from_medium.point(Vec3(0, 0.25f, 1.5f));
    const Wavelengths wavelengths = Wavelengths::sample_visible(0.1f);
    const MediumPoint point = evaluate(scene.media, scene.pool, scene.medium, p, wavelengths);
    ASSERT_GT(point.sigma_a[0], 0.0f);
    for (int i = 0; i < Spectrum::lanes; ++i) {
        const float expected = blackbody(wavelengths.lambda[i], 2000.0f) / blackbody(1448.886f, 2000.0f);
        EXPECT_NEAR(point.emission[i] / point.sigma_a[i], 3.0f * expected, 3e-3f * expected) << i;
    }
    const MediumPoint rgb = evaluate(scene.media, scene.pool, scene.medium, p, Wavelengths::rgb());
    const Vec3 expected = make_blackbody(scene.pool, 2000.0f).rgb;
    EXPECT_NEAR(rgb.emission[0] / rgb.sigma_a[0], 3.0f * expected.x, 0.01f * expected.x);
    EXPECT_NEAR(rgb.emission[1] / rgb.sigma_a[1], 3.0f * expected.y, 0.01f * expected.y);

    scene.medium.temperature_scale = 40.0f;  // 80 K
    EXPECT_TRUE(evaluate(scene.media, scene.pool, scene.medium, p, wavelengths).emission.is_black());
}

TEST(Medium, RgbGridsInterpolateColours)
{
    const GridScene scene(Medium::Kind::rgb_grid);
    const Vec3 p =
        scene.world_from_medium.point(Vec3(-1, -0.5f, 0) + Vec3(4.5f / 12, 2.5f / 7, 3.5f / 40) * Vec3(2, 1.5f, 3));
    const MediumPoint point = evaluate(scene.media, scene.pool, scene.medium, p, Wavelengths::rgb());
    const size_t at = 3 * ((3 * 7 + 2) * 12 + 4);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(point.sigma_a[c], 0.7f * scene.media.grids[0].values[at + c], 1e-5f);
        EXPECT_NEAR(point.sigma_s[c], 0.7f * scene.media.grids[1].values[at + c], 1e-5f);
    }
}

}  // namespace
}  // namespace dapple
