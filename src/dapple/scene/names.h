// Words that scene files may use: named spectra, media presets, sensors, colour spaces. Their values live in
// the room spectrum, and so do all lists but that of the colour spaces.
#pragma once

#include "dapple/scene/values.h"

#include <optional>
#include <span>
#include <string_view>

namespace dapple::scene {

// Named spectra: those of pbrt-v4 ("glass-BK7", "metal-Au-k", "stdillum-D65", ...), and further indices of refraction
// ("water", "diamond", ...).
std::span<const std::string_view> spectrum_names();
// Presets of homogeneous media ("Skin1", "Wholemilk", ...; Jensen et al. 2001 and Narasimhan et al. 2006).
std::span<const std::string_view> medium_preset_names();
// Sensors ("canon_eos_5d_mkiv", ...), the default one ("cie1931") first.
std::span<const std::string_view> sensor_names();
// Colour spaces ("srgb", "rec2020", "aces2065-1", "dci-p3"), in the order of the enumeration.
std::span<const std::string_view> color_space_names();

bool contains(std::span<const std::string_view> names, std::string_view name);
// The colour space of a name, in any case; nothing for an unknown one.
std::optional<ColorSpace> color_space_from_name(std::string_view name);
std::string_view color_space_name(ColorSpace space);

}  // namespace dapple::scene
