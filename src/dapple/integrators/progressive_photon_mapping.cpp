// Stochastic progressive photon mapping: every pass traces new photons and new eye paths, which gather the photons
// within a radius that shrinks from pass to pass. Hachisuka and Jensen 2009; without statistics kept per pixel, in the
// form of Knaus and Zwicker 2011, so that a pass is a pure function of its number. Which light is brought by photons
// and which by eye paths, and why no roughness parts them: visible_points.h.
// Finds all light that reaches a surface, SDS paths included, through kernel estimates:
//   L(y, wo) = sum_p f(wi_p, wo) (1 - s(wi_p)) flux_p K(d_p / r_i) / r_i^2 / paths.
// Bias: the blur of the kernel, which fades as r_i^2 ~ i^(a - 1); mean squared error falls as i^(-2/3) for a = 2/3.
// Direct light and what is seen by way of mirrors and narrow lobes is unbiased. Cost of a pass: an eye
// path per pixel and a light path per pixel and wavelength set, and the sorting of some five photons per light path (31
// bytes each). With `radiustest` the radius is lowered where light is uneven (radius_test.h): more noise, less blur.
#include "dapple/integrators/radius_test.h"
#include "dapple/integrators/registry.h"
#include "dapple/integrators/surface_coverage.h"
#include "dapple/integrators/visible_points.h"

namespace dapple {
namespace {

constexpr SettingInfo settings_table[] = {
    visible_point_setting::photons,
    visible_point_setting::radius,
    visible_point_setting::fixed_radius,
    visible_point_setting::alpha,
    photon_setting::kernel,
    visible_point_setting::wavelength_sets,
    photon_setting::max_depth,
    {"radiustest", "", "false", "true|false",
     "lower the radius where a chi-squared test of other photons finds light uneven: sharper caustics, more noise"},
    {"memory", "bytes", "auto", "> 0", "ceiling for the photons of a pass: fewer photons rather than more"},
};

class ProgressivePhotonMapping final : public Integrator {
public:
    ProgressivePhotonMapping(const World& world, const Settings& settings)
        : settings_(world, settings, "sppm"),
          radius_test_(settings.boolean("radiustest")),
          memory_(settings.integer_or("memory", 0)),
          report_(settings_.describe(world))
    {
    }

    bool adds_eye_samples_alone() const override { return true; }

    void render_pass(const PassContext& context, Film& film) override
    {
        const ColorModel model = film.settings().color_model;
        const std::vector<PassSet> sets =
            settings_.sets_of_pass(context, model, plan(context, film.settings()).global_paths);
        // A test wants photons apart from those of the estimate: other sets', or two halves of a lone set.
        const size_t parts = radius_test_ && sets.size() == 1 ? 2 : 1;
        std::vector<PhotonMap> maps;  // those of a set side by side
        for (const PassSet& set : sets)
            for (size_t part = 0; part < parts; ++part) {
                PhotonRequest photons = set.photons;
                photons.paths = std::max<int64_t>(1, photons.paths / static_cast<int64_t>(parts));
                if (part > 0) photons.stream = hash_words(photons.stream, part);
                std::vector<std::vector<Photon>> traced = trace_photons(context.world, photons);
                if (context.cancelled()) return;
                maps.emplace_back(std::move(traced), static_cast<uint64_t>(photons.paths));
                context.statistics.light_paths += static_cast<uint64_t>(photons.paths);
                context.statistics.photons_stored += maps.back().size();
            }
        const auto shrinkage = static_cast<float>(std::sqrt(settings_.shrinkage(context.pass)));
        for_each_pixel_of_sets(context, film, sets, [&](EyeSample& sample, size_t set) {
            trace_visible_points(
                context.world, sample, sets[set].time, settings_.max_depth(), [&](const Walk& eye, float distance) {
                    const float radius = shrinkage * settings_.first_radius(context.world.camera, distance);
                    gather(context.world, eye, maps, set * parts, (set + 1) * parts, radius, sample);
                });
        });
    }

    std::vector<std::string> report() const override { return report_; }
    double bias_scale(uint32_t pass) const override { return settings_.shrinkage(pass); }

    PassMemory pass_memory(const PassContext& context, const FilmSettings& film) const override
    {
        return {photon_map_bytes(plan(context, film), context, film.color_model), "photon maps"};
    }

    std::vector<Effort> efforts(const PassContext& context, const FilmSettings& film) const override
    {
        return {{"photons", "light paths per pass", plan(context, film).global_paths, photon_setting::least_paths}};
    }

private:
    // Of the photons that sets_of_pass asks for: indirect ones, all in one map.
    PhotonMapPlan plan(const PassContext& context, const FilmSettings& film) const
    {
        PhotonMapPlan plan;
        plan.global_paths = settings_.paths(film.resolution, film.color_model);
        plan.wavelength_sets = settings_.sets(film.color_model);
        plan.max_depth = settings_.max_depth();
        plan.keep_direct = plan.caustic_map = false;
        if (memory_ > 0) limit_memory(plan, context, film.color_model, memory_);
        return plan;
    }

    // The mean of the estimates from the maps [begin, end).
    void gather(const World& world, const Walk& eye, std::span<const PhotonMap> maps, size_t begin, size_t end,
                float largest_radius, EyeSample& sample) const
    {
        const Vertex& vertex = eye.vertex();
        const SurfaceRegion region = surface_region(vertex.at.position, vertex.bsdf, vertex.wo);
        const float share = 1.0f / static_cast<float>(end - begin), time = vertex.at.time;
        PhotonLight light(sample, eye.arriving() * share, sample.sums.light_groups() > 0);
        RandomStream trials = stream_of_trials(sample.random, eye.depth());
        thread_local NearestPoints unused(2);
        float radius = largest_radius, density = 0.0f;
        for (size_t own = begin; own < end; ++own) {
            const PhotonMap& map = maps[own];
            if (radius_test_) radius = tested_radius(maps, own, region, largest_radius);
            std::optional<SampledCoverage> coverage;  // asked for with the first photon
            const auto add = [&](uint32_t slot, float weight) {
                if (!coverage) coverage = sample_coverage(world, region, radius, settings_.kernel(), time, trials);
                if (coverage->obstructed && !sees_along_surface(world, region, radius, map.position(slot), time))
                    return;
                weight *= coverage->inverse;
                const uint8_t photon_class = map.path_class(slot);
                light.add(photon_radiance(vertex.bsdf, vertex.wo, map.direction(slot), map.flux(slot),
                                          static_cast<PathClass>(photon_class), map.from_delta_light(slot), weight),
                          class_with_photon(eye.events(), photon_class), LightGroup(map.light_group(slot)));
            };
            density += visit_photons(map, region, {0, radius, settings_.kernel()}, unused, add).density;
        }
        light.hand_over();
        if (sample.sums.radius > 0.0f) return;  // the layers show the first estimate of the eye path
        sample.sums.radius = radius;
        sample.sums.photon_density = density;
    }

    VisiblePointSettings settings_;
    bool radius_test_;
    int64_t memory_;  // [bytes], 0: no ceiling
    std::vector<std::string> report_;
};

std::unique_ptr<Integrator> create(const World& world, const Settings& settings)
{
    return std::make_unique<ProgressivePhotonMapping>(world, settings);
}

}  // namespace

extern const IntegratorEntry progressive_photon_mapping_entry{
    "sppm",
    "stochastic progressive photon mapping: new photons each pass, shrinking radii; all caustics, also in mirrors",
    settings_table,
    false,
    true,
    create};

}  // namespace dapple
