// The film of a scene description: resolution, crop, filter, sensor and layers.
#pragma once

#include "dapple/film/film.h"
#include "dapple/integrators/integrator.h"
#include "dapple/scene/description.h"
#include "dapple/world/world.h"

#include <array>
#include <string>

namespace dapple {

// Which layers an image has besides the beauty.
struct LayerChoice {
    bool guides = true;   // Albedo, N, Z, P
    bool classes = true;  // emission, direct, caustic, indirect, volume
    bool groups = true;   // each light group, where the scene names any
    bool photons = true;  // photon density and radius, where the integrator has them
    bool error = false;   // estimated errors of the pixels

    // Words of "all,beauty,guides,classes,groups,photons,error"; the beauty is always there, and all is all but error,
    // which costs memory and a little time. Throws UserError.
    static LayerChoice parse(const std::string& text);
};

// What the film of this description is; light groups come from the compiled world, photon layers if the integrator has
// them. Throws UserError for an unknown sensor.
FilmSettings film_settings(const scene::Description& description, const World& world, const LayerChoice& layers,
                           bool has_photon_layers, ColorModel color_model);

// Takes over what error estimates need to know of the integrator's passes. The settings then refer to the integrator.
void describe_passes(FilmSettings& settings, const Integrator& integrator);

// "640x480". Throws UserError.
Int2 parse_resolution(const std::string& text);
// Changes the resolution; a crop window keeps its part of the image.
void set_resolution(scene::Film& film, Int2 resolution);

// x0, x1, y0, y1, half open: parts of the image where all four are at most 1 (as pbrt's cropwindow), else pixels.
using CropEdges = std::array<double, 4>;
// "x0,x1,y0,y1". Throws UserError.
CropEdges parse_crop(const std::string& text);
// Changes the crop window. Throws UserError where it holds no pixel.
void set_crop(scene::Film& film, const CropEdges& edges);

}  // namespace dapple
