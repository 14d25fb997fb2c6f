#include "dapple/integrators/photon_maps.h"

#include "dapple/integrators/pixel_loop.h"
#include "dapple/transport/photon_tracing.h"

namespace dapple {
namespace {

// The caustic photons among those of the global map, batch by batch.
std::vector<std::vector<Photon>> caustic_photons(const std::vector<std::vector<Photon>>& batches)
{
    std::vector<std::vector<Photon>> out(batches.size());
    for (size_t i = 0; i < batches.size(); ++i)
        for (const Photon& photon : batches[i])
            if (photon.path_class == static_cast<uint8_t>(PathClass::caustic)) out[i].push_back(photon);
    return out;
}

}  // namespace

Wavelengths wavelengths_of_set(ColorModel model, uint64_t seed, uint32_t epoch, int set, int sets)
{
    // sample_visible repeats itself every quarter (it takes four stratified wavelengths), so the sets divide a quarter.
    const float jitter =
        to_unit_float(hash_words(seed, static_cast<uint64_t>(StreamPurpose::wavelength_set), uint64_t(epoch)));
    return choose_wavelengths(model, (static_cast<float>(set) + jitter) / static_cast<float>(sets * Spectrum::lanes));
}

std::vector<PhotonMapSet> trace_photon_maps(const PassContext& context, ColorModel model, const PhotonMapPlan& plan,
                                            uint32_t epoch)
{
    std::vector<PhotonMapSet> maps(static_cast<size_t>(plan.wavelength_sets));
    for (int set = 0; set < plan.wavelength_sets; ++set) {
        PhotonMapSet& map = maps[static_cast<size_t>(set)];
        map.wavelengths = wavelengths_of_set(model, context.seed, epoch, set, plan.wavelength_sets);
        PhotonRequest request;
        request.wavelengths = map.wavelengths;
        request.seed = context.seed;
        request.max_depth = plan.max_depth;
        request.cancel = context.cancel;
        const auto stream = [&](uint64_t kind) {
            return hash_words(static_cast<uint64_t>(StreamPurpose::photon), uint64_t(epoch), uint64_t(set), kind);
        };

        std::vector<std::vector<Photon>> caustic;
        const int64_t global_paths = plan.global_paths / plan.wavelength_sets;
        if (global_paths > 0) {
            request.stream = stream(0);
            request.paths = global_paths;
            std::vector<std::vector<Photon>> global = trace_photons(context.world, request);
            caustic = caustic_photons(global);
            map.global = PhotonMap(std::move(global), static_cast<uint64_t>(global_paths));
            if (plan.precompute_irradiance) map.irradiance = IrradianceMap(map.global, plan.irradiance_bandwidth);
        }
        const int64_t caustic_paths = plan.caustic_paths / plan.wavelength_sets;
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

}  // namespace dapple
