// Small pictures of small scenes, where the integrators must agree.
#include "../transport/small_scene.h"

#include "dapple/film/film.h"
#include "dapple/integrators/integrator.h"

namespace dapple {
namespace {

using test::SmallScene;
using Definitions = std::vector<std::pair<std::string, std::string>>;

// The mean over the picture of all channels.
double mean_of_render(const World& world, std::string_view integrator, const Definitions& definitions, uint32_t passes)
{
    const IntegratorEntry& entry = find_integrator(integrator);
    Settings settings(entry.settings);
    for (const auto& [name, value] : definitions) settings.set(name, value);
    const std::unique_ptr<Integrator> algorithm = entry.create(world, settings);
    FilmSettings film_settings;
    film_settings.resolution = film_settings.crop_max = world.camera.resolution;
    film_settings.color_model = ColorModel::rgb;
    film_settings.sensor = make_sensor("cie1931", "srgb", 0.0f, 1.0f);
    Film film(film_settings);
    Statistics statistics;
    for (uint32_t pass = 0; pass < passes; ++pass) {
        algorithm->render_pass(PassContext{world, 1, pass, statistics}, film);
        film.end_pass();
    }
    EXPECT_EQ(film.accidents().eye_sample, 0u);
    const Image image = film.beauty();
    double sum = 0.0;
    for (const float value : image.pixels) sum += static_cast<double>(value);
    return sum / static_cast<double>(image.pixels.size());
}

SmallScene scene_seen_from_above(int resolution)
{
    SmallScene scene;
    scene.description.film.resolution = Int2(resolution, resolution);
    // Camera at z = 4, looking down.
    Matrix4 down;
    down.m[1][1] = down.m[2][2] = -1.0;
    down.m[2][3] = 4.0;
    scene.description.camera.world_from_camera = {down, down};
    scene.description.camera.fov = 40.0f;
    return scene;
}

// The sky mirrored in a smooth coat is light seen through a delta lobe: every integrator must show it, though the
// surface as a whole is not a delta.
TEST(Integrators, ShowTheSkyMirroredInACoat)
{
    SmallScene scene = scene_seen_from_above(8);
    scene::CoatedDiffuseMaterial varnish;
    varnish.reflectance = scene::SpectrumInput(0.0f);
    scene.square(0.0f, 20.0f, scene.material(varnish));
    scene.light(scene::InfiniteLight{scene::SpectrumSource(scene::Constant{1.0f}), {}, {}, {}});
    const auto world = scene.world();
    const double path = mean_of_render(*world, "path", {}, 256);
    ASSERT_GT(path, 0.0);
    EXPECT_NEAR(mean_of_render(*world, "lightpath", {}, 256) / path, 1.0, 0.1);
    const Definitions shown = {{"finalgather", "false"}, {"photons", "1000"}};
    const Definitions gathered = {{"photons", "1000"}, {"gatherrays", "1"}};
    EXPECT_NEAR(mean_of_render(*world, "photonmap", shown, 256) / path, 1.0, 0.1);
    EXPECT_NEAR(mean_of_render(*world, "photonmap", gathered, 256) / path, 1.0, 0.1);
}

// What a smooth coat mirrors is missed by estimates from photons on it: gather rays must go on by its delta lobe. A
// floor under a sky, before a black wall whose varnish mirrors the floor and a white wall.
TEST(Integrators, GatherWhatACoatMirrors)
{
    SmallScene scene = scene_seen_from_above(8);
    const auto wall = [&](float x, scene::MaterialIndex material) {
        scene::MeshData data;
        data.positions = {{x, -4, 0}, {x, 4, 0}, {x, 4, 2}, {x, -4, 2}};
        data.triangles = {0, 1, 2, 0, 2, 3};
        scene.shape(scene::Mesh{std::make_shared<scene::MeshData>(std::move(data))}, material);
    };
    scene::CoatedDiffuseMaterial varnish;
    varnish.reflectance = scene::SpectrumInput(0.0f);
    varnish.coat.eta = scene::SpectrumSource(scene::Constant{3.0f});
    const auto white = scene.material(scene::DiffuseMaterial{scene::SpectrumInput(0.8f)});
    scene.square(0.0f, 4.0f, white);
    wall(-1.0f, scene.material(varnish));
    wall(1.0f, white);
    scene.light(scene::InfiniteLight{scene::SpectrumSource(scene::Constant{1.0f}), {}, {}, {}});
    const auto world = scene.world();
    const double path = mean_of_render(*world, "path", {}, 6000);
    const Definitions few = {{"photons", "20000"}, {"epoch", "4"}};
    for (const char* name : {"photonmap", "irradiancecache"})
        EXPECT_NEAR(mean_of_render(*world, name, few, 256) / path, 1.0, 0.01) << name;
}

// Irradiance made beforehand lies where photons are: on the bright side of a thin wall, when its dim side is asked for.
TEST(Integrators, KeepLightBehindAWall)
{
    SmallScene scene;
    scene.description.film.resolution = Int2(8, 8);
    // Camera at (0, 0, 1), looking along x at a wall that sees the floor.
    Matrix4 along_x;
    along_x.m = {{{0, 0, 1, 0}, {1, 0, 0, 0}, {0, 1, 0, 1}, {0, 0, 0, 1}}};
    scene.description.camera.world_from_camera = {along_x, along_x};
    scene.description.camera.fov = 60.0f;
    const auto matte = scene.material(scene::DiffuseMaterial{scene::SpectrumInput(0.7f)});
    scene.square(0.0f, 4.0f, matte);
    for (const float x : {-0.8f, 1.5f}) {
        scene::MeshData data;
        data.positions = {{x, -4, 0}, {x, 4, 0}, {x, 4, 3}, {x, -4, 3}};
        data.triangles = {0, 1, 2, 0, 2, 3};
        scene.shape(scene::Mesh{std::make_shared<scene::MeshData>(std::move(data))}, matte);
    }
    for (const auto& [x, power] : {std::pair(-1.2f, 30.0f), std::pair(0.3f, 1.0f)}) {
        scene::PointLight lamp;
        lamp.from = Vec3(x, 0.0f, 0.5f);
        scene.light(lamp).power = power;
    }
    const auto world = scene.world();
    const double sppm = mean_of_render(*world, "sppm", {}, 64);
    const Definitions few = {{"photons", "20000"}, {"epoch", "1"}};
    EXPECT_NEAR(mean_of_render(*world, "photonmap", few, 64) / sppm, 1.0, 0.06);
}

}  // namespace
}  // namespace dapple
