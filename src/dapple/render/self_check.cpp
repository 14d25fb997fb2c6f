// The white furnace: reflectance 1 everywhere, radiance 1 from everywhere, so radiance 1 at the camera, exactly.
#include "dapple/render/self_check.h"

#include "dapple/render/film_settings.h"
#include "dapple/render/render_job.h"
#include "dapple/render/scene_defaults.h"
#include "dapple/world/compile.h"

#include <fmt/format.h>

#include <cmath>
#include <exception>

namespace dapple {
namespace {

constexpr int image_size = 16;
constexpr double tolerance = 0.02;
constexpr uint32_t passes = 512;        // a standard deviation of 0.3 % with light tracing, the noisiest here
constexpr uint32_t photon_passes = 16;  // passes with photon maps take longer and have less noise

scene::Description furnace(float reflectance)
{
    scene::Description description;
    description.film.resolution = description.film.crop_max = Int2(image_size, image_size);
    description.camera.fov = 20.0f;
    description.materials.resize(1);
    description.materials[0].kind = scene::DiffuseMaterial{scene::SpectrumInput(reflectance)};

    scene::Shape ball;
    ball.geometry = scene::Sphere{};
    const Matrix4 place =
        translation(Vec3(0, 0, 8));  // the camera looks along +z; the ball covers about half of the image
    ball.world_from_object = {place, place, 0.0f, 1.0f};
    ball.name = "sphere";
    description.shapes.push_back(ball);

    scene::InfiniteLight sky;
    sky.radiance = scene::SpectrumSource(scene::White{});
    scene::Light light;
    light.kind = sky;
    description.lights.push_back(light);
    return description;
}

double mean_luminance(const IntegratorEntry& entry, const scene::Description& description)
{
    const std::unique_ptr<World> world = compile(description);
    Film film(film_settings(description, *world, LayerChoice::parse("beauty"), false, ColorModel::rgb));
    Settings settings(entry.settings);
    // Blur by a number of pixels is meant for larger pictures than this one.
    for (const SettingInfo& info : entry.settings)
        if (info.name == "radius") settings.set("radius", "0.5");
    const std::unique_ptr<Integrator> integrator = entry.create(*world, settings);
    const std::unique_ptr<Progress> progress = make_progress(ProgressKind::none);
    const StopRequests requests;
    const RenderResult result = run(RenderJob{*world, *integrator, film, std::string(entry.name), 0,
                                              StopRule{entry.photon_layers ? photon_passes : passes, 0}},
                                    requests, *progress);
    double sum = 0;
    for (int y = 0; y < image_size; ++y)
        for (int x = 0; x < image_size; ++x)
            sum += (result.image.at(x, y, 0) + result.image.at(x, y, 1) + result.image.at(x, y, 2)) / 3.0;
    return sum / (image_size * image_size);
}

SelfCheck check(const IntegratorEntry& entry)
{
    SelfCheck result{"white furnace with " + std::string(entry.name), "", false};
    try {
        const double found = mean_luminance(entry, furnace(1.0f));
        // The same picture without the ball: the sky alone.
        scene::Description sky = furnace(1.0f);
        sky.shapes.clear();
        const double expected = mean_luminance(entry, sky);
        result.detail = fmt::format("{:.4f}, sky {:.4f}", found, expected);
        result.passed = expected > 0 && std::abs(found / expected - 1) < tolerance;
    } catch (const std::exception& error) {
        result.detail = error.what();
    }
    return result;
}

}  // namespace

std::vector<SelfCheck> run_self_checks()
{
    std::vector<SelfCheck> checks;
    for (const IntegratorEntry& entry : integrator_registry()) checks.push_back(check(entry));
    return checks;
}

}  // namespace dapple
