// Stochastic progressive photon mapping: every pass traces new photons and new eye paths, which gather the photons
// within a radius that shrinks from pass to pass. Hachisuka and Jensen 2009; without statistics kept per pixel, in the
// form of Knaus and Zwicker 2011, so that a pass is a pure function of its number. Which light is brought by photons
// and which by eye paths, and why no roughness parts them: visible_points.h.
// Finds all light that reaches a surface, SDS paths included, through kernel estimates:
//   L(y, wo) = sum_p f(wi_p, wo) (1 - s(wi_p)) flux_p K(d_p / r_i) / r_i^2 / paths.
// Bias: the blur of the kernel, which fades as r_i^2 ~ i^(a - 1); mean squared error falls as i^(-2/3) for a = 2/3.
// Direct light and what is seen by way of mirrors and narrow lobes is unbiased. Cost of a pass: an eye
// path per pixel and a light path per pixel and wavelength set, and the sorting of some five photons per light path (31
// bytes each). Left out: a test of uniformity that chooses radii (Lin et al. 2020, CPPM) needs statistics per pixel
// over passes, so that passes would neither be pure functions nor add up in any order.
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
    {"memory", "bytes", "auto", "> 0", "ceiling for the photons of a pass: fewer photons rather than more"},
};

class ProgressivePhotonMapping final : public Integrator {
public:
    ProgressivePhotonMapping(const World& world, const Settings& settings)
        : settings_(world, settings, "sppm"),
          memory_(settings.integer_or("memory", 0)),
          report_(settings_.describe(world))
    {
    }

    void render_pass(const PassContext& context, Film& film) override
    {
        const ColorModel model = film.settings().color_model;
        const std::vector<PassSet> sets = settings_.sets_of_pass(context, model, paths(context, film));
        std::vector<PhotonMap> maps;
        for (const PassSet& set : sets) {
            maps.emplace_back(trace_photons(context.world, set.photons), static_cast<uint64_t>(set.photons.paths));
            context.statistics.light_paths += static_cast<uint64_t>(set.photons.paths);
            context.statistics.photons_stored += maps.back().size();
        }
        const auto shrinkage = static_cast<float>(std::sqrt(settings_.shrinkage(context.pass)));
        for_each_pixel_of_sets(context, film, sets, [&](EyeSample& sample, size_t set) {
            trace_visible_points(
                context.world, sample, sets[set].time, settings_.max_depth(), [&](const Walk& eye, float distance) {
                    const float radius = shrinkage * settings_.first_radius(context.world.camera, distance);
                    gather(context.world, eye, maps[set], {0, radius, settings_.kernel()}, sample);
                });
        });
    }

    std::vector<std::string> report() const override { return report_; }
    double bias_scale(uint32_t pass) const override { return settings_.shrinkage(pass); }

private:
    int64_t paths(const PassContext& context, const Film& film) const
    {
        const int64_t wanted = settings_.paths(film.resolution(), film.settings().color_model);
        if (memory_ == 0) return wanted;
        PhotonMapPlan plan;
        plan.global_paths = wanted;
        plan.wavelength_sets = settings_.sets(film.settings().color_model);
        plan.max_depth = settings_.max_depth();
        limit_memory(plan, context, film.settings().color_model, memory_);
        return plan.global_paths;
    }

    static void gather(const World& world, const Walk& eye, const PhotonMap& map, const Bandwidth& bandwidth,
                       EyeSample& sample)
    {
        const Vertex& vertex = eye.vertex();
        const SurfaceRegion region = surface_region(vertex.at.position, vertex.bsdf, vertex.wo);
        PhotonLight light(sample, eye.arriving(), sample.sums.light_groups() > 0);
        thread_local NearestPoints unused(2);
        const float radius = bandwidth.max_radius, time = vertex.at.time;
        std::optional<float> inverse_coverage;  // asked for with the first photon
        const EstimateSupport support = visit_photons(map, region, bandwidth, unused, [&](uint32_t slot, float weight) {
            if (!inverse_coverage) {
                RandomStream trials = stream_of_trials(sample.random, eye.depth());
                inverse_coverage = sampled_inverse_coverage(world, region, radius, bandwidth.kernel, time, trials);
            }
            weight *= *inverse_coverage * sampled_visibility(world, region, radius, map.position(slot), time);
            const uint8_t photon_class = map.path_class(slot);
            light.add(photon_radiance(vertex.bsdf, vertex.wo, map.direction(slot), map.flux(slot),
                                      static_cast<PathClass>(photon_class), map.from_delta_light(slot), weight),
                      class_with_photon(eye.events(), photon_class), LightGroup(map.light_group(slot)));
        });
        light.hand_over();
        if (sample.sums.radius > 0.0f) return;  // the layers show the first estimate of the eye path
        sample.sums.radius = bandwidth.max_radius;
        sample.sums.photon_density = support.density;
    }

    VisiblePointSettings settings_;
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
