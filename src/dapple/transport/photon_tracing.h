// Photon passes: emit, trace with Russian roulette, store at every vertex that is not a delta.
// Jensen 1996, "Global illumination using photon maps": the global map holds L(S|D)*D, the caustic map LS+D and a share
// of what narrow lobes threw on things (caustic_share.h). Flux is not divided by the number of emitted paths: the store
// does that, once.
#pragma once

#include "dapple/photons/photon.h"
#include "dapple/transport/walk.h"

#include <atomic>
#include <optional>
#include <vector>

namespace dapple {

// The random numbers of one light path. Paths are told apart by all 63 bits of the index, of which a stream takes 32:
// the others choose the stream.
inline RandomStream light_path_stream(uint64_t seed, uint64_t stream, int64_t path)
{
    return {seed, hash_words(stream, static_cast<uint64_t>(path) >> 32), static_cast<uint32_t>(path)};
}

struct PhotonRequest {
    Wavelengths wavelengths;
    uint64_t seed = 0;
    uint64_t stream = 0;         // tells this set of paths from all others
    int64_t paths = 0;           // light paths to trace
    bool mark_caustics = false;  // tell photons of the caustic map, with further random numbers
    bool caustic_only = false;   // only these are kept
    bool keep_direct = true;     // false: light that comes straight from its source is not stored
    std::optional<float> time;   // of all paths; drawn for each if not given
    int max_depth = 100;         // scatterings before the stored vertex, plus one
    const std::atomic<bool>* cancel = nullptr;
};

// Photons in batches, in the order of their paths, whatever the number of threads.
std::vector<std::vector<Photon>> trace_photons(const World& world, const PhotonRequest& request);
// The photons of the paths [begin, end) alone, added to `out`: for those who want no more of them in memory at a time.
void trace_photons(const World& world, const PhotonRequest& request, int64_t begin, int64_t end,
                   std::vector<Photon>& out);

}  // namespace dapple
