// What compiling makes of the scene's corner cases.
#include "../transport/small_scene.h"

namespace dapple {
namespace {

using test::SmallScene;

TEST(Compile, IgnoresAreaLightsOnInterfaces)
{
    SmallScene scene;
    scene.square(0.0f, 1.0f, scene.material(scene::InterfaceMaterial{}));
    scene.emit();
    const auto world = scene.world();
    EXPECT_TRUE(world->lights.list.empty());
    EXPECT_FALSE(world->geometries[0].first_light.valid());
}

TEST(Compile, MakesABoundaryOnlyBetweenDifferentMedia)
{
    SmallScene scene;
    const scene::MaterialIndex grey = scene.material(scene::DiffuseMaterial{});
    const scene::MediumIndex fog = scene.absorber(scene::SpectrumSource(scene::Constant{0.1f}));
    scene.square(0.0f, 1.0f, grey).medium_interface = true;  // vacuum on both sides
    scene::Shape& surface = scene.square(1.0f, 1.0f, grey);
    surface.medium_interface = true;
    surface.inside = fog;
    const auto world = scene.world();
    // A ray in fog stays there beyond the first, whatever the scene says, and leaves it above the second.
    EXPECT_EQ(world->medium_beyond(0, true, MediumId(0u)), MediumId(0u));
    EXPECT_EQ(world->medium_beyond(1, true, MediumId(0u)), MediumId());
    EXPECT_EQ(world->medium_beyond(1, false, MediumId()), MediumId(0u));
}

}  // namespace
}  // namespace dapple
