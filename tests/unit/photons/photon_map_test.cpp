#include "dapple/photons/photon_map.h"

#include "clouds.h"
#include "dapple/base/parallel.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

Vec3 random_unit(uint64_t i)
{
    const float z = 1.0f - 2.0f * uniform_number(i, 11);
    const float phi = 2.0f * pi * uniform_number(i, 12);
    const float s = safe_sqrt(1.0f - z * z);
    return {s * std::cos(phi), s * std::sin(phi), z};
}

Photon random_photon(uint64_t i)
{
    Photon photon;
    photon.position = {uniform_number(i, 1), uniform_number(i, 2), uniform_number(i, 3)};
    photon.direction = random_unit(i);
    photon.normal = random_unit(i + 1000000);
    const float scale = std::pow(10.0f, 20.0f * uniform_number(i, 4) - 10.0f);
    photon.flux = Spectrum(uniform_number(i, 5), uniform_number(i, 6), uniform_number(i, 7), 0.0f) * scale;
    photon.light_group = static_cast<uint8_t>(i % 251);
    photon.path_class = static_cast<uint8_t>(i % 5);
    return photon;
}

std::vector<std::vector<Photon>> random_batches(size_t batches, size_t photons_each)
{
    std::vector<std::vector<Photon>> result(batches);
    for (size_t b = 0; b < batches; ++b)
        for (size_t i = 0; i < photons_each; ++i) result[b].push_back(random_photon(b * photons_each + i));
    return result;
}

TEST(PhotonPacking, DirectionErrorsAreBounded)
{
    double worst16 = 0.0, worst8 = 0.0;
    for (uint64_t i = 0; i < 200000; ++i) {
        const Vec3 w = random_unit(i);
        worst16 = std::max(worst16, static_cast<double>(angle_between(w, unpack_unit<16>(pack_unit<16>(w)))));
        worst8 = std::max(worst8, static_cast<double>(angle_between(w, unpack_unit<8>(pack_unit<8>(w)))));
    }
    EXPECT_LT(worst16, 1e-4);
    EXPECT_LT(worst8, 0.02);
    for (int axis = 0; axis < 3; ++axis)
        for (const float sign : {-1.0f, 1.0f}) {
            Vec3 w(0.0f);
            w[axis] = sign;
            EXPECT_EQ(unpack_unit<16>(pack_unit<16>(w)), w);
            EXPECT_EQ(unpack_unit<8>(pack_unit<8>(w)), w);
        }
}

TEST(PhotonPacking, FluxErrorsAreBoundedByTheLargestLane)
{
    for (uint64_t i = 0; i < 100000; ++i) {
        Spectrum flux = random_photon(i).flux;
        if (i % 3 == 0) flux[1] = -flux[1];
        const Spectrum packed = unpack_flux(pack_flux(flux, i));
        const float largest = std::max({std::fabs(flux[0]), std::fabs(flux[1]), std::fabs(flux[2])});
        for (int lane = 0; lane < 4; ++lane) ASSERT_LE(std::fabs(packed[lane] - flux[lane]), 2.5e-4f * largest);
        EXPECT_EQ(packed[3], 0.0f);
    }
}

TEST(PhotonPacking, FluxAtTheEndsOfTheRange)
{
    for (const float value : {0.0f, 1.0f, 0.5f, 3.0f, 0x1p-100f, 0x1p100f, -1.0f, -0x1p90f})
        EXPECT_EQ(unpack_flux(pack_flux(Spectrum(value), 7)), Spectrum(value)) << value;
    EXPECT_EQ(unpack_flux(pack_flux(Spectrum(1e-38f), 7)), Spectrum(0.0f));
    for (const float value : {std::nextafter(1.0f, 0.0f), std::nextafter(0x1p100f, 0.0f), 1e-30f, 9.99e29f}) {
        const Spectrum packed = unpack_flux(pack_flux(Spectrum(value, -value, 0.0f, value), 3));
        EXPECT_NEAR(packed[0], value, 2.5e-4f * value);
        EXPECT_NEAR(packed[1], -value, 2.5e-4f * value);
    }
}

// Rounding to nearest would lose the faint lane altogether and shift the others by up to 1e-4.
TEST(PhotonPacking, SumsOfManyEqualFluxesHaveNoBias)
{
    const Spectrum flux(0.70001f, 1.1e-5f, 0.33337f, -0.1234567f);
    constexpr int count = 200000;
    double sums[4] = {};
    for (uint64_t i = 0; i < count; ++i) {
        const Spectrum packed = unpack_flux(pack_flux(flux, i));
        for (int lane = 0; lane < 4; ++lane) sums[lane] += static_cast<double>(packed[lane]);
    }
    // One step is 2^-13; its rounding has a standard deviation of half a step at most.
    const double tolerance = 4.0 * 0.5 * 0x1p-13 / std::sqrt(double{count}) + 0x1p-13 * 0x1p-16;
    for (int lane = 0; lane < 4; ++lane)
        EXPECT_NEAR(sums[lane] / count, static_cast<double>(flux[lane]), tolerance) << lane;
}

TEST(PhotonMap, KeepsPhotonsWithinThePackingErrors)
{
    const auto batches = random_batches(5, 321);
    auto given = batches;
    const PhotonMap map(std::move(given), 4711);
    EXPECT_EQ(map.emitted(), 4711u);
    EXPECT_EQ(map.size(), 5u * 321u);
    EXPECT_EQ(map.dropped(), 0u);
    std::vector<int> seen(map.size(), 0);
    for (uint32_t slot = 0; slot < map.size(); ++slot) {
        const Photon packed = map.photon(slot);
        size_t match = map.size();
        for (size_t i = 0; i < map.size(); ++i)
            if (batches[i / 321][i % 321].position == packed.position) match = i;
        ASSERT_LT(match, map.size());
        ++seen[match];
        const Photon& original = batches[match / 321][match % 321];
        EXPECT_LT(angle_between(packed.direction, original.direction), 1e-4f);
        EXPECT_LT(angle_between(packed.normal, original.normal), 0.02f);
        EXPECT_EQ(packed.light_group, original.light_group);
        EXPECT_EQ(packed.path_class, original.path_class);
        for (int lane = 0; lane < 4; ++lane)
            EXPECT_LE(std::fabs(packed.flux[lane] - original.flux[lane]), 2.5e-4f * original.flux.max());
    }
    EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<long>(seen.size()));
}

TEST(PhotonMap, LeavesOutWhatIsNotFiniteAndCountsIt)
{
    auto batches = random_batches(2, 50);
    batches[0][3].position.x = std::nanf("");
    batches[0][4].position.y = infinity;
    batches[1][5].flux[2] = infinity;
    batches[1][6].flux[1] = std::nanf("");
    batches[1][7].direction = Vec3(0.0f);
    batches[1][8].normal.z = std::nanf("");
    const PhotonMap map(std::move(batches), 100);
    EXPECT_EQ(map.size(), 94u);
    EXPECT_EQ(map.dropped(), 6u);
    for (uint32_t slot = 0; slot < map.size(); ++slot) EXPECT_TRUE(map.flux(slot).is_finite());
}

TEST(PhotonMap, AnEmptyMapFindsNothing)
{
    for (const PhotonMap& map : {PhotonMap(), PhotonMap({}, 10), PhotonMap({{}, {}}, 10)}) {
        NearestPoints nearest(5);
        map.find_nearest(Vec3(0.0f), infinity, nearest);
        EXPECT_EQ(nearest.count(), 0);
        map.for_each_within(Vec3(0.0f), 1e9f, [](uint32_t, float) { FAIL(); });
        EXPECT_TRUE(map.bounds().isEmpty());
    }
}

TEST(PhotonMap, DoesNotDependOnThreads)
{
    std::vector<Photon> first;
    for (const int threads : {1, 2, 7}) {
        set_thread_count(threads);
        const PhotonMap map(random_batches(37, 2500), 1);
        std::vector<Photon> photons;
        for (uint32_t slot = 0; slot < map.size(); ++slot) photons.push_back(map.photon(slot));
        if (first.empty()) first = photons;
        for (size_t i = 0; i < first.size(); ++i) {
            ASSERT_EQ(photons[i].position, first[i].position);
            ASSERT_EQ(photons[i].direction, first[i].direction);
            ASSERT_EQ(photons[i].flux, first[i].flux);
        }
    }
    set_thread_count(0);
}

TEST(PhotonMap, CostsAtMostThirtyTwoBytesPerPhoton)
{
    const PhotonMap map(random_batches(10, 10000), 1);
    EXPECT_LT(static_cast<double>(map.memory_bytes()) / map.size(), 31.6);
}

TEST(PhotonMap, SurfaceQueriesTakeThePhotonsOfTheirSide)
{
    auto batches = random_batches(1, 4000);
    for (Photon& photon : batches[0]) photon.position.z *= 0.05f;
    const PhotonMap map(std::move(batches), 1);
    for (const PhotonSide side : {PhotonSide::same, PhotonSide::opposite, PhotonSide::both}) {
        for (uint64_t i = 0; i < 40; ++i) {
            SurfaceRegion region{{uniform_number(i, 21), uniform_number(i, 22), 0.025f}, random_unit(i), side};
            region.min_normal_cosine = 0.3f + 0.5f * uniform_number(i, 23);
            const float radius = 0.2f;
            int found = 0, expected = 0;
            const auto accepted = [&](uint32_t slot) {
                const float c = dot(map.normal(slot), region.normal);
                const float judged = side == PhotonSide::same ? c : side == PhotonSide::opposite ? -c : std::fabs(c);
                return judged - region.min_normal_cosine;
            };
            map.for_each_on_surface(region, radius, [&](uint32_t slot, float) {
                EXPECT_GT(accepted(slot), -1e-5f);
                ++found;
            });
            for (uint32_t slot = 0; slot < map.size(); ++slot) {
                const Vec3 d = map.position(slot) - region.position;
                expected +=
                    accepted(slot) > 0.0f && length(d) < radius && std::fabs(dot(d, region.normal)) < 0.1f * radius;
            }
            EXPECT_NEAR(found, expected, 1);
        }
    }
}

}  // namespace
}  // namespace dapple
