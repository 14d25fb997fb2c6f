// The photon maps of an epoch: for each wavelength set a global map L(S|D)*D and a caustic map LS+D, with a share of
// what narrow lobes throw on things (transport/caustic_share.h); a quarter as many further light paths tell how wide
// the discs of the global map's photons are, and as many again how wide estimates are at other places: irradiance is
// precomputed where these land. (Were they the same, readers would find themselves more often where places lie sparse,
// and discs of photons wide: records of an evenly lit floor were 1.3 % dark.) An epoch is a run of passes that share
// their maps; its maps are a pure function of (world, seed, epoch).
//
// Where shapes move, all paths of a set have one time, eye paths of the pixels that use it included, and surfaces are
// looked at when the photons were there: a set is a still picture, and the sets of all epochs average to the moving
// one. An epoch then has at least as many sets as passes, so that a pixel hardly sees a time twice: over n passes it
// sees about n times, as a path tracer's would, though all pixels the same ones. As each set has photons of its own,
// the automatic number of light paths grows with the sets.
#pragma once

#include "dapple/density/irradiance_map.h"
#include "dapple/integrators/integrator.h"
#include "dapple/integrators/moving_shapes.h"
#include "dapple/integrators/photon_discs.h"
#include "dapple/integrators/wavelength_sets.h"
#include "dapple/photons/photon_map.h"

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace dapple {

// Rows for the tables of integrators that use photon maps.
namespace photon_setting {
inline constexpr int64_t least_paths = 8192;  // that a limit of time leaves
inline constexpr SettingInfo photons{"photons", "light paths", "auto", "> 0",
                                     "light paths per epoch; auto: one per pixel of the full image, 100k to 1M, "
                                     "and more where shapes move"};
inline constexpr SettingInfo caustic_photons{
    "causticphotons", "light paths", "auto", ">= 0",
    "further light paths per epoch for the caustic map alone; auto: as many as photons"};
inline constexpr SettingInfo epoch{"epoch", "passes", "4", ">= 1", "passes that share one set of photon maps"};
inline constexpr SettingInfo radius{"radius", "pixels", "2.5", "> 0",
                                    "radius of the caustic estimate in the first epoch, in pixel footprints"};
inline constexpr SettingInfo fixed_radius{
    "fixedradius", "scene units", "auto", "> 0",
    "radius of the caustic estimate in the first epoch; auto: from the footprint"};
inline constexpr SettingInfo spread{
    "spread", "photons", "8", ">= 0",
    "caustic estimates with fewer photons widen, up to three times the radius; 0: never"};
inline constexpr SettingInfo nearest{"nearest", "photons", "50", ">= 0",
                                     "photons per estimate of the global map in the first epoch, fewer from epoch to "
                                     "epoch; for gather rays about as many; "
                                     "0: all within the caustic radius"};
inline constexpr SettingInfo kernel{"kernel", "", "epanechnikov", "constant|cone|gaussian|epanechnikov|silverman",
                                    "kernel of the estimates"};
inline constexpr SettingInfo irradiance{
    "irradiance", "", "true", "true|false",
    "precompute irradiance for gather rays that meet matte surfaces (not if nearest is 0)"};
inline constexpr SettingInfo wavelength_sets{"wavelengthsets", "sets", "4", ">= 1",
                                             "sets of four wavelengths per epoch (spectral colour model); where shapes "
                                             "move, at least one per pass"};
inline constexpr SettingInfo max_depth{"maxdepth", "scatterings", "100", ">= 0",
                                       "longest eye path and longest light path, in scatterings each"};
inline constexpr SettingInfo memory{
    "memory", "bytes", "auto", "> 0",
    "ceiling for the photon maps of an epoch: fewer photons per epoch rather than more"};
}  // namespace photon_setting

struct PhotonMapPlan {
    int64_t global_paths = 0;   // light paths per epoch, all wavelength sets together
    int64_t caustic_paths = 0;  // further paths, kept for the caustic map only
    int wavelength_sets = 4;    // 1 in the rgb model where nothing moves
    bool one_time_per_set = false;
    int max_depth = 100;
    bool keep_direct = true;  // in the global map
    bool caustic_map = true;  // false: caustic photons lie in the global map alone
    // For gather rays: radii of the photons of the global map, of discs that hold so many; 0: none.
    int nearest = 0;
    float radius_scale = 1.0f;  // of these
    KernelKind kernel = KernelKind::epanechnikov;
    bool precompute_irradiance = false;  // only if nearest > 0
};

// The maps of one wavelength set.
struct PhotonMapSet {
    Wavelengths wavelengths;
    std::optional<float> time;  // of all its paths, where shapes move
    PhotonMap global;
    PhotonMap caustic;
    SurfacePlaces places;      // all three: empty unless asked for
    PhotonDiscs discs;         // of the global map's photons
    IrradianceMap irradiance;  // at the places
};

// The class of a whole path: eye path so far, and a photon of class `photon` at its end.
inline PathClass class_with_photon(const PathEvents& eye, uint8_t photon)
{
    return eye.diffuse == 0 ? static_cast<PathClass>(photon) : PathClass::indirect;
}

// Adds up the light of many photons for a sink with add(radiance, class, group): by class, so that the sink is asked
// once for each; photon by photon where the light of groups is told apart.
template <class Sink>
class PhotonLight {
public:
    // throughput: what the sums are multiplied by.
    PhotonLight(Sink& sink, const Spectrum& throughput, bool light_groups)
        : sink_(sink), throughput_(throughput), light_groups_(light_groups)
    {
    }

    void add(const Spectrum& light, PathClass path_class, LightGroup group)
    {
        if (light_groups_)
            sink_.add(throughput_ * light, path_class, group);
        else
            sums_[static_cast<size_t>(path_class)] += light;
    }
    // Call once, at the end.
    void hand_over()
    {
        for (int i = 0; i < path_class_count; ++i)
            if (!sums_[static_cast<size_t>(i)].is_black())
                sink_.add(throughput_ * sums_[static_cast<size_t>(i)], static_cast<PathClass>(i), LightGroup(0u));
    }

private:
    Sink& sink_;
    const Spectrum throughput_;
    const bool light_groups_;
    std::array<Spectrum, path_class_count> sums_{};
};

// Throws UserError where the world has media that photon maps do not know; `integrator` is named there.
void refuse_media(const World& world, std::string_view integrator);

// Bytes of the maps of an epoch, with what building them takes. Photons per path are counted on a pilot of a few
// thousand paths, the same for every epoch.
double photon_map_bytes(const PhotonMapPlan& plan, const PassContext& context, ColorModel model);
// Lowers the numbers of paths until these are at most `bytes`.
void limit_memory(PhotonMapPlan& plan, const PassContext& context, ColorModel model, int64_t bytes);

std::vector<PhotonMapSet> trace_photon_maps(const PassContext& context, ColorModel model, const PhotonMapPlan& plan,
                                            uint32_t epoch);

// The maps of an epoch, and how much smaller its radii are than those of the first.
struct PhotonEpoch {
    uint64_t seed = 0;
    uint32_t index = 0;
    float shrinkage = 1.0f;
    std::vector<PhotonMapSet> maps;
};

// Which maps an integrator gathers from.
enum class MapUse : uint8_t { global_and_caustic, global_alone };

// The epochs of a render. The last one is kept until another is asked for.
class PhotonEpochs {
public:
    // Reads the rows photons, causticphotons, epoch, nearest, kernel, irradiance, wavelengthsets, maxdepth and memory.
    // Throws UserError where the world has media that photon maps do not know; `integrator` is named there.
    PhotonEpochs(const World& world, const Settings& settings, MapUse use, std::string_view integrator);

    // A line for reports where shapes move; nothing else.
    std::vector<std::string> report() const;

    uint32_t index(uint32_t pass) const { return pass / epoch_passes_; }
    // What Integrator asks for: passes per epoch, and squared radii relative to those of the first epoch.
    uint32_t correlated_passes() const { return epoch_passes_; }
    double bias_scale(uint32_t pass) const;
    PassMemory memory(const PassContext& context, const FilmSettings& film) const;
    Effort effort(const PassContext& context, const FilmSettings& film) const;
    // The epoch of the context's pass: a pure function of world, settings, seed and that epoch's number. Thread-safe.
    std::shared_ptr<const PhotonEpoch> of(const PassContext& context, const Film& film);

private:
    // radius_scale is that of the context's pass.
    PhotonMapPlan plan(const PassContext& context, const FilmSettings& film) const;

    MapUse use_;
    int64_t paths_;          // 0: auto
    int64_t caustic_paths_;  // -1: auto
    uint32_t epoch_passes_;
    int nearest_;
    KernelKind kernel_;
    bool irradiance_;
    int wavelength_sets_;
    int max_depth_;
    int64_t memory_;  // [bytes], 0: no ceiling
    bool moving_;     // some shape moves

    std::mutex mutex_;
    std::shared_ptr<const PhotonEpoch> epoch_;
};

}  // namespace dapple
