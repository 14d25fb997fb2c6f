// Makes SpectrumValues from what scenes say: numbers, RGB, measured tables, temperatures and names. Cold code. Each
// value also gets its linear sRGB for the rgb colour model, without negative components.
#pragma once

#include "dapple/base/error.h"
#include "dapple/spectrum/color_space.h"
#include "dapple/spectrum/spectrum_value.h"
#include "dapple/spectrum/standard_tables.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dapple {

// What a spectrum is, which decides its RGB for the rgb model.
enum class SpectrumRole : uint8_t {
    factor,  // multiplies light (reflectance, coefficient): RGB under D65, so that a constant c is (c, c, c)
    light,   // emission: sRGB of XYZ = integral of (x, y, z) S dlambda, without normalisation
    index,   // refractive index (eta or k): mean of S over each channel's matching function; a constant c is (c, c, c)
};

// The same number at all wavelengths.
SpectrumValue make_constant(float value, SpectrumRole role = SpectrumRole::factor);

// Reflectance of RGB clamped to [0, 1].
SpectrumValue make_albedo(SpectrumPool& pool, const ColorSpace& space, const Vec3& rgb);
// A factor of any size from RGB >= 0 (a coefficient): twice the largest component times a reflectance, as in pbrt.
SpectrumValue make_unbounded(SpectrumPool& pool, const ColorSpace& space, const Vec3& rgb);
// Light of RGB >= 0: an unbounded factor times the white of the colour space, whose Y is cie_y_integral. In both colour
// models a light of RGB (1, 1, 1) thus has luminance Y = cie_y_integral until scaled by photometric_scale.
SpectrumValue make_illuminant(SpectrumPool& pool, const ColorSpace& space, const Vec3& rgb);

// Black body of a temperature > 0 [K], scaled to a peak of 1 (at a wavelength that need not be visible), as in pbrt.
SpectrumValue make_blackbody(SpectrumPool& pool, float kelvin, SpectrumRole role = SpectrumRole::light);

// Piecewise linear through (lambda [nm], value), wavelengths increasing. Beyond the ends 0 as in pbrt, or the last
// value (for refractive indices). Throws UserError when the lists are empty, of unequal length, not increasing or not
// finite.
SpectrumValue make_sampled(SpectrumPool& pool, std::span<const float> lambdas, std::span<const float> values,
                           SpectrumRole role, TableEnds ends = TableEnds::zero);

// A spectrum known by name: pbrt's metals (index and extinction), glasses and illuminants, and further glasses,
// "water", "diamond", "fused-silica", "sapphire". Illuminants have Y = cie_y_integral. Throws UserError for another
// name.
SpectrumValue make_named(SpectrumPool& pool, std::string_view name);
std::vector<std::string_view> named_spectrum_names();
// What may be meant by a name that is not among these, to be added to a message: the nearest, the symbol for a metal's
// full name, or which metals there are. Empty where nothing is near.
std::string named_spectrum_hint(std::string_view name);

// The factor that gives a light of this spectrum Y = 1: 1 / integral of ybar S dlambda, and for RGB illuminants that of
// the white alone, so that the RGB keeps its luminance (as pbrt). 0 for a spectrum without luminance. Emission of the
// scene is scaled by this, because the film's response has no 1 / cie_y_integral.
float photometric_scale(const SpectrumPool& pool, const SpectrumValue& value);

}  // namespace dapple
