#include "dapple/density/estimate.h"

#include "dapple/math/frame.h"
#include "dapple/math/hash.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace dapple {
namespace {

float uniform_number(uint64_t a, uint64_t b) { return to_unit_float(hash_words(a, b, 77)); }

// Photons of 1 W each on the square |x|, |y| < 1 at height z, from above.
std::vector<Photon> lit_square(uint64_t seed, int count, float z = 0.0f)
{
    std::vector<Photon> photons(static_cast<size_t>(count));
    for (size_t i = 0; i < photons.size(); ++i) {
        const uint64_t number = hash_words(seed, i);
        photons[i].position = {2 * uniform_number(number, 1) - 1, 2 * uniform_number(number, 2) - 1, z};
        photons[i].flux = Spectrum(1.0f, 0.5f, 0.25f, 0.0f);
        photons[i].light_group = static_cast<uint8_t>(i % 3);
        photons[i].path_class = static_cast<uint8_t>(i % 5);
    }
    return photons;
}

PhotonMap map_of(const std::vector<Photon>& photons, uint64_t emitted)
{
    return PhotonMap(std::vector<std::vector<Photon>>{photons}, emitted);
}

struct Statistics {
    double sum = 0, sum_squared = 0, count = 0;

    void add(double x)
    {
        sum += x;
        sum_squared += x * x;
        count += 1;
    }
    double mean() const { return sum / count; }
    double standard_error() const { return std::sqrt((sum_squared / count - mean() * mean()) / count); }
};

constexpr int plane_photons = 1500;
constexpr double plane_irradiance = plane_photons / 4.0 / 3000.0;  // emitted 3000 paths onto 4 m^2
const SurfaceRegion upward{{0, 0, 0}, {0, 0, 1}};

template <class Estimate>
Statistics over_lit_planes(const Estimate& estimate)
{
    Statistics statistics;
    static const std::vector<PhotonMap> maps = [] {
        std::vector<PhotonMap> built;
        for (uint64_t seed = 0; seed < 300; ++seed) built.push_back(map_of(lit_square(seed, plane_photons), 3000));
        return built;
    }();
    for (const PhotonMap& map : maps) {
        for (const Vec3& at : {Vec3(-0.5f, -0.5f, 0), Vec3(0.5f, -0.5f, 0), Vec3(-0.5f, 0.5f, 0), Vec3(0.5f, 0.5f, 0)})
            statistics.add(estimate(map, SurfaceRegion{at, {0, 0, 1}}));
    }
    return statistics;
}

void expect_unbiased(const Statistics& statistics, double expected, const std::string& name,
                     double largest_error = 0.02)
{
    EXPECT_NEAR(statistics.mean(), expected, 3.5 * statistics.standard_error()) << name;
    EXPECT_LT(statistics.standard_error(), largest_error * expected) << name;
}

TEST(Estimate, AnEvenlyLitPlaneHasItsIrradianceWithEveryKernel)
{
    for (int k = 0; k < kernel_count; ++k) {
        const auto kernel = static_cast<KernelKind>(k);
        const std::string name(kernel_names[static_cast<size_t>(k)]);
        for (const int count : {0, 8, 40}) {
            for (const float radius : {0.08f, 0.45f}) {
                for (const float shrinkage : {1.0f, 0.6f}) {
                    NearestPoints nearest(std::max(1, count));
                    const Statistics s = over_lit_planes([&](const PhotonMap& map, const SurfaceRegion& region) {
                        return estimate_irradiance(map, region, {count, radius, kernel, 0.0f, shrinkage}, nearest)
                            .value[0];
                    });
                    expect_unbiased(s, plane_irradiance,
                                    name + ", k " + std::to_string(count) + ", " + std::to_string(radius) + " x " +
                                        std::to_string(shrinkage),
                                    0.02 / double(shrinkage));
                }
            }
        }
    }
}

// The estimate with k in place of k - 1 must stand out at the sample count of the test above, or that test shows
// nothing.
TEST(Estimate, CountingTheFarthestPhotonWouldShow)
{
    NearestPoints nearest(8);
    const Statistics s = over_lit_planes([&](const PhotonMap& map, const SurfaceRegion& region) {
        map.find_nearest_on_surface(region, infinity, nearest);
        const float r_squared = nearest.distance_squared(nearest.farthest());
        return 8.0f / (pi * r_squared * 3000.0f);
    });
    EXPECT_GT(s.mean() - plane_irradiance, 6.0 * s.standard_error());
    EXPECT_NEAR(s.mean(), plane_irradiance * 8.0 / 7.0, 3.5 * s.standard_error());
}

// A bright patch on a dim floor: k-nearest estimates alone reach into it from afar and count its photons again and
// again.
TEST(Estimate, ABrightPatchGivesTheFloorNoLight)
{
    constexpr int steps = 90, trials = 20;
    constexpr float half_width = 0.9f;
    NearestPoints nearest(50);
    double found = 0.0, plain = 0.0, truth = 0.0;
    for (uint64_t trial = 0; trial < trials; ++trial) {
        std::vector<Photon> photons = lit_square(trial, 200);
        for (size_t i = 0; i < 800; ++i) {
            Photon photon = photons[0];
            const uint64_t number = hash_words(trial + 1000, i);
            photon.position = {0.4f * uniform_number(number, 1), 0.4f * uniform_number(number, 2), 0.0f};
            photons.push_back(photon);
        }
        const PhotonMap map = map_of(photons, 1);
        constexpr float step = 2.0f * half_width / steps;
        for (int i = 0; i < steps * steps; ++i) {
            const Vec3 at((static_cast<float>(i % steps) + 0.5f) * step - half_width,
                          (static_cast<float>(i / steps) + 0.5f) * step - half_width, 0.0f);
            const SurfaceRegion region{at, {0, 0, 1}};
            found += double(estimate_irradiance(map, region, {50, infinity}, nearest).value[0] * sqr(step));
            map.find_nearest_on_surface(region, infinity, nearest);
            const float r_squared = nearest.distance_squared(nearest.farthest());
            for (int j = 0; j < nearest.count(); ++j)
                plain +=
                    double(kernel_disc(KernelKind::epanechnikov, std::sqrt(nearest.distance_squared(j) / r_squared)) /
                           r_squared * sqr(step));
        }
        truth += 200.0 * double(sqr(half_width)) + 800.0;
    }
    std::printf("[ measured ] light of the floor: %.3f of the truth, %.3f without looking for unevenness\n",
                found / truth, plain / truth);
    EXPECT_NEAR(found / truth, 1.0, 0.03);
    EXPECT_GT(plain / truth, 1.07);
}

TEST(Estimate, ReportsItsSupport)
{
    const PhotonMap map = map_of(lit_square(1, plane_photons), 3000);
    NearestPoints nearest(30);
    const RadianceEstimate k = estimate_irradiance(map, upward, {30, infinity, KernelKind::constant}, nearest);
    EXPECT_EQ(k.support.count, 29);
    EXPECT_NEAR(k.support.density * pi * sqr(k.support.radius), 29.0f, 1e-3f);
    EXPECT_NEAR(k.value[0], k.support.density / 3000.0f, 1e-6f);
    const RadianceEstimate fixed =
        estimate_irradiance(map, upward, {0, k.support.radius, KernelKind::constant}, nearest);
    EXPECT_EQ(fixed.support.count, 29);
    EXPECT_NEAR(fixed.value[0], k.value[0], 1e-6f);
    const RadianceEstimate few = estimate_irradiance(map, upward, {30, 0.5f * k.support.radius}, nearest);
    EXPECT_LT(few.support.count, 29);
    EXPECT_EQ(few.support.radius, 0.5f * k.support.radius);
}

TEST(Estimate, ScatteringSeesTheDirectionOfEachPhoton)
{
    std::vector<Photon> photons = lit_square(2, 400);
    const Vec3 first = normalize(Vec3(1, 2, 3));
    const Vec3 second = normalize(Vec3(-2, 0.5f, 1));
    for (size_t i = 0; i < photons.size(); ++i) photons[i].direction = i % 2 == 0 ? first : second;
    const PhotonMap map = map_of(photons, 10);
    NearestPoints nearest(100);
    const Bandwidth bandwidth{100, infinity, KernelKind::silverman};
    const auto only = [](const Vec3& wanted) {
        return [wanted](const Vec3& wi) { return Spectrum(dot(wi, wanted) > 0.999f ? 0.25f : 0.0f); };
    };
    const Spectrum a = estimate_radiance(map, upward, bandwidth, nearest, only(first)).value;
    const Spectrum b = estimate_radiance(map, upward, bandwidth, nearest, only(second)).value;
    const Spectrum all = estimate_irradiance(map, upward, bandwidth, nearest).value;
    EXPECT_GT(a[0], 0.0f);
    EXPECT_GT(b[0], 0.0f);
    for (int lane = 0; lane < 4; ++lane) EXPECT_NEAR(a[lane] + b[lane], 0.25f * all[lane], 1e-5f * all[0]);
}

TEST(Estimate, GroupsAndClassesAddUpToTheWhole)
{
    const PhotonMap map = map_of(lit_square(3, 500), 10);
    NearestPoints nearest(60);
    const Bandwidth bandwidth{60, infinity, KernelKind::cone};
    Spectrum by_group[3], by_class[5];
    visit_photons(map, upward, bandwidth, nearest, [&](uint32_t slot, float weight) {
        by_group[map.light_group(slot)] += map.flux(slot) * weight;
        by_class[map.path_class(slot)] += map.flux(slot) * weight;
    });
    const Spectrum all = estimate_irradiance(map, upward, bandwidth, nearest).value;
    Spectrum groups, classes;
    for (const Spectrum& s : by_group) groups += s;
    for (const Spectrum& s : by_class) classes += s;
    for (int lane = 0; lane < 4; ++lane) {
        EXPECT_NEAR(groups[lane], all[lane], 1e-5f * all[0]);
        EXPECT_NEAR(classes[lane], all[lane], 1e-5f * all[0]);
    }
}

// A wall of 1 mm as two faces, and as one face, lit from one side only, in several orientations.
TEST(Estimate, TheRoomBehindAThinWallIsBlack)
{
    for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0, -1, 0), normalize(Vec3(1, -2, 0.5f))}) {
        const Frame frame(axis);
        for (const float thickness : {0.001f, 0.0f}) {
            std::vector<Photon> photons = lit_square(4, 20000, thickness);
            for (Photon& photon : photons) {
                photon.position = frame.to_world(photon.position);
                photon.normal = axis;
                photon.direction = normalize(axis + frame.s);
            }
            const PhotonMap map = map_of(photons, 20000);
            NearestPoints nearest(50);
            const auto irradiance = [&](const Vec3& normal, PhotonSide side, int count) {
                const SurfaceRegion region{frame.to_world({0.1f, 0.2f, 0.0f}), normal, side};
                return estimate_irradiance(map, region, {count, 0.1f, KernelKind::constant}, nearest).value;
            };
            for (const int count : {0, 50}) {
                EXPECT_EQ(irradiance(-axis, PhotonSide::same, count), Spectrum(0.0f));
                EXPECT_EQ(irradiance(axis, PhotonSide::opposite, count), Spectrum(0.0f));
                EXPECT_NEAR(irradiance(axis, PhotonSide::same, count)[0], 0.25f, count > 0 ? 0.15f : 0.05f);
                EXPECT_NEAR(irradiance(-axis, PhotonSide::opposite, count)[0], 0.25f, count > 0 ? 0.15f : 0.05f);
                EXPECT_EQ(irradiance(axis, PhotonSide::both, count), irradiance(-axis, PhotonSide::both, count));
            }
        }
    }
}

TEST(Estimate, AWallDoesNotLightTheFloorAtTheCorner)
{
    std::vector<Photon> wall = lit_square(5, 20000);
    for (Photon& photon : wall) {
        photon.position = {0.0f, photon.position.y, photon.position.x + 1.0f};
        photon.normal = {1, 0, 0};
    }
    const PhotonMap map = map_of(wall, 1);
    NearestPoints nearest(50);
    for (const int count : {0, 50}) {
        const SurfaceRegion floor{{0.01f, 0, 0}, {0, 0, 1}};
        EXPECT_EQ(estimate_irradiance(map, floor, {count, 0.2f}, nearest).value, Spectrum(0.0f));
    }
}

TEST(Estimate, PhotonsOffTheTangentPlaneDoNotCount)
{
    const PhotonMap map = map_of(lit_square(6, 20000, 0.02f), 1);
    NearestPoints nearest(50);
    EXPECT_EQ(estimate_irradiance(map, upward, {0, 0.19f}, nearest).value, Spectrum(0.0f));
    EXPECT_EQ(estimate_irradiance(map, upward, {50, 0.19f}, nearest).value, Spectrum(0.0f));
    EXPECT_GT(estimate_irradiance(map, upward, {0, 0.21f}, nearest).value[0], 0.0f);
}

// A spherical cap of chord r has the area pi r^2.
TEST(Estimate, AnEvenlyLitSphereHasItsIrradiance)
{
    Statistics statistics;
    NearestPoints unused(1);
    for (uint64_t seed = 0; seed < 100; ++seed) {
        std::vector<Photon> photons(5000);
        for (size_t i = 0; i < photons.size(); ++i) {
            const float z = 2 * uniform_number(i, seed * 2) - 1;
            const float phi = 2 * pi * uniform_number(i, seed * 2 + 1);
            photons[i].normal = {safe_sqrt(1 - z * z) * std::cos(phi), safe_sqrt(1 - z * z) * std::sin(phi), z};
            photons[i].position = photons[i].normal * 2.0f;
            photons[i].flux = Spectrum(1.0f);
        }
        const PhotonMap map = map_of(photons, 5000);
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3 n =
                normalize(Vec3(corner & 1 ? 1.0f : -1.0f, corner & 2 ? 1.0f : -1.0f, corner & 4 ? 1.0f : -1.0f));
            statistics.add(estimate_irradiance(map, {n * 2.0f, n}, {0, 0.38f, KernelKind::constant}, unused).value[0]);
        }
    }
    EXPECT_NEAR(statistics.mean(), 1.0 / (4 * 3.14159265 * 4), 3.5 * statistics.standard_error());
    EXPECT_LT(statistics.standard_error(), 0.01 * statistics.mean());
}

TEST(Estimate, NothingAndTooLittleAreFinite)
{
    NearestPoints nearest(10);
    for (const int photons : {0, 1, 2, 5}) {
        const PhotonMap map = map_of(lit_square(7, photons), 10);
        for (const float radius : {0.1f, 100.0f, infinity}) {
            const RadianceEstimate e = estimate_irradiance(map, upward, {10, radius}, nearest);
            EXPECT_TRUE(e.value.is_finite());
            EXPECT_TRUE(std::isfinite(e.support.density));
        }
    }
    std::vector<Photon> same_place(40, lit_square(8, 1)[0]);
    same_place[0].position = {5, 5, 0};
    const PhotonMap map = map_of(same_place, 40);
    const RadianceEstimate e = estimate_irradiance(map, {same_place[1].position, {0, 0, 1}}, {10, 1.0f}, nearest);
    EXPECT_TRUE(e.value.is_finite());
    EXPECT_EQ(e.support.count, 39);
    EXPECT_GT(e.value[0], 0.0f);
}

}  // namespace
}  // namespace dapple
