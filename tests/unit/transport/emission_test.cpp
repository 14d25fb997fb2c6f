#include "dapple/transport/emission.h"

#include "small_scene.h"

#include "dapple/transport/connect.h"

namespace dapple {
namespace {

using test::SmallScene;

TEST(Emission, StartsATwoSidedLightsPathsInTheMediumOfTheirSide)
{
    SmallScene scene;
    scene::Shape& square = scene.square(0.0f, 1.0f, scene.material(scene::DiffuseMaterial{}));
    square.outside = scene.absorber(scene::SpectrumSource(scene::Constant{0.1f}));
    square.inside = scene.absorber(scene::SpectrumSource(scene::Constant{0.2f}));
    square.medium_interface = true;
    scene.emit().two_sided = true;
    const auto world = scene.world();
    int upwards = 0;
    for (uint32_t i = 0; i < 64; ++i) {
        RandomStream random(1, 2, i);
        Walk walk;
        Departure departure;
        ASSERT_TRUE(emit(*world, path_start(Wavelengths::rgb(), random.next_2d()), random, walk, departure));
        const bool up = walk.ray().direction.z > 0.0f;
        upwards += up;
        EXPECT_EQ(walk.medium(), MediumId(up ? 0u : 1u));
    }
    EXPECT_EQ(upwards, 32);
}

// A cut-out removes emission from all techniques alike: met by rays, sampled from a point, and carried by light paths.
TEST(Emission, IsCutOutByATextureForAllTechniques)
{
    SmallScene scene;
    scene.description.float_textures.emplace_back().kind = 0.25f;
    scene::Shape& light = scene.square(1.0f, 1.0f, scene.material(scene::DiffuseMaterial{scene::SpectrumInput(0.0f)}));
    light.reverse_orientation = true;  // shines down
    light.alpha.texture = scene::FloatTextureIndex(0u);
    scene.emit();
    scene.square(0.0f, 20.0f, scene.material(scene::DiffuseMaterial{scene::SpectrumInput(1.0f)}));
    const auto cut_out = scene.world();
    scene.description.shapes[0].alpha = scene::FloatInput(1.0f);
    const auto whole = scene.world();

    // The light at the floor's middle, by light sampling, by scattering, and by both.
    struct Sums {
        double sampled = 0.0, met = 0.0, both = 0.0, emitted = 0.0;
    };
    const auto measure = [](const World& world) {
        Sums sums;
        for (uint32_t i = 0; i < 20'000; ++i) {
            RandomStream random(1, 2, i);
            Walk eye(Ray{Vec3(6, 0, 2), normalize(Vec3(-6, 0.1f, -2)), 0.0f}, MediumId(), TransportMode::radiance,
                     Wavelengths::rgb(), 0, Spectrum(1.0f));
            const Vertex* vertex = eye.next(world, random);
            if (vertex == nullptr) continue;
            sums.sampled += static_cast<double>(direct_light(world, eye, *vertex, false, random).radiance[0]);
            sums.both += static_cast<double>(direct_light(world, eye, *vertex, true, random).radiance[0]);
            vertex = eye.next(world, random);
            if (vertex != nullptr && vertex->emitter.valid()) {
                sums.met += static_cast<double>(met_emission(world, eye, false)[0]);
                sums.both += static_cast<double>(met_emission(world, eye, true)[0]);
            }
            Walk particle;
            Departure departure;
            if (emit(world, path_start(Wavelengths::rgb(), random.next_2d()), random, particle, departure))
                sums.emitted += static_cast<double>(particle.source()[0]);
        }
        return sums;
    };
    const Sums all = measure(*whole);
    const Sums part = measure(*cut_out);
    EXPECT_NEAR(all.sampled / all.met, 1.0, 0.03);
    EXPECT_NEAR(all.both / all.met, 1.0, 0.03);
    EXPECT_NEAR(part.met / all.met, 0.25, 0.02);
    EXPECT_NEAR(part.sampled / all.sampled, 0.25, 0.01);
    EXPECT_NEAR(part.both / all.both, 0.25, 0.01);
    EXPECT_NEAR(part.emitted / all.emitted, 0.25, 0.001);
}

}  // namespace
}  // namespace dapple
