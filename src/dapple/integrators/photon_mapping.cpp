// Photon mapping: photons are traced from the lights and stored; eye paths read them where they meet the first surface
// that is no delta (direct visualisation), or one bounce later (final gathering).
// Jensen 1996, "Global illumination using photon maps"; Christensen 1999, "Faster photon map global illumination"
// (precomputed irradiance); Knaus and Zwicker 2011, "Progressive photon mapping: a probabilistic approach".
//
// With final gathering the light at the first such vertex x is split as in the paper:
//   direct      L D S* E    sampled: light sampling and gather rays that meet lights, weighed by MIS
//   caustic     LS+D S* E   from the caustic map at x, kernel of fixed radius
//   indirect                gather rays from x; at the second vertex y the global map gives all light that leaves y.
//                           Where y is nearer than the width of the estimate there, or is rough glass or metal, the
//                           path goes on instead: direct light and caustics are taken at y, and the next vertex is
//                           asked.
// Without it everything but emission comes from the global map at x: fast and blotchy.
//
// Progressive: passes are grouped into epochs; each epoch traces new maps, with the caustic radius of
// r_e^2 = r_1^2 Gamma(e + a) / (Gamma(1 + a) Gamma(e + 1)), e = 1, 2, ..., a = 2/3. r_1 is a number of pixel
// footprints. Bias: the blur of the caustic kernel (vanishes with passes) and of the k-nearest estimates of the global
// map (falls with photons per epoch); exact direct light. Surfaces only.
#include "dapple/base/error.h"
#include "dapple/density/estimate.h"
#include "dapple/density/schedule.h"
#include "dapple/integrators/photon_maps.h"
#include "dapple/integrators/pixel_loop.h"
#include "dapple/integrators/registry.h"
#include "dapple/transport/connect.h"

#include <fmt/format.h>

#include <memory>
#include <mutex>

namespace dapple {
namespace {

constexpr SettingInfo settings_table[] = {
    {"finalgather", "", "true", "true|false", "gather one bounce away from the photons; false shows the maps directly"},
    {"gatherrays", "rays", "4", ">= 1", "gather rays per eye path"},
    {"photons", "light paths", "auto", "> 0", "light paths per epoch; auto: four per pixel of the full image"},
    {"causticphotons", "light paths", "auto", ">= 0",
     "further light paths per epoch for the caustic map alone; auto: as many as photons"},
    {"epoch", "passes", "4", ">= 1", "passes that share one set of photon maps"},
    {"radius", "pixels", "2", "> 0", "radius of the caustic estimate in the first epoch, in pixel footprints"},
    {"fixedradius", "m", "auto", "> 0", "radius of the caustic estimate in the first epoch; auto: from the footprint"},
    {"nearest", "photons", "50", ">= 0", "photons per estimate of the global map; 0: all within the caustic radius"},
    {"kernel", "", "epanechnikov", "constant|cone|gaussian|epanechnikov|silverman", "kernel of the estimates"},
    {"irradiance", "", "true", "true|false",
     "precompute irradiance at photons for gather rays that meet matte surfaces (not if nearest is 0)"},
    {"wavelengthsets", "sets", "4", ">= 1", "sets of four wavelengths per epoch (spectral colour model)"},
    {"maxdepth", "scatterings", "100", ">= 0", "longest eye path and longest light path, in scatterings each"},
    {"memory", "bytes", "auto", "> 0",
     "ceiling for the photon maps of an epoch: fewer photons per epoch rather than more"},
};

struct Epoch {
    uint64_t seed = 0;
    uint32_t index = 0;
    float shrinkage = 1.0f;  // caustic radius over that of the first epoch
    std::vector<PhotonMapSet> maps;
};

class PhotonMapping final : public Integrator {
public:
    PhotonMapping(const World& world, const Settings& settings)
        : final_gather_(settings.boolean("finalgather")),
          gather_rays_(static_cast<int>(settings.integer("gatherrays"))),
          paths_(settings.is_auto("photons") ? 0 : settings.integer("photons")),
          caustic_paths_(settings.is_auto("causticphotons") ? -1 : settings.integer("causticphotons")),
          epoch_passes_(static_cast<uint32_t>(settings.integer("epoch"))),
          radius_pixels_(static_cast<float>(settings.number("radius"))),
          fixed_radius_(settings.is_auto("fixedradius") ? 0.0f : static_cast<float>(settings.number("fixedradius"))),
          nearest_(static_cast<int>(settings.integer("nearest"))),
          kernel_(kernel_named(settings.word("kernel"))),
          irradiance_(settings.boolean("irradiance")),
          wavelength_sets_(static_cast<int>(settings.integer("wavelengthsets"))),
          max_depth_(static_cast<int>(settings.integer("maxdepth"))),
          memory_(settings.is_auto("memory") ? 0 : settings.integer("memory"))
    {
        if (nearest_ == 1) throw UserError("setting 'nearest' needs 0 or at least 2 photons");
        if (world.has_scattering_media || world.has_emitting_media)
            throw UserError("photonmap does not know media that scatter or emit yet; use path or lightpath");
    }

    void render_pass(const PassContext& context, Film& film) override;

    std::vector<std::string> report() const override
    {
        return {fmt::format("caustic radius {} in the first epoch, {} nearest photons, {} kernel",
                            fixed_radius_ > 0.0f ? fmt::format("{} m", fixed_radius_)
                                                 : fmt::format("{} pixel footprints", radius_pixels_),
                            nearest_, kernel_names[static_cast<size_t>(kernel_)]),
                final_gather_ ? fmt::format("final gathering with {} rays per eye path", gather_rays_)
                              : std::string("direct visualisation of the photon maps")};
    }

    uint32_t correlated_passes() const override { return epoch_passes_; }
    double bias_scale(uint32_t pass) const override { return progressive_shrinkage(int64_t(pass / epoch_passes_) + 1); }

private:
    class EyePath;

    PhotonMapPlan plan(const PassContext& context, const Film& film) const
    {
        PhotonMapPlan plan;
        const int64_t pixels = int64_t(film.resolution().x) * film.resolution().y;
        plan.global_paths = paths_ > 0 ? paths_ : std::max<int64_t>(100'000, pixels * epoch_passes_);
        plan.caustic_paths = caustic_paths_ >= 0 ? caustic_paths_ : plan.global_paths;
        if (!final_gather_) plan.caustic_paths = 0;
        plan.wavelength_sets = film.settings().color_model == ColorModel::rgb ? 1 : wavelength_sets_;
        plan.max_depth = max_depth_;
        // Irradiance does not remember which light it came from.
        plan.precompute_irradiance =
            final_gather_ && irradiance_ && nearest_ > 0 && film.settings().light_groups.empty();
        plan.irradiance_bandwidth = global_bandwidth(infinity);
        if (memory_ > 0) limit_memory(plan, context, film.settings().color_model, memory_);
        return plan;
    }

    Bandwidth global_bandwidth(float caustic_radius) const
    {
        return {nearest_, nearest_ == 0 ? caustic_radius : infinity, kernel_};
    }

    // The maps of the pass's epoch: a pure function of it, kept until another epoch is asked for.
    std::shared_ptr<const Epoch> epoch_of(const PassContext& context, const Film& film)
    {
        const uint32_t index = context.pass / epoch_passes_;
        const std::lock_guard lock(mutex_);
        if (epoch_ && epoch_->index == index && epoch_->seed == context.seed) return epoch_;
        epoch_.reset();  // frees the old maps first: memory does not grow with passes
        auto made = std::make_shared<Epoch>();
        made->seed = context.seed;
        made->index = index;
        made->shrinkage = static_cast<float>(std::sqrt(progressive_shrinkage(int64_t(index) + 1)));
        made->maps = trace_photon_maps(context, film.settings().color_model, plan(context, film), index);
        if (!context.cancelled()) epoch_ = made;
        return made;
    }

    bool final_gather_;
    int gather_rays_;
    int64_t paths_;
    int64_t caustic_paths_;  // -1: auto
    uint32_t epoch_passes_;
    float radius_pixels_;
    float fixed_radius_;
    int nearest_;
    KernelKind kernel_;
    bool irradiance_;
    int wavelength_sets_;
    int max_depth_;
    int64_t memory_;  // [bytes], 0: no ceiling

    std::mutex mutex_;
    std::shared_ptr<const Epoch> epoch_;
};

// One eye path, with what it needs at hand.
class PhotonMapping::EyePath {
public:
    EyePath(const PhotonMapping& settings, const World& world, const Epoch& epoch, const PhotonMapSet& maps,
            EyeSample& sample)
        : settings_(settings),
          world_(world),
          epoch_(epoch),
          maps_(maps),
          sample_(sample),
          light_groups_(sample.sums.light_groups() > 0)
    {
    }

    void trace()
    {
        Walk eye = start_at_camera(world_, sample_.raster, sample_.wavelengths, sample_.random);
        GuideRecorder guides(world_, sample_);
        while (const Vertex* vertex = eye.next(world_, sample_.random)) {
            if (eye.events().diffuse > 0) return;  // a coated surface was left by its diffuse part: the map had that
            guides.see(*vertex);
            distance_ += vertex->distance;
            add_emission(eye, false);
            if (eye.depth() > settings_.max_depth_) return;
            if (!vertex->is_delta()) {
                if (settings_.final_gather_) return gather(eye);
                show_map(eye);
                if (!vertex->has_delta_lobe()) return;  // what a smooth coat mirrors is seen further on
            }
            if (eye.depth() > 1 && !eye.survive_roulette(sample_.random)) return;
        }
        if (eye.events().diffuse == 0) add_escaped(eye, false);
    }

private:
    void add_emission(const Walk& walk, bool weigh)
    {
        const LightId emitter = walk.vertex().emitter;
        if (emitter.valid())
            sample_.add(met_emission(world_, walk, weigh) * share_, classify(walk.events(), {}),
                        world_.lights.list[emitter.value].group);
    }

    void add_escaped(const Walk& walk, bool weigh)
    {
        if (!walk.escaped()) return;
        for (LightId light : world_.environments)
            sample_.add(met_environment(world_, walk, light, weigh) * share_, classify(walk.events(), {}),
                        world_.lights.list[light.value].group);
    }

    void add_direct(const Walk& walk)
    {
        const DirectLight direct = direct_light(world_, walk, walk.vertex(), true, sample_.random);
        if (!direct.found) return;
        PathEvents events = walk.events();
        events.add_surface(false);
        sample_.add(direct.radiance * share_, classify(events, {}), direct.group);
    }

    float caustic_radius() const
    {
        const float first = settings_.fixed_radius_ > 0.0f
                                ? settings_.fixed_radius_
                                : settings_.radius_pixels_ * pixel_footprint(world_.camera, distance_);
        return first * epoch_.shrinkage;
    }

    // The photons of a map that take part in an estimate at the walk's vertex, with their weights, in photons_.
    EstimateSupport find_photons(const Walk& walk, const PhotonMap& map, const Bandwidth& bandwidth)
    {
        const Vertex& vertex = walk.vertex();
        const SurfaceRegion region{vertex.at.position, face_forward(vertex.at.n_geometric, vertex.wo),
                                   vertex.bsdf.transmits() ? PhotonSide::both : PhotonSide::same};
        photons_.clear();
        return visit_photons(map, region, bandwidth, nearest_points(bandwidth.nearest),
                             [&](uint32_t slot, float weight) {
                                 photons_.push_back({slot, weight});
                             });
    }

    // Adds the light of the photons found; each under the class of its own path where the walk has met no D before.
    void add_photons(const Walk& walk, const PhotonMap& map)
    {
        const Vertex& vertex = walk.vertex();
        const Spectrum throughput = walk.arriving() * share_;
        const bool first = walk.events().diffuse == 0;
        std::array<Spectrum, path_class_count> by_class{};
        for (const auto& [slot, weight] : photons_) {
            const Vec3 wi = map.direction(slot);
            const Spectrum f = evaluate(vertex.bsdf, vertex.wo, wi, TransportMode::radiance);
            if (f.is_black()) continue;
            // Flux per area counts geometric cosines, reflection the shading one.
            const float cosines =
                abs_dot(wi, vertex.bsdf.frame.n) / std::max(abs_dot(wi, vertex.at.n_geometric), 1e-4f);
            const Spectrum light = f * map.flux(slot) * (weight * cosines);
            const auto path_class = first ? map.path_class(slot) : static_cast<uint8_t>(PathClass::indirect);
            if (light_groups_)
                sample_.add(throughput * light, static_cast<PathClass>(path_class), LightGroup(map.light_group(slot)));
            else
                by_class[path_class] += light;
        }
        if (light_groups_) return;
        for (int i = 0; i < path_class_count; ++i)
            if (!by_class[static_cast<size_t>(i)].is_black())
                sample_.add(throughput * by_class[static_cast<size_t>(i)], static_cast<PathClass>(i), LightGroup(0u));
    }

    void add_caustics(const Walk& walk, bool note_support)
    {
        const EstimateSupport support = find_photons(walk, maps_.caustic, {0, caustic_radius(), settings_.kernel_});
        add_photons(walk, maps_.caustic);
        if (note_support) note(support);
    }

    // Of the first estimate of the eye path.
    void note(const EstimateSupport& support)
    {
        if (sample_.sums.radius > 0.0f) return;
        sample_.sums.photon_density += support.density;
        sample_.sums.radius += support.radius;
    }

    // Direct visualisation.
    void show_map(const Walk& eye)
    {
        note(find_photons(eye, maps_.global, settings_.global_bandwidth(caustic_radius())));
        add_photons(eye, maps_.global);
    }

    void gather(const Walk& eye)
    {
        add_direct(eye);
        add_caustics(eye, true);
        share_ = 1.0f / static_cast<float>(settings_.gather_rays_);
        for (int ray = 0; ray < settings_.gather_rays_; ++ray) follow(eye);
    }

    // One gather ray from the vertex of `eye`, until a vertex that the global map can stand for.
    void follow(Walk walk)
    {
        float since_last = 0.0f;  // way since the last vertex that is no delta
        while (const Vertex* vertex = walk.next(world_, sample_.random)) {
            since_last += vertex->distance;
            // Light met through delta surfaces after a D is a caustic there: the caustic map has it.
            const bool in_caustic_map = walk.events().diffuse > 0 && walk.events().specular_since_last;
            if (!in_caustic_map) add_emission(walk, true);
            if (walk.depth() > settings_.max_depth_) return;
            if (!vertex->is_delta()) {
                // What a smooth coat mirrors is seen sharply, as from the eye.
                if (walk.events().diffuse > 0 && is_wide(vertex->bsdf) && add_from_global_map(walk, since_last)) return;
                add_direct(walk);
                add_caustics(walk, false);
                since_last = 0.0f;
            }
            if (!walk.survive_roulette(sample_.random)) return;
        }
        if (!(walk.events().diffuse > 0 && walk.events().specular_since_last)) add_escaped(walk, true);
    }

    // Whether scattering spreads over the hemisphere, so that the few photons of an estimate sample it well. Rough
    // glass and metal are left to the gather ray, which goes on.
    static bool is_wide(const Bsdf& bsdf)
    {
        return bsdf.kind == BsdfKind::diffuse || bsdf.kind == BsdfKind::diffuse_transmission ||
               bsdf.kind == BsdfKind::coated_diffuse;
    }

    // False when the vertex is nearer to the last one than the estimate is wide.
    bool add_from_global_map(const Walk& walk, float since_last)
    {
        const Vertex& vertex = walk.vertex();
        if (vertex.bsdf.kind == BsdfKind::diffuse && !maps_.irradiance.empty()) {
            const IrradianceRecord* record = maps_.irradiance.nearest(
                vertex.at.position, face_forward(vertex.at.n_geometric, vertex.wo), since_last);
            if (record && record->radius >= since_last) return false;
            if (record) {
                const Spectrum radiance = vertex.bsdf.a * inv_pi * record->irradiance;
                sample_.add(walk.arriving() * share_ * radiance, PathClass::indirect, LightGroup(0u));
                return true;
            }
        }
        // A wider estimate would be refused: the search need not look further.
        Bandwidth bandwidth = settings_.global_bandwidth(caustic_radius());
        bandwidth.max_radius = std::min(bandwidth.max_radius, since_last);
        if (find_photons(walk, maps_.global, bandwidth).radius >= since_last) return false;
        add_photons(walk, maps_.global);
        return true;
    }

    // Scratch space of the thread, never a result: allocated once.
    static std::vector<std::pair<uint32_t, float>>& found_photons()
    {
        thread_local std::vector<std::pair<uint32_t, float>> scratch;
        return scratch;
    }
    static NearestPoints& nearest_points(int k)
    {
        thread_local NearestPoints scratch(2);
        if (k != 0 && scratch.k() != k) scratch = NearestPoints(k);
        return scratch;
    }

    const PhotonMapping& settings_;
    const World& world_;
    const Epoch& epoch_;
    const PhotonMapSet& maps_;
    EyeSample& sample_;
    std::vector<std::pair<uint32_t, float>>& photons_ = found_photons();  // slot, weight
    const bool light_groups_;
    float distance_ = 0.0f;  // way from the camera to the first D
    float share_ = 1.0f;     // of each gather ray
};

void PhotonMapping::render_pass(const PassContext& context, Film& film)
{
    const std::shared_ptr<const Epoch> epoch = epoch_of(context, film);
    const int sets = static_cast<int>(epoch->maps.size());
    const auto set_of = [&](Int2 pixel) -> const PhotonMapSet& {
        return epoch->maps[static_cast<size_t>(set_of_pixel(pixel, context.pass, sets))];
    };
    for_each_pixel(
        context, film, [&](Int2 pixel, RandomStream&) { return set_of(pixel).wavelengths; },
        [&](EyeSample& sample) { EyePath(*this, context.world, *epoch, set_of(sample.pixel), sample).trace(); });
}

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
