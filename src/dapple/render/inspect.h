// A dry run in words: what a scene holds and what rendering it would take.
#pragma once

#include "dapple/render/scene_defaults.h"
#include "dapple/scene/description.h"
#include "dapple/world/compile.h"
#include "dapple/world/world.h"

#include <string>
#include <vector>

namespace dapple {

// The emitters of one light of the scene: a lamp, or all triangles of an emissive shape.
struct LightSummary {
    std::string what;   // "area light on plymesh lamp.ply (32 triangles)", "point light", ...
    double power = 0;   // luminous power, as lights/light.h defines it for choosing lights
    double share = 0;   // of photons and of light samples, in [0, 1]
    std::string group;  // light group, or empty
};

// In the order of decreasing share.
std::vector<LightSummary> summarise_lights(const World& world);

// Lines of text: film, camera, geometry, materials, media, lights, which algorithms suit, memory, times. `integrator`:
// the one chosen, for what its passes keep in memory; null if it cannot render this world.
std::vector<std::string> inspect(const scene::Description& description, const World& world, const CompileReport& report,
                                 const IntegratorChoice& choice, const Integrator* integrator);

// Whether the algorithm renders what the media of this world do.
bool knows_media(const IntegratorEntry& entry, const World& world);

}  // namespace dapple
