#include "support/render_scene.h"

#include "dapple/formats/pbrt.h"
#include "dapple/integrators/integrator.h"
#include "dapple/render/film_settings.h"
#include "dapple/render/scene_defaults.h"
#include "dapple/transport/walk.h"
#include "dapple/world/compile.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace dapple::testing {

TestScene::TestScene(scene::Description description, Int2 resolution)
    : description_(std::make_unique<scene::Description>(std::move(description)))
{
    if (resolution.x > 0) set_resolution(description_->film, resolution);
    world_ = compile(*description_);
}

TestScene TestScene::from_file(const std::filesystem::path& file, Int2 resolution)
{
    return TestScene(read_pbrt(file), resolution);
}

TestScene TestScene::from_text(const std::string& text, const std::filesystem::path& folder, Int2 resolution)
{
    return TestScene(read_pbrt_string(text, "test", folder), resolution);
}

bool TestScene::suits(const std::string& integrator) const
{
    return !world_->has_scattering_media || find_integrator(integrator).media;
}

bool TestScene::sees_delta(int x0, int x1, int y0, int y1) const
{
    for (int y = 4 * y0 - 4; y < 4 * y1 + 4; ++y)
        for (int x = 4 * x0 - 4; x < 4 * x1 + 4; ++x) {
            RandomStream random(1, 2, static_cast<uint32_t>(y * 8192 + x));
            Walk eye = start_at_camera(*world_, Vec2(x + 0.5f, y + 0.5f) * 0.25f, Wavelengths::rgb(), random);
            const Vertex* vertex = eye.next(*world_, random);
            if (vertex && vertex->on_surface && (vertex->is_delta() || vertex->has_delta_lobe())) return true;
        }
    return false;
}

Rendered TestScene::render(const RenderRequest& request) const
{
    const IntegratorChoice choice = choose_integrator(description_->integrator, request.integrator, request.settings);
    LayerChoice layers;
    if (!request.layers) layers = {false, false, false, false};
    Film film(film_settings(*description_, *world_, layers, choice.entry->photon_layers, request.color_model));
    const std::unique_ptr<Integrator> integrator = choice.entry->create(*world_, choice.settings);
    Statistics statistics;
    for (uint32_t pass = 0; pass < request.passes; ++pass) {
        integrator->render_pass({*world_, request.seed, pass, statistics, nullptr}, film);
        film.end_pass();
    }
    Rendered result;
    result.beauty = film.beauty();
    if (request.layers) result.layers = film.layers(result.channels);
    result.accidents = film.accidents().eye_sample + film.accidents().splat;
    return result;
}

std::vector<Image> TestScene::render_batches(const RenderRequest& request, int batches) const
{
    std::vector<Image> images;
    RenderRequest one = request;
    for (int i = 0; i < batches; ++i, ++one.seed) images.push_back(render(one).beauty);
    return images;
}

std::vector<std::string> integrator_names()
{
    std::vector<std::string> names;
    for (const IntegratorEntry& entry : integrator_registry()) names.emplace_back(entry.name);
    return names;
}

bool has_setting(const std::string& integrator, const std::string& setting)
{
    const auto table = find_integrator(integrator).settings;
    return std::any_of(table.begin(), table.end(), [&](const SettingInfo& info) { return info.name == setting; });
}

std::string read_text(const std::filesystem::path& file)
{
    std::ifstream in(file, std::ios::binary);
    if (!in) throw std::runtime_error("cannot read " + file.string());
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

}  // namespace dapple::testing
