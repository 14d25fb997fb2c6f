// What compiling makes of the scene's corner cases.
#include "../transport/small_scene.h"

#include "dapple/base/log.h"

#include <algorithm>

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

// The tangents of a mesh turn with its shape and with the instance it is part of.
TEST(Compile, PlacesTheTangentsOfMeshes)
{
    SmallScene scene;
    scene::ConductorMaterial brushed;
    brushed.roughness = {scene::FloatInput(0.1f), scene::FloatInput(0.4f)};
    scene::MeshData data;
    data.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}};
    data.triangles = {0, 1, 2};
    data.tangents = {{3, 1, 0}, {3, 1, 0}, {3, 1, 0}};
    scene::Shape& shape =
        scene.shape(scene::Mesh{std::make_shared<scene::MeshData>(std::move(data))}, scene.material(brushed));
    const Matrix4 turned = rotation(90.0f, Vec3(0, 0, 1));
    shape.world_from_object = {turned, turned};
    const Vec3 expected = normalize(Vec3(-1, 3, 0));
    const auto tangent = [&](const Vec3& origin) {
        const auto world = scene.world();
        const Ray ray{origin, Vec3(0, 0, -1), 0.0f};
        Hit hit;
        EXPECT_TRUE(world->intersect(ray, infinity, hit));
        return world->surface_point(ray, hit).dpdu_shading;
    };
    EXPECT_LT(length(tangent(Vec3(0.2f, 0.3f, 1)) - expected), 1e-5f);
    // A moving shape is placed by an instance.
    shape.world_from_object.end = translation(Vec3(4, 0, 0)) * turned;
    EXPECT_LT(length(tangent(Vec3(0.2f, 0.3f, 1)) - expected), 1e-5f);
}

TEST(Compile, SaysThatPortalsAreNotUsed)
{
    SmallScene scene;
    scene::InfiniteLight sky{scene::SpectrumSource(scene::Constant{1.0f}), {}, {}, {}};
    sky.portal = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    scene.light(sky).at.line = 77;
    const auto world = scene.world();
    ASSERT_EQ(world->environments.size(), 1u);
    const std::vector<std::string> warnings = logged_warnings();
    EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(), [](const std::string& warning) {
        return warning.find("77") != warning.npos && warning.find("'portal'") != warning.npos;
    }));
    // The sky is seen whole, from any place.
    EXPECT_FALSE(
        emitted_environment(world->lights, world->spectra, world->environments[0], Vec3(0, 0, -1), Wavelengths::rgb())
            .is_black());
}

// Without jitter the shutter is open for a moment only.
TEST(Compile, HoldsTheSceneStillWithoutPixelJitter)
{
    SmallScene scene;
    scene::Shape& shape = scene.square(0.0f, 1.0f, scene.material(scene::DiffuseMaterial{}));
    shape.world_from_object.end = translation(Vec3(0, 0, 3));
    EXPECT_EQ(scene.world()->instances.size(), 1u);
    scene.description.options.disable_pixel_jitter = true;
    const auto world = scene.world();
    EXPECT_TRUE(world->instances.empty());
    Hit hit;
    ASSERT_TRUE(world->intersect(Ray{Vec3(0.2f, 0.3f, 4), Vec3(0, 0, -1), 0.9f}, infinity, hit));
    EXPECT_FLOAT_EQ(hit.t, 2.5f);
}

}  // namespace
}  // namespace dapple
