#include "dapple/density/surface_places.h"

#include "photon_radii.h"

#include <gtest/gtest.h>

#include "dapple/density/estimate.h"
#include "dapple/sampling/random_stream.h"

#include <algorithm>
#include <cstdio>

namespace dapple {
namespace {

constexpr Vec3 up(0, 0, 1);

// Places of the unit square, every fifth of them below it.
std::vector<SurfacePlace> places_of_square(uint32_t count, uint64_t trial = 0)
{
    std::vector<SurfacePlace> places;
    for (uint32_t i = 0; i < count; ++i) {
        RandomStream random(9, hash_words(trial, uint64_t(i)), 0);
        const Vec2 u = random.next_2d();
        places.push_back({Vec3(u.x, u.y, 0.0f), i % 5 == 0 ? -up : up});
    }
    return places;
}

TEST(SurfacePlaces, RadiiHoldSoManyPlacesOfTheSide)
{
    const std::vector<SurfacePlace> given = places_of_square(500);
    const SurfacePlaces places(given, 13, 0.5f);
    ASSERT_EQ(places.size(), 500u);
    for (const PhotonSide side : {PhotonSide::same, PhotonSide::opposite, PhotonSide::both})
        for (float x = 0.05f; x < 1.0f; x += 0.1f) {
            const SurfaceRegion region{Vec3(x, 0.4f, 0.0f), up, side};
            std::vector<float> distances;
            for (const SurfacePlace& place : given)
                if (region.takes(place.normal)) distances.push_back(length(place.position - region.position));
            std::sort(distances.begin(), distances.end());
            EXPECT_NEAR(places.radius_at(region), 0.5f * distances[12], 1e-6f);
        }
    // What there is, where there are fewer, but half of them at least; nothing looks that way.
    const std::vector<SurfacePlace> two = {{Vec3(1, 0, 0), up}, {Vec3(2, 0, 0), up}};
    EXPECT_NEAR(SurfacePlaces(two, 4).radius_at({Vec3(0, 0, 0), up}), 2.0f, 1e-6f);
    EXPECT_EQ(SurfacePlaces(two, 5).radius_at({Vec3(0, 0, 0), up}), infinity);
    EXPECT_EQ(places.radius_at({Vec3(0.5f, 0.5f, 0.0f), Vec3(1, 0, 0)}), infinity);
    const SurfaceRegion middle{Vec3(0.5f, 0.5f, 0.0f), up};
    const float radius = places.radius_at(middle);
    EXPECT_EQ(places.radius_at(middle, 1.01f * radius), radius);
    EXPECT_EQ(places.radius_at(middle, 0.99f * radius), infinity);
    EXPECT_GT(SurfacePlaces({{Vec3(1, 0, 0), up}}, 1).radius_at({Vec3(1, 0, 0), up}), 0.0f) << "coincide";
}

TEST(SurfacePlaces, NearestIsThatOfTheSide)
{
    const std::vector<SurfacePlace> given = places_of_square(300);
    const SurfacePlaces places(given, 13);
    for (float x = 0.05f; x < 1.0f; x += 0.1f) {
        const Vec3 p(x, 0.6f, 0.0f);
        uint32_t slot = 0;
        float distance_squared = 0.0f;
        ASSERT_TRUE(places.nearest(p, -up, infinity, slot, distance_squared));
        float least = infinity;
        for (const SurfacePlace& place : given)
            if (place.normal == -up) least = std::min(least, length_squared(place.position - p));
        EXPECT_NEAR(distance_squared, least, 1e-7f);
        EXPECT_EQ(places.place(slot).normal, -up);
        EXPECT_NEAR(length_squared(places.place(slot).position - p), least, 1e-7f);
        EXPECT_FALSE(places.nearest(p, -up, 0.9f * std::sqrt(least), slot, distance_squared));
    }
}

// A floor with a patch that is a hundred times brighter. Radii that other light paths tell keep the flux, exactly for
// any one map but for what leaves the floor, and the dark floor dark: its mean is right to some percent where k-nearest
// estimates give it several times its light.
TEST(SurfacePlaces, KeepTheFluxOfABrightPatch)
{
    constexpr float half_width = 0.1f;
    const auto throw_light = [&](uint64_t trial, uint32_t count) {
        std::vector<Vec3> points;
        for (uint32_t i = 0; i < count; ++i) {
            RandomStream random(11, hash_words(trial, uint64_t(i)), 0);
            const bool in_patch = random.next() < 0.8f;
            const Vec2 u = random.next_2d();
            const Vec2 on_square(2.0f * u.x - 1.0f, 2.0f * u.y - 1.0f);
            points.push_back(in_patch ? Vec3(half_width * on_square.x, half_width * on_square.y, 0.0f)
                                      : Vec3(on_square.x, on_square.y, 0.0f));
        }
        return points;
    };
    constexpr uint32_t photon_count = 5000;
    constexpr int trials = 20, steps = 100;
    double all = 0.0, dark = 0.0, dark_nearest = 0.0;
    int dark_places = 0;
    for (uint64_t trial = 0; trial < trials; ++trial) {
        std::vector<std::vector<Photon>> batches(1);
        for (const Vec3& p : throw_light(2 * trial, photon_count)) {
            Photon photon;
            photon.position = p;
            photon.flux = Spectrum(1.0f);
            batches[0].push_back(photon);
        }
        const PhotonMap map(std::move(batches), photon_count);
        std::vector<SurfacePlace> given;
        for (const Vec3& p : throw_light(2 * trial + 1, photon_count / 4)) given.push_back({p, up});
        const SurfacePlaces places(given, 13);
        const PointLimits radii = radii_of(map, places);
        NearestPoints nearest(50);
        const Vec2 shift = RandomStream(13, trial, 0).next_2d();
        for (int i = 0; i < steps * steps; ++i) {
            const auto at = [](int k, float within) { return 3.0f * (static_cast<float>(k) + within) / steps - 1.5f; };
            const SurfaceRegion region{Vec3(at(i % steps, shift.x), at(i / steps, shift.y), 0.0f), up};
            float value = 0.0f;
            visit_reaching(map, radii, region, KernelKind::epanechnikov,
                           [&](uint32_t, float weight) { value += weight; });
            all += static_cast<double>(value) * sqr(3.0 / steps) / trials;
            const float from_middle = std::max(std::fabs(region.position.x), std::fabs(region.position.y));
            if (from_middle < 0.25f || from_middle > 0.7f) continue;
            ++dark_places;
            dark += static_cast<double>(value);
            dark_nearest += static_cast<double>(
                estimate_irradiance(map, region, {50, infinity, KernelKind::epanechnikov}, nearest).value[0]);
        }
    }
    const double truth = 0.2 / 4.0;
    std::printf("[ measured ] flux %.4f; dark floor %.3f of the truth, k-nearest %.3f\n", all,
                dark / dark_places / truth, dark_nearest / dark_places / truth);
    EXPECT_NEAR(all, 1.0, 0.003) << "a grid of places adds up kernels, some of them narrow";
    EXPECT_NEAR(dark / dark_places / truth, 1.0, 0.04);
}

}  // namespace
}  // namespace dapple
