// Bidirectional path tracing, and its union with photon mapping: vertex connection and merging.
// Lafortune and Willems 1993, "Bi-directional path tracing"; Veach 1997, chapter 10; Georgiev, Krivanek, Davidovic,
// Slusallek 2012, "Light transport simulation with vertex connection and merging"; Hachisuka, Pantaleoni, Jensen 2012,
// "A path space extension for robust light transport simulation".
//
// In each pass light subpaths are traced and stored once (light_subpaths.h). The eye path of a pixel is then joined, at
// each vertex that is no delta, to a point of a light (s = 1), to the vertices of the light path of its pixel
// (s, t >= 2) and, in vcm, merged with all light vertices within a radius; light vertices are joined to the camera
// (t = 1), and eye paths that meet lights count too (s = 0). All are weighed against each other by multiple importance
// sampling (subpath_weights.h).
//
// lightpath is the camera's technique alone (Dutre, Lafortune, Willems 1993, "Monte Carlo light tracing with direct
// computation of pixel intensities"): it finds LS*DE caustics, and cannot see anything in or through a delta surface
// but lights (L S* E, by one eye path per pixel and pass); nothing is stored. bdpt: unbiased; error falls as N^-1 in
// MSE. vcm: the radius is a number of pixel footprints and shrinks as r_i^2 = r_1^2 Gamma(i + a) / (Gamma(1 + a)
// Gamma(i + 1)), a = 2/3: consistent, the blur of merging vanishes. Media: joined as surfaces are, not merged. Light
// that media emit is found by eye paths alone.
//
// What is worth little is left to chance, without bias: joins that would bring less than a share of what the eye path
// has found so far, before their shadow ray; both kinds of paths, by what the coming scattering will leave of them,
// before their next ray. Cost: a shadow ray per pair of vertices at most; 128 bytes per light vertex (270 where it is
// neither diffuse nor in a medium), and 80 more in vcm.
#include "dapple/integrators/bidirectional_path.h"

#include "dapple/base/error.h"
#include "dapple/base/log.h"
#include "dapple/density/schedule.h"
#include "dapple/integrators/registry.h"

#include <fmt/format.h>

namespace dapple {
namespace {

constexpr SettingInfo max_depth_setting = {"maxdepth", "scatterings", "100", "integer >= 0 and < 60000",
                                           "longest path, in scatterings on surfaces and in media"};
constexpr SettingInfo light_paths_setting = {"lightpaths", "light paths", "auto", "> 0",
                                             "light paths per pass; auto: one per pixel of the full image, 1M at most"};
constexpr SettingInfo heuristic_setting = {"heuristic", "", "balance", "balance|power",
                                           "how techniques are weighed against each other"};

constexpr SettingInfo memory_setting = {"memory", "bytes", "auto", "> 0",
                                        "ceiling for the light vertices of a pass: fewer light paths rather than more"};

constexpr SettingInfo lightpath_settings[] = {
    max_depth_setting,
    {"particles", "particles", "auto", "> 0", "particles per pass; auto: one per pixel of the full image"},
};

constexpr SettingInfo bdpt_settings[] = {max_depth_setting, light_paths_setting, heuristic_setting, memory_setting};

constexpr SettingInfo vcm_settings[] = {
    max_depth_setting,
    light_paths_setting,
    heuristic_setting,
    memory_setting,
    {"techniques", "", "vcm", "vcm|bpm|ppm|bdpt|lightpath",
     "vcm: all; bpm: merging at every vertex and lights met; ppm: merging at the first vertex alone; bdpt: no merging; "
     "lightpath: the camera seen from light vertices"},
    {"radius", "pixels", "2", "> 0", "merging radius of the first pass, in pixel footprints"},
    {"fixedradius", "scene units", "auto", "> 0", "merging radius of the first pass; auto: from the footprint"},
    {"kernel", "", "epanechnikov", "constant|cone|gaussian|epanechnikov|silverman", "kernel of merging"},
    {"wavelengthsets", "sets", "4", ">= 1", "sets of four wavelengths per pass (spectral colour model)"},
};

BidirectionalPlan plan_of(std::string_view techniques, bool power, const Settings& settings)
{
    BidirectionalPlan plan;
    plan.merging = techniques == "vcm" || techniques == "bpm" || techniques == "ppm";
    plan.first_vertex_only = techniques == "ppm" || techniques == "lightpath";
    plan.max_depth = static_cast<int>(settings.integer("maxdepth"));
    MisRules& rules = plan.rules;
    rules.power = power;
    // Where eye paths end with their first vertex, lights are only met through deltas, where nothing competes.
    rules.emission = !plan.first_vertex_only;
    rules.direct = rules.inner = techniques == "vcm" || techniques == "bdpt";
    rules.camera = rules.direct || techniques == "lightpath";
    return plan;
}

class Bidirectional final : public Integrator {
public:
    // paths_setting: where the number of light paths is. memory: of light vertices [bytes], 0: no ceiling.
    Bidirectional(const BidirectionalPlan& plan, const Settings& settings, std::string_view paths_setting,
                  int64_t memory)
        : plan_(plan),
          paths_setting_(paths_setting),
          light_paths_(settings.integer_or(paths_setting, 0)),
          memory_(memory)
    {
    }

    void set_merging(const Settings& settings)
    {
        plan_.kernel = kernel_named(settings.word("kernel"));
        radius_pixels_ = static_cast<float>(settings.number("radius"));
        fixed_radius_ = static_cast<float>(settings.number_or("fixedradius", 0.0));
        wavelength_sets_ = static_cast<int>(settings.integer("wavelengthsets"));
    }

    void render_pass(const PassContext& context, Film& film) override
    {
        const ColorModel model = film.settings().color_model;
        const LightSubpathPlan light = light_plan(context, film.settings());
        BidirectionalPlan plan = plan_;
        plan.rules = light.rules;
        const LightSubpaths subpaths(context, model, film.resolution(), light,
                                     [&](const LightSubpaths& so_far, int64_t path, const LightArrival& vertex) {
                                         if (plan.rules.camera)
                                             splat_light_vertex(context, film, plan, so_far, path, vertex);
                                     });
        if (context.cancelled()) return;
        for_each_pixel(
            context, film,
            [&](Int2 pixel, RandomStream&) { return subpaths.start(subpaths.path_of(pixel)).wavelengths; },
            [&](EyeSample& sample) { BidirectionalEyePath(plan, context.world, subpaths, sample).trace(); });
    }

    bool record_techniques(TechniqueFilms& films) override
    {
        plan_.techniques = &films;
        return true;
    }

    // Merging blurs over the square of its radius.
    double bias_scale(uint32_t pass) const override
    {
        return plan_.merging ? progressive_shrinkage(int64_t(pass) + 1) : 0.0;
    }

    PassMemory pass_memory(const PassContext& context, const FilmSettings& film) const override
    {
        if (!plan_.stores()) return {};
        LightSubpathPlan pilot = light_plan(context, film);
        const int64_t paths = pilot.paths;
        pilot.paths = std::min<int64_t>(paths, 8192);
        const LightSubpaths subpaths(context, film.color_model, film.resolution, pilot,
                                     [](const LightSubpaths&, int64_t, const LightArrival&) {});
        const double share = static_cast<double>(paths) / static_cast<double>(pilot.paths);
        return {share * static_cast<double>(subpaths.memory_bytes()), "light paths"};
    }

    // Where no vertices are kept, short passes are as good as long ones.
    std::vector<Effort> efforts(const PassContext& context, const FilmSettings& film) const override
    {
        return {{paths_setting_, "light paths per pass", light_plan(context, film).paths, 8192,
                 plan_.stores() ? 1.0 / 3 : 0.05}};
    }

    std::vector<std::string> report() const override
    {
        std::vector<std::string> lines;
        lines.push_back(light_paths_ > 0 ? fmt::format("light paths per pass: {}", light_paths_)
                                         : std::string("light paths per pass: one per pixel") +
                                               (plan_.stores() ? ", 1M at most" : ""));
        if (plan_.merging)
            lines.push_back(fixed_radius_ > 0.0f
                                ? fmt::format("photons within {} scene units in the first pass", fixed_radius_)
                                : fmt::format("photons within {} px in the first pass", radius_pixels_));
        return lines;
    }

private:
    LightSubpathPlan light_plan(const PassContext& context, const FilmSettings& film) const
    {
        LightSubpathPlan light;
        light.stored = plan_.stores();
        const int64_t pixels = int64_t(film.resolution.x) * film.resolution.y;
        light.paths = light_paths_ > 0 ? light_paths_ : light.stored ? std::min(pixels, most_paths) : pixels;
        if (light.stored && memory_ > 0) light.paths = std::clamp<int64_t>(memory_ / bytes_per_path, 1, light.paths);
        const bool jitters = film.color_model == ColorModel::spectral;
        light.wavelength_sets = !plan_.merging ? 0 : jitters ? wavelength_sets_ : 1;
        light.max_depth = plan_.max_depth;
        light.merging = plan_.merging;
        light.merges_everywhere = !plan_.first_vertex_only;
        if (plan_.merging) {
            const MergeRadius first = fixed_radius_ > 0.0f
                                          ? MergeRadius::fixed(fixed_radius_)
                                          : MergeRadius::footprints(context.world.camera, radius_pixels_);
            light.radius = first * static_cast<float>(std::sqrt(progressive_shrinkage(int64_t(context.pass) + 1)));
        }
        light.rules = plan_.rules;
        // Splats are filtered: they would be another measurement than eye paths through the middle of each pixel.
        if (film.pixel_centers && plan_.rules.direct) light.rules.camera = false;
        light.rules.light_paths = static_cast<double>(light.paths);
        return light;
    }

    // Where nothing else is said: light vertices take about as much memory as a film of this size.
    static constexpr int64_t most_paths = 1'000'000;
    // Eight vertices, more than any but the brightest scenes have.
    static constexpr int64_t bytes_per_path = 8 * (sizeof(LightVertex) + sizeof(MergePhoton) + sizeof(Bsdf) + 32);

    BidirectionalPlan plan_;
    std::string_view paths_setting_;
    int64_t light_paths_;  // 0: from the image
    int64_t memory_;       // [bytes], 0: no ceiling
    float radius_pixels_ = 1.0f;
    float fixed_radius_ = 0.0f;  // [m], 0: from the footprint
    int wavelength_sets_ = 0;
};

void warn_of_emitting_media(const World& world)
{
    if (world.has_emitting_media)
        log_warning("the light of emitting media is found by eye paths alone: no light paths start in them");
}

std::unique_ptr<Integrator> create_lightpath(const World& world, const Settings& settings)
{
    if (world.has_emitting_media)
        log_warning("lightpath leaves out the light of emitting media: no particles start in them; use path");
    return std::make_unique<Bidirectional>(plan_of("lightpath", false, settings), settings, "particles", 0);
}

std::unique_ptr<Bidirectional> create_stored(const World& world, std::string_view techniques, const Settings& settings)
{
    warn_of_emitting_media(world);
    return std::make_unique<Bidirectional>(plan_of(techniques, settings.word("heuristic") == "power", settings),
                                           settings, "lightpaths", settings.integer_or("memory", 0));
}

std::unique_ptr<Integrator> create_bdpt(const World& world, const Settings& settings)
{
    return create_stored(world, "bdpt", settings);
}

std::unique_ptr<Integrator> create_vcm(const World& world, const Settings& settings)
{
    const std::string_view techniques = settings.word("techniques");
    if (world.has_scattering_media && (techniques == "ppm" || techniques == "bpm"))
        throw UserError(
            fmt::format("techniques={} merges on surfaces alone, and this scene has media that scatter: use "
                        "techniques=vcm, or bdpt",
                        techniques));
    std::unique_ptr<Bidirectional> vcm = create_stored(world, techniques, settings);
    vcm->set_merging(settings);
    return vcm;
}

}  // namespace

extern const IntegratorEntry light_tracing_entry{
    "lightpath",
    "light tracing: particles connected to the camera; good at caustics on matte surfaces",
    lightpath_settings,
    true,
    false,
    create_lightpath};

extern const IntegratorEntry bdpt_entry{
    "bdpt",        "bidirectional path tracing: unbiased; all ways to join an eye and a light path",
    bdpt_settings, true,
    false,         create_bdpt};

extern const IntegratorEntry vcm_entry{
    "vcm",        "vertex connection and merging: bdpt and photon mapping in one; the most robust",
    vcm_settings, true,
    true,         create_vcm};

}  // namespace dapple
