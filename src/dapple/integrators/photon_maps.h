// The photon maps of an epoch: for each wavelength set a global map L(S|D)*D and a caustic map LS+D, with irradiance
// precomputed at photons of the global map. An epoch is a run of passes that share their maps; its maps are a pure
// function of (world, seed, epoch).
#pragma once

#include "dapple/density/irradiance_map.h"
#include "dapple/integrators/integrator.h"
#include "dapple/photons/photon_map.h"

#include <vector>

namespace dapple {

struct PhotonMapPlan {
    int64_t global_paths = 0;   // light paths per epoch, all wavelength sets together
    int64_t caustic_paths = 0;  // further paths, kept for the caustic map only
    int wavelength_sets = 4;    // 1 in the rgb model
    int max_depth = 100;
    bool precompute_irradiance = false;
    Bandwidth irradiance_bandwidth;
};

// The maps of one wavelength set.
struct PhotonMapSet {
    Wavelengths wavelengths;
    PhotonMap global;
    PhotonMap caustic;
    IrradianceMap irradiance;  // empty unless asked for
};

// The wavelengths of set `set` of `sets` in an epoch: the sets of an epoch interleave, so that together they sample the
// visible range finely and no epoch shows a tint.
Wavelengths wavelengths_of_set(ColorModel model, uint64_t seed, uint32_t epoch, int set, int sets);

// The set that a pixel uses in a pass: every 2 x 2 pixels use four sets, and each pixel goes round all of them.
inline int set_of_pixel(Int2 pixel, uint32_t pass, int sets)
{
    return static_cast<int>((static_cast<uint32_t>(pixel.x) + 2u * static_cast<uint32_t>(pixel.y) + pass) %
                            static_cast<uint32_t>(sets));
}

// Lowers the numbers of paths until the maps of an epoch, and what building them takes, fit into `bytes`. Photons per
// path are counted on a pilot of a few thousand paths, the same for every epoch.
void limit_memory(PhotonMapPlan& plan, const PassContext& context, ColorModel model, int64_t bytes);

std::vector<PhotonMapSet> trace_photon_maps(const PassContext& context, ColorModel model, const PhotonMapPlan& plan,
                                            uint32_t epoch);

}  // namespace dapple
