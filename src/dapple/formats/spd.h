// Spectral distributions as text: pairs of wavelength [nm] and value.
#pragma once

#include "dapple/base/error.h"
#include "dapple/scene/values.h"

#include <filesystem>
#include <span>

namespace dapple {

// Pairs of wavelength and value, as pbrt writes them inline. Throws UserError unless there is an even number of them
// and the wavelengths are positive and increase.
scene::Samples spectrum_samples(std::span<const float> pairs, const SourceLocation& where);

// The samples in an .spd file (whitespace between numbers, '#' starts a comment). `where` names the file in the scene.
scene::Samples read_spd(const std::filesystem::path& path, const SourceLocation& where);

}  // namespace dapple
