// What light paths tell of a scene before it is rendered.
#pragma once

#include "dapple/world/world.h"

namespace dapple {

// Of the light that comes to surfaces and media that scatter for the first time, the part that came by delta surfaces
// (mirrors, clear glass): caustics, in [0, 1]. From a few thousand light paths, the same each time.
double caustic_share(const World& world);

}  // namespace dapple
