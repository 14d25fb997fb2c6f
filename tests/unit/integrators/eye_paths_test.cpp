// What the film asks of eye paths: the space of the guides, and paths without jitter.
#include "../transport/small_scene.h"

#include "dapple/film/film.h"
#include "dapple/integrators/integrator.h"
#include "dapple/integrators/pixel_loop.h"

#include <algorithm>

namespace dapple {
namespace {

using test::SmallScene;

// A floor at z = 0, seen aslant by a camera whose transform turns, scales and mirrors.
SmallScene floor_seen_aslant()
{
    SmallScene scene;
    scene.square(0.0f, 50.0f, scene.material(scene::DiffuseMaterial{}));
    scene.light(scene::InfiniteLight{scene::SpectrumSource(scene::Constant{1.0f}), {}, {}, {}});
    scene.description.film.resolution = Int2(4, 4);
    const Matrix4 place = translation(Vec3(0.5f, -1.0f, 6.0f)) * rotation(160.0f, Vec3(1.0f, 0.3f, 0.2f)) *
                          scaling(Vec3(-2.0f, 2.0f, 2.0f));
    scene.description.camera.world_from_camera = {place, place};
    scene.description.camera.fov = 20.0f;
    return scene;
}

struct Guide {
    Vec3 normal, position;
    float depth;
};

std::vector<Guide> guides_of(const World& world, FilmSettings settings, uint32_t first_pass, uint32_t passes)
{
    const IntegratorEntry& entry = find_integrator("path");
    const std::unique_ptr<Integrator> path = entry.create(world, Settings(entry.settings));
    settings.resolution = settings.crop_max = world.camera.resolution;
    settings.color_model = ColorModel::rgb;
    settings.class_layers = false;
    settings.sensor = make_sensor("cie1931", "srgb", 0.0f, 1.0f);
    Film film(settings);
    Statistics statistics;
    for (uint32_t pass = first_pass; pass < first_pass + passes; ++pass) {
        path->render_pass(PassContext{world, 1, pass, statistics}, film);
        film.end_pass();
    }
    std::vector<std::string> names;
    const Image layers = film.layers(names);
    const auto channel = [&](int x, int y, const char* name) {
        const auto found = std::find(names.begin(), names.end(), name);
        EXPECT_NE(found, names.end()) << name;
        return layers.at(x, y, static_cast<int>(found - names.begin()));
    };
    const auto triple = [&](int x, int y, const std::string& name) {
        return Vec3(channel(x, y, (name + ".X").c_str()), channel(x, y, (name + ".Y").c_str()),
                    channel(x, y, (name + ".Z").c_str()));
    };
    std::vector<Guide> guides;
    for (int y = 0; y < layers.height; ++y)
        for (int x = 0; x < layers.width; ++x)
            guides.push_back({triple(x, y, "N"), triple(x, y, "P"), channel(x, y, "Z")});
    return guides;
}

TEST(Guides, AreInTheSpaceAskedFor)
{
    const SmallScene scene = floor_seen_aslant();
    const auto world = scene.world();
    const Transform camera = world->camera.world_from_camera.start();
    FilmSettings settings;
    const std::vector<Guide> in_world = guides_of(*world, settings, 0, 3);
    settings.guides_in_camera_space = true;
    const std::vector<Guide> in_camera = guides_of(*world, settings, 0, 3);
    ASSERT_EQ(in_world.size(), 16u);
    for (size_t i = 0; i < in_world.size(); ++i) {
        EXPECT_LT(length(in_world[i].normal - Vec3(0, 0, 1)), 1e-5f);
        EXPECT_NEAR(in_world[i].position.z, 0.0f, 1e-5f);
        EXPECT_LT(length(in_camera[i].position - camera.inverse().point(in_world[i].position)), 1e-4f);
        EXPECT_EQ(in_camera[i].position.z, in_camera[i].depth);
        EXPECT_EQ(in_camera[i].depth, in_world[i].depth);
        // The axes of the camera are orthogonal and equally long: a normal's components lie along them.
        const Vec3 along(dot(camera.vector({1, 0, 0}), Vec3(0, 0, 1)), dot(camera.vector({0, 1, 0}), Vec3(0, 0, 1)),
                         dot(camera.vector({0, 0, 1}), Vec3(0, 0, 1)));
        EXPECT_LT(length(in_camera[i].normal - normalize(along)), 1e-5f);
        EXPECT_LT(in_camera[i].normal.z, -0.5f) << "the floor faces the camera";
    }
}

// Without jitter every pass sees what lies behind the middles of lens and pixel, at half time.
TEST(EyePaths, WithoutJitterAreAllTheSame)
{
    SmallScene scene = floor_seen_aslant();
    scene.description.camera.lens_radius = 0.2f;
    scene.description.camera.focal_distance = 1.0f;
    scene.description.camera.world_from_camera.end =
        translation(Vec3(1, 0, 0)) * scene.description.camera.world_from_camera.start;
    FilmSettings settings;
    const auto jittered = scene.world();
    EXPECT_GT(
        length(guides_of(*jittered, settings, 0, 1)[5].position - guides_of(*jittered, settings, 1, 1)[5].position),
        1e-3f);

    scene.description.options.disable_pixel_jitter = true;
    settings.pixel_centers = true;
    const auto world = scene.world();
    const std::vector<Guide> first = guides_of(*world, settings, 0, 1), second = guides_of(*world, settings, 1, 1);
    const Transform half = jittered->camera.world_from_camera.at(0.5f);
    for (int i = 0; i < 16; ++i) {
        EXPECT_EQ(first[i].position, second[i].position);
        // The camera sees [-1, 1] x [-1, 1] times tan 10 degrees at z = 1, y up.
        const float edge = std::tan(radians(10.0f));
        const Vec3 on_screen(edge * ((i % 4 + 0.5f) / 2.0f - 1.0f), edge * (1.0f - (i / 4 + 0.5f) / 2.0f), 1.0f);
        const Vec3 from = half.point(Vec3(0)), along = half.vector(on_screen);
        EXPECT_LT(length(first[i].position - (from - along * (from.z / along.z))), 1e-3f) << i;
    }
}

TEST(EyePaths, ShareTheirWavelengthsOnlyWhereAsked)
{
    const Wavelengths a = choose_wavelengths(ColorModel::spectral, 0.1f);
    const Wavelengths b = choose_wavelengths(ColorModel::spectral, 0.15f);
    EXPECT_NE(a.lambda[0], b.lambda[0]);
    const Wavelengths c = choose_wavelengths(ColorModel::fixed_spectral, 0.1f);
    const Wavelengths d = choose_wavelengths(ColorModel::fixed_spectral, 0.15f);
    EXPECT_EQ(c.model, ColorModel::spectral);
    for (int lane = 0; lane < Spectrum::lanes; ++lane) {
        EXPECT_EQ(c.lambda[lane], d.lambda[lane]);
        EXPECT_EQ(c.lambda[lane], Wavelengths::sample_visible(0.5f).lambda[lane]);
        EXPECT_TRUE(std::isfinite(1.0f / c.pdf[lane]));
    }
}

}  // namespace
}  // namespace dapple
