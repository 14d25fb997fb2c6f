#include "dapple/density/irradiance_map.h"

#include "photon_radii.h"

#include <gtest/gtest.h>

#include "dapple/density/estimate.h"
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

// A quarter as many places, which know nothing of the photons.
SurfacePlaces places_of_square(uint32_t photons, uint64_t trial = 0, uint64_t purpose = 9)
{
    std::vector<SurfacePlace> places;
    for (uint32_t i = 0; i < photons / 4; ++i) {
        RandomStream random(purpose, hash_words(trial, uint64_t(i)), 0);
        const Vec2 u = random.next_2d();
        places.push_back({Vec3(u.x, u.y, 0.0f), Vec3(0, 0, 1)});
    }
    return SurfacePlaces(places, 13);
}

float irradiance_at(const PhotonMap& photons, const PointLimits& radii, const SurfaceRegion& region)
{
    float sum = 0.0f;
    visit_reaching(photons, radii, region, KernelKind::epanechnikov,
                   [&](uint32_t slot, float weight) { sum += photons.flux(slot)[0] * weight; });
    return sum;
}

// What readers get, who search where no record reaches, has the mean of searches alone, and both that of the light:
// records know nothing of how many photons lie near their reader, nor how wide these reach. With radii from the
// records' own places they would be 1.3 % too dark.
TEST(IrradianceMap, HasTheMeanOfSearches)
{
    constexpr int maps = 24;
    constexpr uint32_t photon_count = 20000, readers = 1000;
    constexpr float reach = 0.25f;
    for (const bool even : {false, true}) {
        double sum = 0.0, squares = 0.0, all = 0.0;
        int found = 0;
        for (uint64_t trial = 0; trial < maps; ++trial) {
            const PhotonMap photons = lit_square(photon_count, trial, even);
            const SurfacePlaces places = places_of_square(photon_count, trial);
            const PointLimits radii = radii_of(photons, places_of_square(photon_count, trial, 19));
            const IrradianceMap map(places, reach, [&](const SurfacePlace& place) {
                return PlaceIrradiance{Spectrum(irradiance_at(photons, radii, {place.position, place.normal})), false};
            });
            double mean = 0.0;
            for (uint32_t i = 0; i < readers; ++i) {
                const Vec2 u = RandomStream(10, trial, i).next_2d();
                const SurfaceRegion region{Vec3(0.1f + 0.8f * u.x, 0.1f + 0.8f * u.y, 0.0f), Vec3(0, 0, 1)};
                const auto searched = double(irradiance_at(photons, radii, region));
                const IrradianceRecord* record = map.nearest(places, region.position, region.normal);
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
        EXPECT_NEAR(all / (maps * readers), 1.0, 0.003);
        const double share = double(found) / (maps * readers);
        EXPECT_NEAR(share, 1.0 - std::exp(-13.0 * sqr(double(reach))), 0.02) << "reach of records";
        std::printf("[ measured ] %s: %+.4f +- %.4f, searches %.4f, records for %.3f\n", even ? "even" : "independent",
                    sum, error, all / (maps * readers), share);
    }
}

TEST(IrradianceMap, KeepsToItsSideAndItsReach)
{
    const SurfacePlaces places = places_of_square(4000);
    const IrradianceMap map(places, 0.35f, [](const SurfacePlace& place) {
        return PlaceIrradiance{Spectrum(place.position.x), place.position.y > 0.8f};
    });
    EXPECT_EQ(map.nearest(places, Vec3(0.5f, 0.5f, 0.0f), Vec3(0, 0, -1)), nullptr);
    int found = 0;
    for (float x = 0.2f; x < 0.8f; x += 0.05f) {
        const IrradianceRecord* record = map.nearest(places, Vec3(x, 0.5f, 0.0f), Vec3(0, 0, 1));
        found += record != nullptr;
        if (record) {
            EXPECT_NEAR(record->irradiance[0], x, record->reach);
            EXPECT_NEAR(record->reach, 0.35f * record->radius, 1e-6f);
        }
        EXPECT_EQ(map.nearest(places, Vec3(x, 0.5f, 0.0f), Vec3(0, 0, 1), 1e-7f), nullptr);
        EXPECT_EQ(map.nearest(places, Vec3(x, 0.9f, 0.0f), Vec3(0, 0, 1)), nullptr) << "something was hidden";
    }
    EXPECT_GE(found, 6);
    // Far off, and in the same direction beyond a wall: no record speaks for these places.
    EXPECT_EQ(map.nearest(places, Vec3(5.0f, 0.5f, 0.0f), Vec3(0, 0, 1)), nullptr);
    EXPECT_EQ(map.nearest(places, Vec3(0.5f, 0.5f, -2.0f), Vec3(0, 0, 1)), nullptr);
}

TEST(IrradianceMap, OfNothingIsEmpty)
{
    const IrradianceMap map(SurfacePlaces(), 0.35f, [](const SurfacePlace&) { return PlaceIrradiance(); });
    EXPECT_TRUE(map.empty());
}

}  // namespace
}  // namespace dapple
