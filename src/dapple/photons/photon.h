// A photon as algorithms see it: a flux packet stored where a light path met a surface (or scattered). PhotonMap keeps
// it packed (photon_packing.h).
#pragma once

#include "dapple/math/vec.h"
#include "dapple/spectrum/spectrum.h"

#include <cstdint>

namespace dapple {

struct Photon {
    Vec3 position{0, 0, 0};
    Vec3 direction{0, 0, 1};  // unit, pointing back to where the photon came from (wi of the estimate)
    Vec3 normal{0, 0, 1};     // geometric normal of the surface it met, on the side that `direction` points to
    Spectrum flux;            // [W], not divided by the number of emitted paths: the store knows that number
    uint8_t light_group = 0;
    uint8_t path_class = 0;         // class of the path up to and including this vertex's arrival: see the integrator
    bool from_delta_light = false;  // point-like or distant: no eye path can meet that light
    bool caustic = false;           // belongs to the caustic map, too: see the integrator
};

}  // namespace dapple
