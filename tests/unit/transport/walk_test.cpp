#include "small_scene.h"

#include "dapple/transport/connect.h"

namespace dapple {
namespace {

using test::SmallScene;

// Dispersion leaves a walk one lane; the densities of the others must not weigh in the medium behind (a coloured
// glass). An index that is 1 at all wavelengths, yet given as a table, bends and reflects nothing: what is left is
// Beer's law.
TEST(Walk, KeepsItsLaneUnbiasedInAColouredMediumBehindADispersiveSurface)
{
    SmallScene scene;
    scene::DielectricMaterial glass;
    glass.eta = scene::SpectrumSource(scene::Samples{{300, 600, 900}, {1, 1, 1}});
    const scene::MaterialIndex dispersive = scene.material(glass);
    const scene::MediumIndex coloured =
        scene.absorber(scene::SpectrumSource(scene::Samples{{300, 500, 900}, {0.1f, 0.1f, 2.5f}}));
    scene::Shape& ball = scene.shape(scene::Sphere{}, dispersive);
    ball.inside = coloured;
    ball.medium_interface = true;
    scene.light(scene::InfiniteLight{scene::SpectrumSource(scene::Constant{1.0f}), {}, {}, {}});
    const auto world = scene.world();

    const Wavelengths wavelengths = Wavelengths::sample_visible(0.1f);
    const Spectrum sky = emitted_environment(world->lights, world->spectra, LightId(0u), Vec3(0, 0, 1), wavelengths);
    const Medium& medium = world->media.list[0];
    const Spectrum expected = sky * exp(world->spectra.evaluate(medium.sigma_a, wavelengths) * -2.0f);
    ASSERT_GT(expected.max(), 5.0f * expected.min()) << "the medium must be coloured";

    Spectrum sum;
    constexpr int count = 20000;
    for (int i = 0; i < count; ++i) {
        RandomStream random(1, 2, static_cast<uint32_t>(i));
        Walk walk(Ray{Vec3(0, 0, -3), Vec3(0, 0, 1), 0.0f}, MediumId(), TransportMode::radiance, wavelengths, i % 4,
                  Spectrum(1.0f));
        while (walk.next(*world, random)) {
        }
        if (walk.escaped()) sum += met_environment(*world, walk, LightId(0u), true);
    }
    for (int lane = 0; lane < Spectrum::lanes; ++lane)
        EXPECT_NEAR(sum[lane] / count, expected[lane], 0.03f * expected.max()) << "lane " << lane;
}

// A medium without an end swallows the sky, but not in a lane that it leaves alone.
TEST(Walk, SeesTheSkyThroughAnEndlessMediumInTheLanesItDoesNotTouch)
{
    SmallScene scene;
    const scene::MediumIndex red_absorber = scene.absorber(scene::SpectrumSource(scene::Rgb{Vec3(1, 0, 0)}));
    scene.light(scene::InfiniteLight{scene::SpectrumSource(scene::Constant{1.0f}), {}, {}, {}}).medium = red_absorber;
    const auto world = scene.world();
    const Wavelengths wavelengths = Wavelengths::rgb();
    const Spectrum sky = emitted_environment(world->lights, world->spectra, LightId(0u), Vec3(0, 0, 1), wavelengths);

    Spectrum sum;
    constexpr int count = 1000;
    for (int i = 0; i < count; ++i) {
        RandomStream random(1, 2, static_cast<uint32_t>(i));
        Walk walk(Ray{Vec3(0, 0, 0), Vec3(0, 0, 1), 0.0f}, MediumId(0u), TransportMode::radiance, wavelengths, i % 4,
                  Spectrum(1.0f));
        while (walk.next(*world, random)) {
        }
        if (walk.escaped()) sum += met_environment(*world, walk, LightId(0u), true);
    }
    EXPECT_EQ(sum[0], 0.0f);
    for (int lane = 1; lane < Spectrum::lanes; ++lane) EXPECT_NEAR(sum[lane] / count, sky[lane], 1e-3f * sky[lane]);

    // Light sampling must agree.
    RandomStream random(1, 3, 0);
    const Transmittance through =
        transmittance(*world, Ray{Vec3(0, 0, 0), Vec3(0, 0, 1), 0.0f}, infinity, MediumId(0u), wavelengths, 0, random);
    EXPECT_EQ(through.value, Spectrum(0, 1, 1, 1));
}

// Inside a sphere of albedo 1/2 the throughput of all vertices sums to 1 + 1/2 + 1/4 + ... = 2. Roulette that counts
// the coming loss keeps it, for any guess of that loss; with the right one each vertex has throughput 1.
TEST(Walk, KeepsItsMeanWhereRouletteCountsTheLossToCome)
{
    SmallScene scene;
    scene.shape(scene::Sphere{}, scene.material(scene::DiffuseMaterial{}));
    const auto world = scene.world();
    for (const float guess : {0.5f, 0.2f, 1.0f}) {
        double sum = 0.0;
        int64_t vertices = 0;
        constexpr int count = 20000;
        for (int i = 0; i < count; ++i) {
            RandomStream random(1, 2, static_cast<uint32_t>(i));
            const Vec2 u = random.next_2d();
            const Vec3 direction = spherical_direction(std::sqrt(1.0f - sqr(u.x)), u.x, 6.2831853f * u.y);
            Walk walk(Ray{Vec3(0.1f, 0.2f, 0.3f), direction, 0.0f}, MediumId(), TransportMode::importance,
                      Wavelengths::rgb(), 0, Spectrum(1.0f));
            while (walk.next(*world, random)) {
                ++vertices;
                sum += walk.throughput()[1];
                if (!walk.survive_roulette(random, Spectrum(guess))) break;
            }
        }
        EXPECT_NEAR(sum / count, 2.0, 0.05) << "guess " << guess;
        const double per_walk = double(vertices) / count;
        EXPECT_NEAR(per_walk, guess == 1.0f ? 3.0 : guess == 0.5f ? 2.0 : 1.4, 0.05) << "guess " << guess;
    }
}

}  // namespace
}  // namespace dapple
