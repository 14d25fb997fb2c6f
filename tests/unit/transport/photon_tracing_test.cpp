#include "dapple/transport/photon_tracing.h"

#include "small_scene.h"

namespace dapple {
namespace {

using test::SmallScene;

struct CausticLight {
    double flux = 0.0;
    int photons = 0;
};

CausticLight caustic_light(const World& world, bool caustic_only)
{
    PhotonRequest request;
    request.wavelengths = Wavelengths::rgb();
    request.stream = caustic_only ? 1 : 2;
    request.paths = 60'000;
    request.mark_caustics = true;
    request.caustic_only = caustic_only;
    CausticLight sum;
    for (const auto& batch : trace_photons(world, request))
        for (const Photon& photon : batch) {
            if (!photon.caustic) {
                EXPECT_FALSE(caustic_only) << "a photon that is no caustic";
                continue;
            }
            EXPECT_NE(photon.path_class, static_cast<uint8_t>(PathClass::direct));
            ++sum.photons;
            sum.flux += static_cast<double>(photon.flux.average());
        }
    return sum;
}

// A lamp above a square of the material, and a wide matte ceiling.
template <class Material>
std::unique_ptr<World> below_a_lamp(const Material& material)
{
    SmallScene scene;
    scene.square(0.0f, 2.0f, scene.material(material));
    scene.square(4.0f, 20.0f, scene.material(scene::DiffuseMaterial{}));
    scene.light(scene::SpotLight{scene::SpectrumSource(scene::Constant{1.0f}), Vec3(0, 0, 2), Vec3(0, 0, 0)});
    return scene.world();
}

void both_passes_agree(const World& world)
{
    const CausticLight global = caustic_light(world, false);
    const CausticLight alone = caustic_light(world, true);
    ASSERT_GT(global.photons, 1000);
    EXPECT_NEAR(alone.flux / global.flux, 1.0, 5.0 / std::sqrt(static_cast<double>(global.photons)));
}

// Both kinds of passes feed one caustic map, so they must agree on what a caustic is: the mirror reflection of a smooth
// coat makes one, though the coat's base scatters, and polished metal does.
TEST(PhotonTracing, FindsTheCausticsOfCoatsInCausticPassesToo)
{
    both_passes_agree(*below_a_lamp(scene::CoatedDiffuseMaterial{}));
}

// Metal of roughness alpha: all of what it throws on the ceiling where it is smooth, ever less where it is rougher, and
// what is almost smooth is as what is.
TEST(PhotonTracing, SharesOutCausticsByTheDensityOfLobes)
{
    double before = 0.0;
    for (const float alpha : {0.0f, 0.002f, 0.1f, 0.2f, 0.3f}) {
        scene::ConductorMaterial metal;
        metal.roughness = {scene::FloatInput(alpha), scene::FloatInput(alpha)};
        metal.remap_roughness = false;
        const auto world = below_a_lamp(metal);
        both_passes_agree(*world);
        const double flux = caustic_light(*world, false).flux;
        if (alpha == 0.002f) {
            EXPECT_NEAR(flux / before, 1.0, 0.01);
        } else if (alpha > 0.0f) {
            EXPECT_LT(flux, 0.95 * before) << alpha;
        }
        before = flux;
    }
    EXPECT_GT(before, 0.0);
}

TEST(PhotonTracing, PathsBeyondFourThousandMillionsAreNotThoseBefore)
{
    constexpr int64_t upper = int64_t(1) << 32;
    int equal = 0;
    for (const int64_t path : {int64_t(0), int64_t(1), int64_t(77)})
        for (const int64_t later : {upper, 2 * upper, 3 * upper}) {
            RandomStream first = light_path_stream(1, 2, path), second = light_path_stream(1, 2, path + later);
            for (int i = 0; i < 10; ++i) equal += first.next() == second.next();
        }
    EXPECT_LE(equal, 1);
    // Near ones stay points of one sequence: each half of the unit interval gets exactly half of them.
    int low = 0;
    for (int64_t path = upper; path < upper + 64; ++path) low += light_path_stream(1, 2, path).next() < 0.5f;
    EXPECT_EQ(low, 32);
}

}  // namespace
}  // namespace dapple
