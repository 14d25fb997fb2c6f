#pragma once

#include "dapple/density/surface_places.h"

#include <utility>

namespace dapple {

// The radii of photons on an unbounded plane (integrators/photon_discs.h has them on the surfaces of a world).
inline PointLimits radii_of(const PhotonMap& photons, const SurfacePlaces& places)
{
    std::vector<float> squared(photons.size());
    for (uint32_t slot = 0; slot < photons.size(); ++slot)
        squared[slot] = sqr(places.radius_at({photons.position(slot), photons.normal(slot)}));
    return photons.tree().limits(std::move(squared));
}

}  // namespace dapple
