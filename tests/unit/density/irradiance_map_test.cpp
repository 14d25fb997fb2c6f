#include "dapple/density/irradiance_map.h"

#include <gtest/gtest.h>

#include "dapple/math/hash.h"
#include "dapple/sampling/random_stream.h"

#include <cstdio>

namespace dapple {
namespace {

// Photons on the unit square at z = 0, flux 1 W in all lanes, from above; `even`: those of a point light, spread by
// low-discrepancy numbers.
PhotonMap lit_square(uint32_t photons, uint64_t trial = 0, bool even = false)
{
    std::vector<std::vector<Photon>> batches(1);
    for (uint32_t i = 0; i < photons; ++i) {
        RandomStream random = even ? RandomStream(8, trial, i) : RandomStream(8, hash_words(trial, uint64_t(i)), 0);
        const Vec2 u = random.next_2d();
        Photon photon;
        photon.position = Vec3(u.x, u.y, 0.0f);
        photon.flux = Spectrum(1.0f);
        batches[0].push_back(photon);
    }
    return PhotonMap(std::move(batches), photons);
}

// Records at a quarter as many places, which know nothing of the photons.
IrradianceMap irradiance_map(const PhotonMap& photons, const Bandwidth& bandwidth, uint64_t trial = 0)
{
    std::vector<SurfacePlace> places;
    for (uint32_t i = 0; i < photons.size() / 4; ++i) {
        RandomStream random(9, hash_words(trial, uint64_t(i)), 0);
        const Vec2 u = random.next_2d();
        places.push_back({Vec3(u.x, u.y, 0.0f), Vec3(0, 0, 1)});
    }
    return IrradianceMap(photons, places, bandwidth.nearest, find_photons_within(bandwidth));
}

// What readers get, who search where no record reaches, has the mean of searches alone: records know nothing of how
// many photons lie near their reader. At every fourth photon instead they would be 0.8 % too bright.
TEST(IrradianceMap, HasTheMeanOfSearches)
{
    constexpr int maps = 24;
    constexpr uint32_t photon_count = 20000, readers = 1000;
    const Bandwidth bandwidth{50, infinity, KernelKind::epanechnikov};
    NearestPoints nearest(50);
    for (const bool even : {false, true}) {
        double sum = 0.0, squares = 0.0, all = 0.0;
        int found = 0;
        for (uint64_t trial = 0; trial < maps; ++trial) {
            const PhotonMap photons = lit_square(photon_count, trial, even);
            const IrradianceMap map = irradiance_map(photons, bandwidth, trial);
            double mean = 0.0;
            for (uint32_t i = 0; i < readers; ++i) {
                const Vec2 u = RandomStream(10, trial, i).next_2d();
                const SurfaceRegion region{Vec3(0.1f + 0.8f * u.x, 0.1f + 0.8f * u.y, 0.0f), Vec3(0, 0, 1)};
                const auto searched = double(estimate_irradiance(photons, region, bandwidth, nearest).value[0]);
                const IrradianceRecord* record = map.nearest(region.position, region.normal);
                found += record != nullptr;
                all += searched;
                if (record) mean += (double(record->irradiance[0]) - searched) / readers;
            }
            sum += mean / maps;
            squares += mean * mean / maps;
        }
        const double error = std::sqrt((squares - sum * sum) / maps);
        EXPECT_NEAR(sum, 0.0, 4.0 * error) << (even ? "even" : "independent");
        EXPECT_LT(error, 0.0008) << "too noisy to tell";
        EXPECT_NEAR(all / (maps * readers), 1.0, 0.005);
        const double share = double(found) / (maps * readers);
        EXPECT_NEAR(share, 1.0 - std::exp(-12.5 * sqr(0.35)), 0.02) << "reach of records";
        std::printf("[ measured ] %s: %+.4f +- %.4f, records for %.3f\n", even ? "even" : "independent", sum, error,
                    share);
    }
}

TEST(IrradianceMap, KeepsToItsSideAndItsReach)
{
    const PhotonMap photons = lit_square(4000);
    const IrradianceMap map = irradiance_map(photons, {50, infinity, KernelKind::constant});
    EXPECT_EQ(map.nearest(Vec3(0.5f, 0.5f, 0.0f), Vec3(0, 0, -1)), nullptr);
    int found = 0;
    for (float x = 0.2f; x < 0.8f; x += 0.1f) {
        found += map.nearest(Vec3(x, 0.5f, 0.0f), Vec3(0, 0, 1)) != nullptr;
        EXPECT_EQ(map.nearest(Vec3(x, 0.5f, 0.0f), Vec3(0, 0, 1), 1e-7f), nullptr);
    }
    EXPECT_GE(found, 3);
    // Far off, and in the same direction beyond a wall: no record speaks for these places.
    EXPECT_EQ(map.nearest(Vec3(5.0f, 0.5f, 0.0f), Vec3(0, 0, 1)), nullptr);
    EXPECT_EQ(map.nearest(Vec3(0.5f, 0.5f, -2.0f), Vec3(0, 0, 1)), nullptr);
}

TEST(IrradianceMap, OfNothingIsEmpty)
{
    const IrradianceMap map = irradiance_map(PhotonMap(), {50, infinity, KernelKind::constant});
    EXPECT_TRUE(map.empty());
}

}  // namespace
}  // namespace dapple
