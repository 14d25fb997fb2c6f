#include "dapple/integrators/photon_maps.h"

#include "dapple/base/error.h"
#include "dapple/base/log.h"
#include "dapple/density/schedule.h"
#include "dapple/transport/photon_tracing.h"

namespace dapple {
namespace {

constexpr int usual_sets = 4;
constexpr uint32_t most_times = 64;  // of an epoch
constexpr int photons_per_place = 4;
// Of records, in radii of estimates. Where light is even, five of nine readers find a record first; with 0.35 four of
// five did, whose bias was twice as large. With 0.125 it is a fifth of the readers: records do not pay any more.
constexpr float first_reach = 0.25f, least_reach = 0.125f;

// The caustic photons among those of the global map, batch by batch.
std::vector<std::vector<Photon>> caustic_photons(const std::vector<std::vector<Photon>>& batches)
{
    std::vector<std::vector<Photon>> out(batches.size());
    for (size_t i = 0; i < batches.size(); ++i)
        for (const Photon& photon : batches[i])
            if (photon.caustic) out[i].push_back(photon);
    return out;
}

// Where further light paths meet surfaces, a quarter as many.
SurfacePlaces places_of(const PassContext& context, const PhotonMapPlan& plan, const PhotonRequest& request)
{
    std::vector<SurfacePlace> places;
    for (const auto& batch : trace_photons(context.world, request))
        for (const Photon& photon : batch)
            if (is_usable(photon)) places.push_back({photon.position, photon.normal});
    return {places, (plan.nearest + photons_per_place / 2) / photons_per_place, plan.radius_scale};
}

// Records reach less far from epoch to epoch, in radii of estimates: else the bias of readers would fall as these radii
// alone, as long as light changes over radii (at edges of bright patches).
IrradianceMap irradiance_of(const PassContext& context, const PhotonMapPlan& plan, const PhotonMapSet& maps)
{
    const float reach = first_reach * plan.radius_scale;
    if (reach < least_reach) return {};
    return IrradianceMap(maps.places, reach, [&](const SurfacePlace& place) {
        PlaceIrradiance irradiance;
        if (context.cancelled()) return irradiance;
        thread_local std::vector<WeightedPhoton> found;
        irradiance.something_hidden =
            maps.discs.find(context.world, maps.global, {place.position, place.normal}, found);
        for (const auto& [photon, weight] : found) irradiance.irradiance += maps.global.flux(photon) * weight;
        return irradiance;
    });
}

}  // namespace

void refuse_media(const World& world, std::string_view integrator)
{
    if (world.has_active_media())
        throw UserError(std::string(integrator) +
                        " does not know media that scatter or emit yet; use vcm, bdpt, path or lightpath");
}

double photon_map_bytes(const PhotonMapPlan& plan, const PassContext& context, ColorModel model)
{
    PhotonRequest request;
    request.wavelengths = wavelengths_of_set(model, context.seed, 0, 0, plan.wavelength_sets);
    request.seed = context.seed;
    request.stream = hash_words(static_cast<uint64_t>(StreamPurpose::photon), uint64_t(0xffffffff));
    request.paths = 8192;
    request.max_depth = plan.max_depth;
    request.keep_direct = plan.keep_direct;
    request.mark_caustics = plan.caustic_map;
    double photons = 0.0, caustic = 0.0;
    for (const auto& batch : trace_photons(context.world, request))
        for (const Photon& photon : batch) {
            photons += 1.0;
            caustic += photon.caustic;
        }
    const double per_path = 1.0 / static_cast<double>(request.paths);
    const double global = photons * per_path * static_cast<double>(plan.global_paths);
    const double stored = global + caustic * per_path * static_cast<double>(plan.global_paths + plan.caustic_paths);
    // Kept: packed photons; discs of those of the global map, and a quarter as many places with irradiance. While a set
    // is built: its photons as they were traced, with room to grow, and what sorting takes (photon_map.h).
    const double place = 28.0 + (plan.precompute_irradiance ? sizeof(IrradianceRecord) : 0);
    const double kept = stored * 32.0 + (plan.nearest > 0 ? global * (5.6 + place / photons_per_place) : 0.0);
    return kept + stored * (2.0 * sizeof(Photon) + 90.0) / plan.wavelength_sets;
}

void limit_memory(PhotonMapPlan& plan, const PassContext& context, ColorModel model, int64_t bytes)
{
    const double share = static_cast<double>(bytes) / std::max(photon_map_bytes(plan, context, model), 1.0);
    if (share >= 1.0) return;
    if (share < 0.25)
        log_warning("--memory leaves room for {:.2g} % of the light paths: light will be blotchy, and dark in corners",
                    100 * share);
    plan.global_paths = std::max<int64_t>(plan.wavelength_sets, static_cast<int64_t>(plan.global_paths * share));
    plan.caustic_paths = static_cast<int64_t>(plan.caustic_paths * share);
}

std::vector<PhotonMapSet> trace_photon_maps(const PassContext& context, ColorModel model, const PhotonMapPlan& plan,
                                            uint32_t epoch)
{
    std::vector<PhotonMapSet> maps(static_cast<size_t>(plan.wavelength_sets));
    for (int set = 0; set < plan.wavelength_sets && !context.cancelled(); ++set) {
        PhotonMapSet& map = maps[static_cast<size_t>(set)];
        map.wavelengths = wavelengths_of_set(model, context.seed, epoch, set, plan.wavelength_sets);
        if (plan.one_time_per_set) {
            // Epochs are few: wavelengths go on to another part of the shutter with each, lest shadows show colours.
            const int next =
                static_cast<int>((static_cast<uint32_t>(set) + epoch) % static_cast<uint32_t>(plan.wavelength_sets));
            map.time = time_of_set(context.seed, epoch, next, plan.wavelength_sets);
        }
        PhotonRequest request;
        request.wavelengths = map.wavelengths;
        request.time = map.time;
        request.seed = context.seed;
        request.max_depth = plan.max_depth;
        request.keep_direct = plan.keep_direct;
        request.cancel = context.cancel;
        const auto stream = [&](uint64_t kind) {
            return hash_words(static_cast<uint64_t>(StreamPurpose::photon), uint64_t(epoch), uint64_t(set), kind);
        };

        std::vector<std::vector<Photon>> caustic;
        const int64_t global_paths = plan.global_paths / plan.wavelength_sets;
        if (global_paths > 0) {
            request.stream = stream(0);
            request.paths = global_paths;
            request.mark_caustics = plan.caustic_map;
            std::vector<std::vector<Photon>> global = trace_photons(context.world, request);
            if (context.cancelled()) return maps;
            if (plan.caustic_map) caustic = caustic_photons(global);
            map.global = PhotonMap(std::move(global), static_cast<uint64_t>(global_paths));
            request.mark_caustics = false;
            if (plan.nearest > 0) {
                request.paths = (global_paths + photons_per_place - 1) / photons_per_place;
                request.stream = stream(3);
                map.discs = PhotonDiscs(context, map.global, places_of(context, plan, request), plan.kernel,
                                        map.time.value_or(0.5f));
                request.stream = stream(2);
                map.places = places_of(context, plan, request);
                if (plan.precompute_irradiance) map.irradiance = irradiance_of(context, plan, map);
                context.statistics.light_paths += static_cast<uint64_t>(2 * request.paths);
            }
        }
        const int64_t caustic_paths = plan.caustic_map ? plan.caustic_paths / plan.wavelength_sets : 0;
        if (caustic_paths > 0) {
            request.stream = stream(1);
            request.paths = caustic_paths;
            request.caustic_only = true;
            for (auto& batch : trace_photons(context.world, request)) caustic.push_back(std::move(batch));
        }
        map.caustic = PhotonMap(std::move(caustic), static_cast<uint64_t>(global_paths + caustic_paths));
        context.statistics.light_paths += static_cast<uint64_t>(global_paths + caustic_paths);
        context.statistics.photons_stored += map.global.size() + map.caustic.size();
    }
    return maps;
}

PhotonEpochs::PhotonEpochs(const World& world, const Settings& settings, MapUse use, std::string_view integrator)
    : use_(use),
      paths_(settings.integer_or("photons", 0)),
      caustic_paths_(settings.integer_or("causticphotons", -1)),
      epoch_passes_(static_cast<uint32_t>(settings.integer("epoch"))),
      nearest_(static_cast<int>(settings.integer("nearest"))),
      kernel_(kernel_named(settings.word("kernel"))),
      irradiance_(settings.boolean("irradiance")),
      wavelength_sets_(static_cast<int>(settings.integer("wavelengthsets"))),
      max_depth_(static_cast<int>(settings.integer("maxdepth"))),
      memory_(settings.integer_or("memory", 0)),
      moving_(MovingShapes(world).any())
{
    refuse_media(world, integrator);
}

PhotonMapPlan PhotonEpochs::plan(const PassContext& context, const FilmSettings& film) const
{
    PhotonMapPlan plan;
    const int64_t pixels = int64_t(film.resolution.x) * film.resolution.y;
    plan.global_paths = paths_ > 0 ? paths_ : std::clamp<int64_t>(pixels, 100'000, 1'000'000);
    plan.wavelength_sets = film.color_model == ColorModel::spectral ? wavelength_sets_ : 1;
    if (moving_) {
        const int still_sets = plan.wavelength_sets;
        plan.one_time_per_set = true;
        plan.wavelength_sets = std::max(still_sets, static_cast<int>(std::min(epoch_passes_, most_times)));
        if (paths_ == 0)
            plan.global_paths = plan.global_paths * plan.wavelength_sets / std::max(still_sets, usual_sets);
    }
    plan.caustic_paths = caustic_paths_ >= 0 ? caustic_paths_ : plan.global_paths;
    plan.caustic_map = use_ == MapUse::global_and_caustic;
    if (!plan.caustic_map) plan.caustic_paths = 0;
    plan.max_depth = max_depth_;
    plan.nearest = use_ == MapUse::global_and_caustic ? nearest_ : 0;
    plan.radius_scale = static_cast<float>(std::sqrt(bias_scale(context.pass)));
    plan.kernel = kernel_;
    // Irradiance does not remember which light it came from.
    plan.precompute_irradiance = plan.nearest > 0 && irradiance_ && film.light_groups.empty();
    if (memory_ > 0) limit_memory(plan, context, film.color_model, memory_);
    return plan;
}

PassMemory PhotonEpochs::memory(const PassContext& context, const FilmSettings& film) const
{
    return {photon_map_bytes(plan(context, film), context, film.color_model), "photon maps"};
}

Effort PhotonEpochs::effort(const PassContext& context, const FilmSettings& film) const
{
    return {"photons", "light paths per epoch", plan(context, film).global_paths, photon_setting::least_paths};
}

std::vector<std::string> PhotonEpochs::report() const
{
    if (!moving_) return {};
    return {"shapes move: each wavelength set of an epoch has one time, pixels go from set to set"};
}

double PhotonEpochs::bias_scale(uint32_t pass) const { return progressive_shrinkage(int64_t(index(pass)) + 1); }

std::shared_ptr<const PhotonEpoch> PhotonEpochs::of(const PassContext& context, const Film& film)
{
    const uint32_t index = this->index(context.pass);
    const std::lock_guard lock(mutex_);
    if (epoch_ && epoch_->index == index && epoch_->seed == context.seed) return epoch_;
    epoch_.reset();  // frees the old maps first: memory does not grow with passes
    auto made = std::make_shared<PhotonEpoch>();
    made->seed = context.seed;
    made->index = index;
    made->shrinkage = static_cast<float>(std::sqrt(bias_scale(context.pass)));
    made->maps = trace_photon_maps(context, film.settings().color_model, plan(context, film.settings()), index);
    if (!context.cancelled()) epoch_ = made;
    return made;
}

}  // namespace dapple
