// The option of pbrt's weights reaches the scattering functions of coats, and of nothing else.
#include "dapple/scene/description.h"
#include "dapple/world/compile.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

TEST(Coats, TakeTheWeightsThatTheOptionsAskFor)
{
    scene::Description description;
    for (const auto& kind : {decltype(scene::Material::kind)(scene::CoatedDiffuseMaterial{}),
                             decltype(scene::Material::kind)(scene::CoatedConductorMaterial{}),
                             decltype(scene::Material::kind)(scene::DiffuseMaterial{})}) {
        scene::Material material;
        material.kind = kind;
        description.materials.push_back(material);
    }
    for (const bool as_pbrt : {false, true}) {
        description.options.pbrt_coat_weights = as_pbrt;
        const std::unique_ptr<World> world = compile(description);
        const auto weights = [&](uint32_t material) {
            return make_bsdf(world->materials, world->spectra, MaterialId(material), SurfacePoint(),
                             Wavelengths::sample_visible(0.5f), 0)
                .pbrt_coat_weights;
        };
        EXPECT_EQ(weights(0), as_pbrt);
        EXPECT_EQ(weights(1), as_pbrt);
        EXPECT_FALSE(weights(2));
    }
}

}  // namespace
}  // namespace dapple
