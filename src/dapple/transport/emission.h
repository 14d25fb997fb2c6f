// Light paths start here: a light is chosen by power, a particle leaves it with its exact share of the flux.
// Jensen 2001, "Realistic Image Synthesis Using Photon Mapping", chapter 5; Veach 1997, section 8.3 for measures.
#pragma once

#include "dapple/transport/walk.h"

namespace dapple {

// Where a particle left, for the weights of bidirectional methods.
struct Departure {
    LightId light;
    float probability = 0.0f;  // with which the light was chosen
    EmissionSample sample;
};

// A particle from a light chosen with World::light_choice. Its source() is the flux of all lights it stands for [W]:
// the mean over particles of source() is the total emitted power. False when the chosen light emits nothing this way.
bool emit(const World& world, const PathStart& start, RandomStream& random, Walk& walk, Departure& departure);

}  // namespace dapple
