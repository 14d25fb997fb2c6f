// Photon passes: emit, trace with Russian roulette, store at every vertex that is not a delta.
// Jensen 1996, "Global illumination using photon maps": the global map holds L(S|D)*D, the caustic map LS+D.
// Flux is not divided by the number of emitted paths: the store does that, once.
#pragma once

#include "dapple/photons/photon.h"
#include "dapple/transport/walk.h"

#include <atomic>
#include <vector>

namespace dapple {

struct PhotonRequest {
    Wavelengths wavelengths;
    uint64_t seed = 0;
    uint64_t stream = 0;        // tells this set of paths from all others
    int64_t paths = 0;          // light paths to trace
    bool caustic_only = false;  // end each path with its first D: only LS+D photons are kept
    int max_depth = 100;        // scatterings before the stored vertex, plus one
    const std::atomic<bool>* cancel = nullptr;
};

// Photons in batches, in the order of their paths, whatever the number of threads.
std::vector<std::vector<Photon>> trace_photons(const World& world, const PhotonRequest& request);

}  // namespace dapple
