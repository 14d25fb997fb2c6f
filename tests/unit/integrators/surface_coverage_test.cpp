#include "dapple/integrators/surface_coverage.h"

#include <gtest/gtest.h>

#include "dapple/sampling/random_stream.h"
#include "dapple/world/compile.h"

namespace dapple {
namespace {

// The square [-1, 1]^2 at z = 0, and a thin wall of height 1 on it along y = 0.
std::unique_ptr<World> square_with_wall()
{
    scene::Description description;
    description.materials.resize(1);
    description.materials[0].kind = scene::DiffuseMaterial{scene::SpectrumInput(0.5f)};
    auto data = std::make_shared<scene::MeshData>();
    data->positions = {Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(1, 1, 0), Vec3(-1, 1, 0),
                       Vec3(-1, 0, 0),  Vec3(1, 0, 0),  Vec3(1, 0, 1), Vec3(-1, 0, 1)};
    data->triangles = {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
    scene::Shape shape;
    shape.geometry = scene::Mesh{data};
    shape.material = scene::MaterialIndex(0u);
    shape.name = "square";
    description.shapes.push_back(shape);
    return compile(std::move(description));
}

SurfaceRegion at(float x, float y) { return {Vec3(x, y, 0.0f), Vec3(0, 0, 1)}; }

TEST(SurfaceCoverage, IsTheShareOfTheDiscOnTheSurface)
{
    const auto world = square_with_wall();
    for (KernelKind kernel : {KernelKind::constant, KernelKind::epanechnikov}) {
        const SurfaceCoverage whole = surface_coverage(*world, at(0.3f, 0.5f), 0.2f, kernel);
        EXPECT_EQ(whole.share, 1.0f);
        EXPECT_FALSE(whole.something_hidden);
        double edge = 0.0, corner = 0.0;
        constexpr int places = 32;
        for (int i = 0; i < places; ++i) {
            const float along = 0.3f + 0.01f * static_cast<float>(i);
            edge += surface_coverage(*world, at(0.9999f, along), 0.2f, kernel).share / places;
            corner += surface_coverage(*world, at(0.9999f, 0.9999f - 1e-6f * along), 0.2f, kernel).share / places;
        }
        EXPECT_NEAR(edge, 0.5, 0.01);
        EXPECT_NEAR(corner, 0.25, 0.02);
    }
}

TEST(SurfaceCoverage, EndsAtAWall)
{
    const auto world = square_with_wall();
    const SurfaceCoverage foot = surface_coverage(*world, at(0.1f, 1e-4f), 0.2f, KernelKind::constant);
    EXPECT_TRUE(foot.something_hidden);
    EXPECT_NEAR(foot.share, 0.5f, 0.05f);
}

// The square lit evenly on the side y > 0 of the wall, dark on the other; k nearest and fixed radius. Everywhere on the
// lit side, next to edges, corners and the wall, the mean is the irradiance; on the dark side it is 0.
TEST(CoveredEstimates, AreExactUpToTheEdgesAndDarkBehindAWall)
{
    const auto world = square_with_wall();
    constexpr int photons = 40000;
    std::vector<std::vector<Photon>> batches(1);
    for (int i = 0; i < photons; ++i) {
        RandomStream random(7, 1, static_cast<uint32_t>(i));
        const Vec2 u = random.next_2d();
        Photon photon;
        photon.position = Vec3(2.0f * u.x - 1.0f, u.y, 0.0f);
        photon.flux = Spectrum(1.0f);
        batches[0].push_back(photon);
    }
    const PhotonMap map(std::move(batches), photons);
    constexpr double irradiance = 0.5;  // 1 W on 2 m^2
    std::vector<WeightedPhoton> found;
    NearestPoints nearest(50);
    for (const Bandwidth& bandwidth :
         {Bandwidth{50, infinity, KernelKind::epanechnikov}, Bandwidth{0, 0.04f, KernelKind::constant}}) {
        const auto estimate = [&](float x, float y) {
            find_covered_photons(*world, map, at(x, y), bandwidth, nearest, found);
            double sum = 0.0;
            for (const WeightedPhoton& photon : found) sum += photon.second;
            return sum;
        };
        const auto mean = [&](float x, float y, float dx, float dy) {
            double sum = 0.0;
            constexpr int places = 400;
            for (int i = 0; i < places; ++i)
                sum += estimate(x + dx * static_cast<float>(i) / places, y + dy * static_cast<float>(i) / places);
            return sum / places;
        };
        // A strip at the border holds some thousand photons: a standard error of 2 to 3 %. Uncorrected: half.
        EXPECT_NEAR(mean(-0.9f, 0.9999f, 1.8f, 0.0f), irradiance, 0.08 * irradiance);
        EXPECT_NEAR(mean(-0.9f, 1e-4f, 1.8f, 0.0f), irradiance, 0.08 * irradiance);
        EXPECT_NEAR(mean(-0.9f, 0.5f, 1.8f, 0.0f), irradiance, 0.08 * irradiance);
        EXPECT_EQ(mean(-0.9f, -1e-4f, 1.8f, 0.0f), 0.0);
    }
}

}  // namespace
}  // namespace dapple
