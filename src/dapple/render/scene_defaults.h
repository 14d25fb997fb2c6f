// What a scene file says about how it wants to be rendered, in Dapple's terms.
#pragma once

#include "dapple/integrators/integrator.h"
#include "dapple/scene/description.h"

#include <string>
#include <utility>
#include <vector>

namespace dapple {

struct IntegratorChoice {
    const IntegratorEntry* entry = nullptr;
    Settings settings{{}};
    std::vector<std::string> notes;  // what was replaced or left out, one line each
};

// The integrator to use: `asked` if not empty, else the scene's own where it is known here (lightpath, bdpt, sppm,
// ...), else the one that stands for it (pbrt's path tracers: path; mlt: vcm), with a note where that is another
// algorithm. The scene's "maxdepth" is taken over where the integrator has it; `definitions` (name, value) come last.
// Throws UserError, with the scene's place where it is the scene's doing, for unknown names and for values out of form.
IntegratorChoice choose_integrator(const scene::Integrator& scene_integrator, const std::string& asked,
                                   const std::vector<std::pair<std::string, std::string>>& definitions);

}  // namespace dapple
