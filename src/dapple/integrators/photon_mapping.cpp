// Photon mapping: photons are traced from the lights and stored; eye paths read them where they meet the first surface
// that is no delta (direct visualisation), or one bounce later (final gathering).
// Jensen 1996, "Global illumination using photon maps"; Christensen 1999, "Faster photon map global illumination"
// (precomputed irradiance); Knaus and Zwicker 2011, "Progressive photon mapping: a probabilistic approach".
//
// With final gathering the light at the first such vertex x is split as in the paper:
//   direct      L D S* E    sampled: light sampling and gather rays that meet lights, weighed by MIS
//   caustic     LS+D S* E   from the caustic map at x, kernel of a small radius, which widens where photons are few
//   indirect                gather rays from x; at the second vertex y the global map gives the light that leaves y
//                           (photon_gather.h); what narrow lobes throw on x is shared with the caustic map
//                           (transport/caustic_share.h).
// Without it everything but emission comes from the global map at x: fast and blotchy.
//
// Progressive: passes are grouped into epochs; each epoch traces new maps, with caustic radii of
// r_e^2 = r_1^2 Gamma(e + a) / (Gamma(1 + a) Gamma(e + 1)), e = 1, 2, ..., a = 2/3. r_1 is a number of pixel
// footprints. Bias: the blur of what the caustic map has and, one bounce away, of the global map; both vanish with
// passes. Direct light is exact. Without final gathering the estimates take the k nearest photons in the first epoch,
// then those within a part of their distance that falls as the caustic radius does. Edges of surfaces are allowed for
// (surface_coverage.h, photon_discs.h). Surfaces only.
#include "dapple/integrators/photon_gather.h"
#include "dapple/integrators/registry.h"

#include <fmt/format.h>

namespace dapple {
namespace {

constexpr SettingInfo settings_table[] = {
    {"finalgather", "", "true", "true|false",
     "gather one bounce away from the photons; false shows the global map directly"},
    {"gatherrays", "rays", "2", ">= 1", "gather rays per eye path"},
    photon_setting::photons,
    photon_setting::caustic_photons,
    photon_setting::epoch,
    photon_setting::radius,
    photon_setting::fixed_radius,
    photon_setting::spread,
    photon_setting::nearest,
    photon_setting::kernel,
    photon_setting::irradiance,
    photon_setting::wavelength_sets,
    photon_setting::max_depth,
    photon_setting::memory,
};

class PhotonMapping final : public Integrator {
public:
    PhotonMapping(const World& world, const Settings& settings)
        : final_gather_(settings.boolean("finalgather")),
          gather_rays_(static_cast<int>(settings.integer("gatherrays"))),
          gather_settings_(settings),
          epochs_(world, settings, final_gather_ ? MapUse::global_and_caustic : MapUse::global_alone, "photonmap")
    {
    }

    bool adds_eye_samples_alone() const override { return true; }

    void render_pass(const PassContext& context, Film& film) override
    {
        const std::shared_ptr<const PhotonEpoch> epoch = epochs_.of(context, film);
        for_each_pixel_of_sets(context, film, epoch->maps, [&](EyeSample& sample, size_t set) {
            trace(context.world, epoch->maps[set], epoch->shrinkage, sample);
        });
    }

    uint32_t correlated_passes() const override { return epochs_.correlated_passes(); }
    double bias_scale(uint32_t pass) const override { return epochs_.bias_scale(pass); }
    PassMemory pass_memory(const PassContext& context, const FilmSettings& film) const override
    {
        return epochs_.memory(context, film);
    }

    std::vector<Effort> efforts(const PassContext& context, const FilmSettings& film) const override
    {
        return {epochs_.effort(context, film)};
    }

    std::vector<std::string> report() const override
    {
        std::vector<std::string> lines = epochs_.report();
        lines.push_back(gather_settings_.describe(final_gather_));
        lines.push_back(final_gather_ ? fmt::format("final gathering, rays per eye path: {}", gather_rays_)
                                      : std::string("direct visualisation of the global map"));
        return lines;
    }

private:
    void trace(const World& world, const PhotonMapSet& maps, float shrinkage, EyeSample& sample) const
    {
        PhotonGather<const EyeSample> gather(gather_settings_, world, maps, shrinkage, sample.sums.light_groups() > 0,
                                             sample.random, sample);
        follow_eye(world, sample, gather_settings_.max_depth, gather, [&](const Walk& eye, float) {
            if (!final_gather_) {
                note_support(sample, gather.add_map(eye));
                return false;
            }
            note_support(sample, gather.gather(eye, gather_rays_));
            return true;
        });
    }

    bool final_gather_;
    int gather_rays_;
    GatherSettings gather_settings_;
    PhotonEpochs epochs_;
};

std::unique_ptr<Integrator> create(const World& world, const Settings& settings)
{
    return std::make_unique<PhotonMapping>(world, settings);
}

}  // namespace

extern const IntegratorEntry photon_mapping_entry{
    "photonmap",
    "photon mapping: global and caustic maps, final gathering or direct visualisation; caustics in seconds",
    settings_table,
    false,
    true,
    create};

}  // namespace dapple
