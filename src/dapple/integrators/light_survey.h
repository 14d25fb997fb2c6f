// What light paths tell of a scene before it is rendered.
#pragma once

#include "dapple/world/world.h"

namespace dapple {

// Of the light that comes to matte or glossy surfaces or scattering media without having been scattered by such, the
// part that came by mirrors, clear glass or the mirror reflection of smooth coats: caustics, in [0, 1]. From a few
// thousand light paths, the same each time.
struct CausticShare {
    double all = 0.0;
    double of_points = 0.0;  // of lights that no eye path can meet: point-like and distant ones
};
CausticShare caustic_share(const World& world);

}  // namespace dapple
