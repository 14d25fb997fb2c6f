// What the four lanes mean. Two colour models (docs/architecture.md):
//   spectral  four wavelengths [nm] with their sampling densities [1/nm] (hero wavelengths, Wilkie et al. 2014);
//   rgb       lanes are red, green, blue and green again (linear sRGB). The fourth lane repeats green so that every
//             lane always holds a valid quantity and a lane picked at random is never dead; the film ignores it.
#pragma once

#include "dapple/spectrum/spectrum.h"

namespace dapple {

// fixed_spectral: the same four for every path (pbrt's option disablewavelengthjitter); it says how to choose
// wavelengths and is never Wavelengths::model.
enum class ColorModel { spectral, rgb, fixed_spectral };

inline constexpr float lambda_min = 360.0f;
inline constexpr float lambda_max = 830.0f;

struct Wavelengths {
    ColorModel model = ColorModel::spectral;
    float lambda[Spectrum::lanes] = {450, 520, 590, 660};  // [nm]; unused in the rgb model
    float pdf[Spectrum::lanes] = {1, 1, 1, 1};             // [1/nm]; 1 in the rgb model

    // The four wavelengths of offset u in [0, 1): stratified, importance sampled for the eye's response
    // (density of Radziszewski et al. 2009, "An improved technique for full spectral rendering").
    static Wavelengths sample_visible(float u);
    static Wavelengths rgb();
};

// Dispersion parts the lanes' ways. A path that meets it keeps one lane, chosen beforehand at random, times four, and
// sets the others to zero (see transport/walk.h); Wavelengths itself never changes along a path, so that photons and
// eye paths of one wavelength set can always be multiplied lane by lane.

}  // namespace dapple
