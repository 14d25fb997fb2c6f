// Tables that standards define, and resampling onto the grid all tables share: 360 to 830 nm in steps of 1 nm
// (spectrum_table_size values). Cold code; the numbers are in tables/*.inc, each with its source.
#pragma once

#include "dapple/math/vec.h"

#include <array>
#include <span>
#include <string_view>
#include <vector>

namespace dapple {

// Sum over the grid of the CIE 1931 y function: the integral [nm].
inline constexpr float cie_y_integral = 106.856895f;

// CIE 1931 2-degree colour matching functions x, y, z.
const std::array<std::vector<float>, 3>& cie_matching_functions();

// What a table is beyond its first and last wavelength.
enum class TableEnds { zero, clamp };

// Piecewise linear values at increasing wavelengths [nm], sampled on the grid.
std::vector<float> resample(std::span<const float> lambdas, std::span<const float> values, TableEnds ends);

// XYZ of a table: sum over the grid of (x, y, z) * table, without normalisation.
Vec3 xyz_of_table(std::span<const float> table);

// The illuminant of that name ("stdillum-D65", "illum-acesD60", ...), scaled so that the Y of its XYZ is
// cie_y_integral; null when there is none. D50 is the CIE's, which pbrt-v4's table of that name is not.
const std::vector<float>* illuminant_table(std::string_view name);
// Names of all illuminants.
std::vector<std::string_view> illuminant_names();

// Spectral sensitivity of a named camera (channel 0, 1, 2: r, g, b), or x, y, z of "cie1931"; null for an unknown name.
// Measured from 380 to 720 nm; the ends continue as in pbrt.
const std::vector<float>* sensor_curve(std::string_view name, int channel);
std::vector<std::string_view> sensor_names();

// Reflectances of the 24 patches of the ColorChecker, to which pbrt fits a camera's colour matrix. Ends continue.
const std::array<std::vector<float>, 24>& swatch_reflectances();

// Daylight of a correlated colour temperature [K] (CIE D series; the table of D65 for 6500). The temperature is given
// on the old scale with c2 = 1.4380e-2 m K, as in "D65". Below 4000 K, where the series ends, a black body.
std::vector<float> daylight_table(float kelvin);

}  // namespace dapple
