// Irradiance caching: photon mapping whose final gathering is done at few points of matte surfaces and interpolated in
// between, with gradients.
// Ward et al. 1988; Ward and Heckbert 1992; Krivanek et al. 2005 and 2006; Tabellion and Lamorlette 2004: see
// density/irradiance_cache.h for weights and error metric, density/hemisphere.h for gradients, cache_overture.h for
// where records are made.
//
// At the first vertex x that is no delta, direct light (a light sample and a ray, weighed by MIS) and caustics are as
// in photonmap; if x is matte, its indirect light is reflectance / pi times the cached irradiance E. Other surfaces,
// and places where light changes within a pixel or two, gather as photonmap does. Where lights are in groups, all
// surfaces do: irradiance does not remember which light it came from.
//
// Progressive: every epoch has new maps and a new cache, so that the noise of records averages out, and its accuracy
// falls as the caustic radius does. With four wavelength sets a record has an irradiance of each, from a quarter of its
// rays, and a pixel takes all four in turn: no tint. Bias: that of photonmap, and of interpolation (second order in the
// accuracy). Shapes that move gather: records would stay behind. On those that stay a record has the light of each
// set's time. Cost: a record takes `cacherays` gather rays, an eye path only its direct light and the look-up: its one
// ray ends at the first wide surface.
//
// Records hold the light that comes from wide surfaces. What glossy metal or glass throws on x comes from few
// directions, is strong, and is found by chance: one such ray among those of a record would be a blotch as wide as the
// record. The caustic map has most of it (transport/caustic_share.h), and the eye path's own ray, which looks for
// lights, finds the rest, anew in every pixel and pass. (Glossy things behind a wide surface that is too near for the
// map are in the records all the same.)
#include "dapple/integrators/cache_overture.h"
#include "dapple/integrators/registry.h"

#include <fmt/format.h>

namespace dapple {
namespace {

constexpr SettingInfo settings_table[] = {
    {"accuracy", "", "0.2", "> 0 and <= 1",
     "error bound: how far a record reaches, over the distance of what it sees; smaller is slower"},
    {"cacherays", "rays", "256", ">= 16", "gather rays per record, all wavelength sets together"},
    {"cacherecords", "records", "auto", "> 0",
     "most records of an epoch; pixels without one gather; auto: where a record takes fewer rays than its pixels "
     "would"},
    {"gatherrays", "rays", "2", ">= 1", "gather rays per eye path where the cache does not serve"},
    photon_setting::photons,
    photon_setting::caustic_photons,
    {"epoch", "passes", "16", ">= 1", "passes that share photon maps and cache"},
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

class IrradianceCaching final : public Integrator {
public:
    IrradianceCaching(const World& world, const Settings& settings)
        : gather_rays_(static_cast<int>(settings.integer("gatherrays"))),
          gather_settings_(settings),
          epochs_(world, settings, MapUse::global_and_caustic, "irradiancecache"),
          overture_{static_cast<int>(settings.integer("cacherays")),
                    gather_rays_ * static_cast<int>(epochs_.correlated_passes()),
                    static_cast<float>(settings.number("accuracy")), settings.integer_or("cacherecords", 0)},
          moving_(world)
    {
    }

    bool adds_eye_samples_alone() const override { return true; }

    void render_pass(const PassContext& context, Film& film) override
    {
        const std::shared_ptr<const CachedEpoch> epoch = epoch_of(context, film);
        for_each_pixel_of_sets(context, film, epoch->photons->maps,
                               [&](EyeSample& sample, size_t set) { trace(context.world, *epoch, set, sample); });
    }

    uint32_t correlated_passes() const override { return epochs_.correlated_passes(); }
    double bias_scale(uint32_t pass) const override { return epochs_.bias_scale(pass); }
    PassMemory pass_memory(const PassContext& context, const FilmSettings& film) const override
    {
        return {epochs_.memory(context, film).bytes, "photon maps (the cache comes on top)"};
    }

    std::vector<Effort> efforts(const PassContext& context, const FilmSettings& film) const override
    {
        constexpr double share = 1.0 / 6;  // half of what there is for both
        Effort photons = epochs_.effort(context, film);
        photons.share = share;
        if (!film.light_groups.empty()) return {photons};
        return {photons, {"cacherecords", "records per epoch", places_of_records(film, overture_), 16, share}};
    }

    std::vector<std::string> report() const override
    {
        std::vector<std::string> lines = epochs_.report();
        lines.push_back(gather_settings_.describe(true));
        lines.push_back(fmt::format("irradiance cached to an accuracy of {}, {} gather rays per record",
                                    overture_.accuracy, overture_.rays));
        return lines;
    }

private:
    struct CachedEpoch {
        std::shared_ptr<const PhotonEpoch> photons;
        IrradianceCache cache;
        bool use_cache = true;
    };

    // A pure function of the epoch, kept until another is asked for.
    std::shared_ptr<const CachedEpoch> epoch_of(const PassContext& context, const Film& film)
    {
        const std::lock_guard lock(mutex_);
        const auto is_current = [&] {
            return epoch_->photons->index == epochs_.index(context.pass) && epoch_->photons->seed == context.seed;
        };
        if (epoch_ && is_current()) return epoch_;
        epoch_.reset();  // frees the old maps before new ones are made
        std::shared_ptr<const PhotonEpoch> photons = epochs_.of(context, film);
        auto made = std::make_shared<CachedEpoch>();
        made->use_cache = film.settings().light_groups.empty();
        if (made->use_cache)
            made->cache = make_irradiance_cache(context, film, *photons, gather_settings_, overture_, moving_);
        made->photons = std::move(photons);
        if (!context.cancelled()) epoch_ = made;
        return made;
    }

    void trace(const World& world, const CachedEpoch& epoch, size_t set, EyeSample& sample) const
    {
        const PhotonMapSet& maps = epoch.photons->maps[set];
        PhotonGather<const EyeSample> gather(gather_settings_, world, maps, epoch.photons->shrinkage,
                                             sample.sums.light_groups() > 0, sample.random, sample);
        follow_eye(world, sample, gather_settings_.max_depth, gather, [&](const Walk& eye, float) {
            const Vertex& vertex = eye.vertex();
            Spectrum irradiance;
            if (!epoch.use_cache || !is_cached(vertex, moving_) ||
                epoch.cache.look_up(vertex.at.position, cache_normal(vertex), static_cast<int>(set), irradiance) !=
                    IrradianceCache::Answer::value) {
                note_support(sample, gather.gather(eye, gather_rays_));
                return true;
            }
            gather.add_direct(eye);
            gather.follow(eye, GatherPart::from_narrow);
            note_support(sample, gather.add_caustics(eye));
            sample.add(eye.arriving() * vertex.bsdf.a * irradiance * inv_pi, PathClass::indirect, LightGroup(0u));
            return true;
        });
    }

    int gather_rays_;
    GatherSettings gather_settings_;
    PhotonEpochs epochs_;
    OvertureSettings overture_;
    MovingShapes moving_;

    std::mutex mutex_;
    std::shared_ptr<const CachedEpoch> epoch_;
};

std::unique_ptr<Integrator> create(const World& world, const Settings& settings)
{
    return std::make_unique<IrradianceCaching>(world, settings);
}

}  // namespace

extern const IntegratorEntry irradiance_caching_entry{
    "irradiancecache",
    "irradiance caching: photon mapping with final gathering at few points of matte surfaces, interpolated",
    settings_table,
    false,
    true,
    create};

}  // namespace dapple
