// The discs over which the photons of a map spread their flux: how wide each is (density/surface_places.h), and how
// much of it there is to be lit. Near an edge or a corner part of a disc lies off the surface, and behind a wall it
// belongs to another room: the photon's flux goes to what is left. So a photon's flux arrives, all of it and no more,
// on average; less only where under a tenth of the disc is left (surface_coverage.h). Bias: blur, and within a radius
// of an edge light moves inwards (evenly lit, the outermost fifth of a radius has 0.7 of its light, and the rest is
// further in).
//
// How much is left is found by chance, as for visible points: a number with the mean 1 / share (surface_coverage.h).
// Only photons that something may hide are asked whether they are seen. Cost: one search and four short rays per
// photon; 5.6 bytes per photon.
#pragma once

#include "dapple/density/surface_places.h"
#include "dapple/integrators/integrator.h"
#include "dapple/integrators/surface_coverage.h"

#include <vector>

namespace dapple {

class PhotonDiscs {
public:
    PhotonDiscs() = default;
    // time: in [0, 1] over the shutter, when the world is looked at. Parallel; a pure function of its arguments but for
    // the context, which is asked for the world and whether to give up.
    PhotonDiscs(const PassContext& context, const PhotonMap& map, const SurfacePlaces& places, KernelKind kernel,
                float time);

    // The photons whose discs reach a place, with their weights [1/m^2]; `map` is that which the discs were made of.
    // Replaces the contents of `found`. Returns whether photons were left out that something hides.
    bool find(const World& world, const PhotonMap& map, const SurfaceRegion& region,
              std::vector<WeightedPhoton>& found) const;

    size_t memory_bytes() const { return radii_.memory_bytes() + coverage_.size(); }

private:
    PointLimits radii_;
    std::vector<uint8_t> coverage_;  // 1 / share, and whether something stands on the disc
    KernelKind kernel_ = KernelKind::epanechnikov;
    float time_ = 0.5f;
};

}  // namespace dapple
