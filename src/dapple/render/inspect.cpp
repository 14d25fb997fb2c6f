// A dry run in words.
#include "dapple/render/inspect.h"

#include "dapple/base/words.h"
#include "dapple/integrators/light_survey.h"
#include "dapple/render/duration.h"
#include "dapple/render/film_settings.h"
#include "dapple/render/memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string_view>

namespace dapple {
namespace {

constexpr size_t most_lights_shown = 20;
constexpr double least_caustics = 0.01;  // of all light: less, by a bead or a ring, is not spoken of
constexpr double many_caustics = 0.1;    // so many that path takes long even where it can meet the lamps

std::string_view kind_name(Light::Kind kind)
{
    static constexpr std::array<std::string_view, 8> names = {
        "point", "spot", "distant", "area", "infinite", "infinite (image)", "goniometric", "projection"};
    return names[static_cast<size_t>(kind)];
}

std::string group_name(const World& world, const Light& light)
{
    return light.group.value > 0 && light.group.value < world.light_group_names.size()
               ? world.light_group_names[light.group.value]
               : std::string();
}

// How many materials of each kind, by the order of scene::Material's variant.
std::string material_counts(const scene::Description& description)
{
    static constexpr std::array<std::string_view, 9> names = {"interface",     "diffuse",         "diffusetransmission",
                                                              "dielectric",    "thindielectric",  "conductor",
                                                              "coateddiffuse", "coatedconductor", "mix"};
    static_assert(std::variant_size_v<decltype(scene::Material::kind)> == names.size());
    std::map<std::string_view, int> counts;
    // [0] is the default material, there in every scene.
    for (size_t i = 1; i < description.materials.size(); ++i) ++counts[names[description.materials[i].kind.index()]];
    std::string text;
    for (const auto& [name, count] : counts) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, name);
    return text.empty() ? "none named" : text;
}

std::string medium_counts(const scene::Description& description)
{
    static constexpr std::array<std::string_view, 4> names = {"homogeneous", "uniformgrid", "rgbgrid", "nanovdb"};
    static_assert(std::variant_size_v<decltype(scene::Medium::kind)> == names.size());
    std::string text;
    for (const scene::Medium& medium : description.media)
        text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", medium.name, names[medium.kind.index()]);
    return text.empty() ? "none" : text;
}

std::string_view camera_name(scene::Camera::Kind kind)
{
    static constexpr std::array<std::string_view, 3> names = {"perspective", "orthographic", "spherical"};
    return names[static_cast<size_t>(kind)];
}

void add_lights(std::vector<std::string>& lines, const World& world)
{
    const std::vector<LightSummary> lights = summarise_lights(world);
    lines.push_back(fmt::format("lights        {} ({})", lights.size(), counted(world.lights.list.size(), "emitter")));
    for (size_t i = 0; i < std::min(lights.size(), most_lights_shown); ++i) {
        const LightSummary& light = lights[i];
        lines.push_back(fmt::format("  {:5.1f} % of photons, power {:.4g}: {}{}", 100 * light.share, light.power,
                                    light.what, light.group.empty() ? "" : ", group " + light.group));
    }
    if (lights.size() > most_lights_shown)
        lines.push_back(fmt::format("  and {} weaker ones", lights.size() - most_lights_shown));
}

// All that a render takes, and how --memory (check_memory) sees it.
void add_memory(std::vector<std::string>& lines, const MemoryAccount& account, const PassMemory& pass)
{
    const auto size = [](uint64_t bytes) { return format_size(static_cast<double>(bytes)); };
    const auto pass_bytes = static_cast<uint64_t>(pass.bytes);
    const bool shared = pass_bytes > 0;
    lines.push_back(
        fmt::format("memory        {}: program {}, geometry {}, ray tracing {}, textures {}, media {}, film {}{}{}",
                    size(account.total() + pass_bytes), size(account.program), size(account.geometry),
                    size(account.accelerator), size(account.textures), size(account.media), size(account.film),
                    shared ? fmt::format(", about {} for {}", size(pass_bytes), pass.of) : "",
                    account.points > 0 ? fmt::format(", kept for each pixel {}", size(account.points)) : ""));
    lines.push_back(fmt::format("  --memory must be above {}{}", size(account.total()),
                                shared ? fmt::format("; what is above is for {}", pass.of) : ""));
}

// Which algorithms find what there is to find: photons find caustics, and the registry says who gathers them and who
// knows media.
std::string what_suits(const World& world)
{
    const CausticShare share = caustic_share(world);
    const double percent = 100 * share.all;
    const bool caustics = share.all >= least_caustics;
    const bool beyond_path = share.all >= many_caustics || share.of_points >= least_caustics;
    std::string names, why = world.has_scattering_media ? "media scatter" : "";
    for (const IntegratorEntry& entry : integrator_registry())
        if (knows_media(entry, world) && (entry.photon_layers || !beyond_path))
            names.append(names.empty() ? "" : ", ").append(entry.name);
    if (caustics)
        why += fmt::format("{}{:.{}f} % of the light is caustics, of which path finds those of large lamps alone",
                           why.empty() ? "" : ", and ", percent, percent < 9.95 ? 1 : 0);
    return why.empty() ? "path: no caustics to speak of, no media that scatter" : names + ": " + why;
}

}  // namespace

bool knows_media(const IntegratorEntry& entry, const World& world) { return entry.media || !world.has_active_media(); }

std::vector<LightSummary> summarise_lights(const World& world)
{
    std::vector<LightSummary> summaries;
    std::vector<bool> taken(world.lights.list.size(), false);
    const auto add = [&](const std::string& what, uint32_t first, uint32_t count) {
        LightSummary summary{what, 0, 0, group_name(world, world.lights.list[first])};
        for (uint32_t i = first; i < first + count; ++i) {
            summary.power += power(world.lights, world.spectra, LightId(i));
            summary.share += world.light_probability(LightId(i));
            taken[i] = true;
        }
        summaries.push_back(summary);
    };
    for (uint32_t g = 0; g < world.geometries.size(); ++g) {
        const Geometry& geometry = world.geometries[g];
        if (!geometry.first_light.valid()) continue;
        const uint32_t count = geometry.is_mesh ? static_cast<uint32_t>(world.meshes[geometry.mesh].indices.size() / 3)
                                                : geometry.primitive_count;
        const std::string pieces =
            count > 1 ? fmt::format(" ({})", counted(count, geometry.is_mesh ? "triangle" : "piece")) : std::string();
        add("area light on " + world.name_of(g) + pieces, geometry.first_light.value, count);
    }
    for (uint32_t i = 0; i < world.lights.list.size(); ++i)
        if (!taken[i]) add(std::string(kind_name(world.lights.list[i].kind)) + " light", i, 1);
    std::stable_sort(summaries.begin(), summaries.end(),
                     [](const LightSummary& a, const LightSummary& b) { return a.share > b.share; });
    return summaries;
}

std::vector<std::string> inspect(const scene::Description& description, const World& world, const CompileReport& report,
                                 const IntegratorChoice& choice, const Integrator* integrator)
{
    std::vector<std::string> lines;
    const scene::Film& film = description.film;
    const Int2 crop = film.crop_max - film.crop_min;
    const FilmSettings settings =
        film_settings(description, world, LayerChoice(), choice.entry->photon_layers, ColorModel::spectral);

    lines.push_back(fmt::format("film          {}x{}{}, sensor {}, ISO {:g}, to {}", film.resolution.x,
                                film.resolution.y,
                                crop != film.resolution ? fmt::format(" (crop {}x{})", crop.x, crop.y) : std::string(),
                                film.sensor, film.iso, film.filename));
    lines.push_back(fmt::format("camera        {}{}, shutter {:g} s to {:g} s", camera_name(description.camera.kind),
                                description.camera.lens_radius > 0 ? " with lens" : "", description.camera.shutter_open,
                                description.camera.shutter_close));
    lines.push_back(fmt::format("integrator    {} (the scene says {}), {} unless --passes or --time",
                                choice.entry->name, description.integrator.name,
                                counted(static_cast<uint64_t>(description.sampler.pixel_samples), "pass")));
    lines.push_back(fmt::format("geometry      {}, {}; {} {} and {} other {} stored, {}",
                                counted(description.shapes.size(), "shape"),
                                counted(description.objects.size(), "object"), format_count(report.triangles),
                                plural(report.triangles, "triangle"), format_count(report.other_primitives),
                                plural(report.other_primitives, "primitive"), counted(report.instances, "instance")));
    lines.push_back("materials     " + material_counts(description));
    lines.push_back("media         " + medium_counts(description));
    add_lights(lines, world);
    lines.push_back("suits         " + what_suits(world));
    Statistics statistics;
    add_memory(lines, memory_account(report, settings, *choice.entry),
               integrator ? integrator->pass_memory({world, 0, 0, statistics}, settings) : PassMemory());
    lines.push_back(fmt::format(
        "compiling     {:.2f} s: textures {:.2f} s, shapes {:.2f} s, ray tracing {:.2f} s, lights {:.2f} s",
        report.seconds_textures + report.seconds_shapes + report.seconds_accelerator + report.seconds_lights,
        report.seconds_textures, report.seconds_shapes, report.seconds_accelerator, report.seconds_lights));
    return lines;
}

}  // namespace dapple
