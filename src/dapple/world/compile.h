// From what the user wrote (scene::Description) to what rays meet (World).
#pragma once

#include "dapple/scene/description.h"
#include "dapple/world/world.h"

#include <memory>
#include <string>
#include <vector>

namespace dapple {

// What a compiled scene consists of and what it took.
struct CompileReport {
    size_t triangles = 0;  // stored ones; instances share them
    size_t other_primitives = 0;
    size_t instances = 0;
    size_t lights = 0;
    size_t geometry_bytes = 0;  // vertices and indices
    size_t accelerator_bytes = 0;
    size_t texture_bytes = 0;
    size_t medium_bytes = 0;
    std::vector<std::string> missing_images;  // files of textures that could not be read: shown magenta
    double seconds_textures = 0.0;
    double seconds_shapes = 0.0;
    double seconds_accelerator = 0.0;
    double seconds_lights = 0.0;
};

// Builds the world; parallel inside. Throws UserError with the place in the scene for what cannot be built; warns (log)
// for what is replaced, e.g. a missing texture image (shown magenta).
std::unique_ptr<World> compile(const scene::Description& description, CompileReport* report = nullptr);

}  // namespace dapple
