// The scene as the user wrote it: plain values with units, defaults and source locations. Front ends fill one of these,
// world/compile reads it. Defaults and meanings are pbrt-v4's. Matrices map object space to world space.
#pragma once

#include "dapple/scene/appearance.h"
#include "dapple/scene/emitters.h"
#include "dapple/scene/geometry.h"
#include "dapple/scene/output.h"

#include <filesystem>
#include <string>
#include <vector>

namespace dapple::scene {

struct Description {
    Camera camera;
    Film film;
    Filter filter;
    Sampler sampler;
    Integrator integrator;
    Options options;

    std::vector<FloatTexture> float_textures;  // children have smaller indices than their parents
    std::vector<SpectrumTexture> spectrum_textures;
    std::vector<Material> materials;  // [0] is the default: a grey diffuse one
    std::vector<Medium> media;
    std::vector<AreaLight> area_lights;
    std::vector<Light> lights;
    std::vector<Shape> shapes;  // outside of objects
    std::vector<ObjectDefinition> objects;
    std::vector<Instance> instances;

    std::filesystem::path base_folder;  // of the main scene file; paths in here are already resolved
    std::vector<std::string> warnings;  // one line each: "file:line:column: message"
    // All files that were read for this, or that it names and compiling will read: the main file first, each once.
    std::vector<std::filesystem::path> files;
};

}  // namespace dapple::scene
