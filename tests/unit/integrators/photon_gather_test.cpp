// Gather rays at a wall so near that whether its photons serve hangs on how many there are.
#include "dapple/integrators/photon_gather.h"

#include "../transport/small_scene.h"

#include <cstdio>

namespace dapple {
namespace {

constexpr float reflectance = 0.8f;
constexpr int nearest = 8;

// A wall at x = 0, 4 wide and 2 high, lit evenly by the sun.
std::unique_ptr<World> sunlit_wall()
{
    test::SmallScene scene;
    scene::MeshData wall;
    wall.positions = {{0, -2, 0}, {0, 2, 0}, {0, 2, 2}, {0, -2, 2}};
    wall.triangles = {0, 1, 2, 0, 2, 3};
    scene.shape(scene::Mesh{std::make_shared<scene::MeshData>(std::move(wall))},
                scene.material(scene::DiffuseMaterial{scene::SpectrumInput(reflectance)}));
    scene.light(scene::DistantLight{scene::SpectrumSource(scene::Constant{1.0f}), Vec3(1, 0, 0), Vec3(0, 0, 0), {}});
    return scene.world();
}

struct RadianceSum {
    double sum = 0.0;
    void add(const Spectrum& radiance, PathClass, LightGroup) { sum += static_cast<double>(radiance.average()); }
};

constexpr int rays = 32;

// Light that gather rays to eight places of the wall bring back, each from about 0.15 away.
double gathered(const World& world, const PhotonMapSet& maps, uint32_t trial)
{
    GatherSettings settings;
    settings.nearest = nearest;
    settings.kernel = KernelKind::constant;
    RadianceSum light;
    RandomStream random(3, 1, trial);
    for (int ray = 0; ray < rays; ++ray) {
        PhotonGather<RadianceSum> gather(settings, world, maps, 1.0f, false, random, light);
        gather.begin_at_diffuse();
        const Vec3 origin(0.15f, -1.6f + 0.45f * float(ray % 8), ray % 2 ? 0.5f : 1.5f);
        const Vec3 target(0.0f, origin.y + 0.1f * random.next() - 0.05f, origin.z + 0.1f * random.next() - 0.05f);
        gather.follow(Walk(Ray{origin, normalize(target - origin), 0.5f}, MediumId(), TransportMode::radiance,
                           Wavelengths::rgb(), 0, Spectrum(1.0f)));
    }
    return light.sum;
}

// Photons that fall independently of one another, `mean` on average, and bring the irradiance given.
PhotonMap photons_of_wall(uint32_t trial, double mean, double irradiance)
{
    uint64_t h = hash_words(uint64_t(trial), 17);
    const auto next = [&] { return to_unit_float(h = hash_words(h, 1)); };
    std::vector<std::vector<Photon>> batches(1);
    constexpr int slots = 4000;
    for (int i = 0; i < slots; ++i) {
        if (static_cast<double>(next()) >= mean / slots) continue;
        Photon photon;
        photon.normal = photon.direction = Vec3(1, 0, 0);
        photon.position.y = 4.0f * next() - 2.0f;
        photon.position.z = 2.0f * next();
        photon.position.x = 0.0f;
        photon.flux = Spectrum(static_cast<float>(irradiance * 8.0 / mean));
        batches[0].push_back(photon);
    }
    return PhotonMap(std::move(batches), 1);
}

// They fall as the photons do.
std::vector<SurfacePlace> places_of_wall(uint32_t trial, double mean)
{
    const PhotonMap fallen = photons_of_wall(trial + 1000000, mean, 1.0);
    std::vector<SurfacePlace> places;
    for (uint32_t slot = 0; slot < fallen.size(); ++slot) places.push_back({fallen.position(slot), Vec3(1, 0, 0)});
    return places;
}

IrradianceMap irradiance_of_wall(const World& world, const PhotonMapSet& maps)
{
    return IrradianceMap(maps.places, 0.25f, [&](const SurfacePlace& place) {
        PlaceIrradiance irradiance;
        std::vector<WeightedPhoton> found;
        maps.discs.find(world, maps.global, {place.position, place.normal}, found);
        for (const auto& [photon, weight] : found) irradiance.irradiance += maps.global.flux(photon) * weight;
        return irradiance;
    });
}

// Every ray brings reflectance / pi times the irradiance, whether the map says so or direct light, where estimates are
// too wide. Were the map asked wherever k of its own photons are near enough, the mean would be up to 15 % too bright
// here.
TEST(PhotonGather, DoesNotFavourDensePhotons)
{
    const auto world = sunlit_wall();
    PhotonMapSet maps;
    maps.wavelengths = Wavelengths::rgb();
    maps.global = photons_of_wall(0, 1.0, 1.0);  // too few: direct light alone
    const double sampled = gathered(*world, maps, 0);
    ASSERT_GT(sampled, 0.0);
    EXPECT_NEAR(gathered(*world, maps, 1) / sampled, 1.0, 1e-4) << "direct light has no noise here";
    const double irradiance = sampled / rays * pi / static_cast<double>(reflectance);

    constexpr uint32_t trials = 300;
    Statistics statistics;
    const PassContext context{*world, 0, 0, statistics};
    for (const bool precomputed : {false, true})
        for (const double mean : {400.0, 850.0, 1700.0}) {
            double sum = 0.0, squares = 0.0;
            for (uint32_t trial = 0; trial < trials; ++trial) {
                maps.global = photons_of_wall(trial, mean, irradiance);
                maps.places = SurfacePlaces(places_of_wall(trial, mean / 4), nearest / 4);
                maps.discs = PhotonDiscs(context, maps.global,
                                         SurfacePlaces(places_of_wall(trial + 500000, mean / 4), nearest / 4),
                                         KernelKind::constant, 0.5f);
                maps.irradiance = precomputed ? irradiance_of_wall(*world, maps) : IrradianceMap();
                const double ratio = gathered(*world, maps, trial) / sampled;
                sum += ratio;
                squares += ratio * ratio;
            }
            const double ratio = sum / trials;
            const double error = std::sqrt((squares / trials - ratio * ratio) / trials);
            std::printf("[ measured ] %s, %4.0f photons: %.4f +- %.4f\n", precomputed ? "precomputed" : "searched   ",
                        mean, ratio, error);
            EXPECT_LT(error, 0.01) << "too noisy to tell";
            EXPECT_NEAR(ratio, 1.0, 4.0 * error);
        }
}

}  // namespace
}  // namespace dapple
