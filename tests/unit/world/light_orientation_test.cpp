// Which way the images of lights face in the world.
#include "dapple/image/image_file.h"
#include "dapple/scene/description.h"
#include "dapple/world/compile.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace dapple {
namespace {

// The irradiance at `point` by the only light of the scene, at wavelengths that do not matter here.
float irradiance(const World& world, const Vec3& point)
{
    DirectSample sample;
    const Wavelengths wavelengths = Wavelengths::sample_visible(0.5f);
    if (!sample_direct(world.lights, world.spectra, LightId(0), point, 0.0f, Vec2(0.5f, 0.5f), wavelengths, sample))
        return 0.0f;
    return sample.radiance[0];
}

// pbrt-v4: the centre of the equal-area image, its pole, shines along the light's +y and the corners along -y.
TEST(LightOrientation, PoleOfGoniometricImagePointsAlongY)
{
    Image image(8, 8, 3);
    for (int y = 3; y < 5; ++y)
        for (int x = 3; x < 5; ++x)
            for (int c = 0; c < 3; ++c) image.at(x, y, c) = 1.0f;
    const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "dapple-goniometric-pole.pfm";
    write_image(file.string(), image);

    scene::Description description;
    scene::GoniometricLight goniometric;
    goniometric.file = file;
    scene::Light light;
    light.kind = goniometric;
    description.lights.push_back(light);
    const std::unique_ptr<World> world = compile(description);
    std::filesystem::remove(file);

    EXPECT_GT(irradiance(*world, Vec3(0.01f, 1, 0.02f)), 0.0f);
    EXPECT_EQ(irradiance(*world, Vec3(0.01f, -1, 0.02f)), 0.0f);
    EXPECT_EQ(irradiance(*world, Vec3(0.01f, 0.02f, 1)), 0.0f);
    EXPECT_EQ(irradiance(*world, Vec3(1, 0.01f, 0.02f)), 0.0f);
}

}  // namespace
}  // namespace dapple
