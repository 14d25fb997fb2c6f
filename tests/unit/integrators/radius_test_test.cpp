#include "dapple/integrators/radius_test.h"

#include <gtest/gtest.h>

#include "dapple/math/hash.h"
#include "dapple/sampling/random_stream.h"
#include "dapple/sampling/warps.h"

namespace dapple {
namespace {

// Photons on the square [0, 1]^2, of equal or very unequal flux; none where x > dark_from.
PhotonMap even_photons(int count, bool equal, float dark_from, uint64_t seed)
{
    std::vector<std::vector<Photon>> batches(1);
    for (int i = 0; i < count; ++i) {
        RandomStream random(seed, 1, static_cast<uint32_t>(i));
        Photon photon;
        const float x = to_unit_float(mix64(seed * 1000003u + static_cast<uint64_t>(i)));
        const float y = to_unit_float(mix64(seed * 7000003u + static_cast<uint64_t>(i) + 1234567u));
        photon.position = Vec3(x, y, 0.0f);
        photon.flux = Spectrum(equal ? 1.0f : std::exp(3.0f * random.next()));
        if (x < dark_from) batches[0].push_back(photon);
    }
    return {std::move(batches), static_cast<uint64_t>(count)};
}

SurfaceRegion at(float x, float y) { return {Vec3(x, y, 0.0f), Vec3(0, 0, 1)}; }

// The share of discs whose radius is lowered, of `expected` photons each.
double lowered_share(int expected, bool equal)
{
    constexpr float radius = 0.02f;
    constexpr int discs = 20000;
    const int count = static_cast<int>(expected / (pi * radius * radius));
    double lowered = 0.0;
    constexpr int worlds = 8;
    for (int world = 0; world < worlds; ++world) {
        std::vector<PhotonMap> maps(2);
        maps[1] = even_photons(count, equal, 1.0f, 10 + static_cast<uint64_t>(world));
        for (int i = 0; i < discs / worlds; ++i) {
            RandomStream random(99, static_cast<uint64_t>(world), static_cast<uint32_t>(i));
            const Vec2 u = random.next_2d();
            lowered += tested_radius(maps, 0, at(0.05f + 0.9f * u.x, 0.05f + 0.9f * u.y), radius) < radius;
        }
    }
    return lowered / discs;
}

// The statistic's distribution: mean 5, variance 10, exceeded as often as the significance says.
TEST(UniformityTest, HasTheDistributionOfChiSquared)
{
    constexpr int runs = 20000, photons = 60;
    double sum = 0.0, squares = 0.0, rejected = 0.0;
    for (int run = 0; run < runs; ++run) {
        UniformityTest test;
        RandomStream random(5, 1, static_cast<uint32_t>(run));
        random.skip(1000);  // plain hashes: this sequence would be too even
        for (int i = 0; i < photons; ++i) {
            const Vec2 p = sample_disk_concentric(random.next_2d());
            test.add(p.x, p.y, 0.5f + random.next());
        }
        sum += double(test.statistic());
        squares += sqr(double(test.statistic()));
        rejected += test.rejects();
    }
    const double mean = sum / runs, variance = squares / runs - mean * mean;
    EXPECT_NEAR(mean, 5.0, 4.0 * std::sqrt(10.0 / runs));
    EXPECT_NEAR(variance, 10.0, 1.0);
    EXPECT_NEAR(rejected / runs, 0.01, 0.003);
}

TEST(RadiusTest, RarelyLowersTheRadiusInEvenLight)
{
    for (const int expected : {3, 15, 60})
        for (const bool equal : {true, false}) {
            const double rate = lowered_share(expected, equal);
            EXPECT_LT(rate, 0.017) << expected << " photons";
            EXPECT_GT(rate, expected == 60 ? 0.005 : 0.0);
        }
}

TEST(RadiusTest, LowersTheRadiusAtAnEdgeUntilItIsOutside)
{
    constexpr float radius = 0.05f;
    std::vector<PhotonMap> maps(3);
    maps[0] = even_photons(8000, true, 0.5f, 3);
    maps[2] = even_photons(8000, true, 0.5f, 4);
    double at_edge = 0.0, near = 0.0, far = 0.0;
    constexpr int places = 500;
    for (int i = 0; i < places; ++i) {
        const float y = 0.1f + 0.8f * static_cast<float>(i) / places;
        at_edge += tested_radius(maps, 1, at(0.5f, y), radius) / (radius * places);
        near += tested_radius(maps, 1, at(0.475f, y), radius) / (radius * places);
        far += tested_radius(maps, 1, at(0.44f, y), radius) / (radius * places);
    }
    EXPECT_LT(at_edge, 0.5);
    EXPECT_LT(near, 0.8);
    EXPECT_GT(near, 0.4);
    EXPECT_GT(far, 0.98);
}

// The photons of the estimate itself have no say.
TEST(RadiusTest, DoesNotLookAtItsOwnPhotons)
{
    std::vector<PhotonMap> maps(2);
    maps[0] = even_photons(50000, true, 0.5f, 3);
    EXPECT_EQ(tested_radius(maps, 0, at(0.5f, 0.5f), 0.05f), 0.05f);
    EXPECT_LT(tested_radius(maps, 1, at(0.5f, 0.5f), 0.05f), 0.05f);
}

}  // namespace
}  // namespace dapple
