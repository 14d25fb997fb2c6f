// Reflectance spectra of RGB colours: the sigmoid of a quadratic polynomial in wavelength (Jakob and Hanika 2019, "A
// low-dimensional function space for efficient spectral upsampling").
//   Exact: solved per colour (10 to 20 us), for constants of the scene.
//   Table: trilinear in solved coefficients, for the pixels of images.
// Error of RGB -> spectrum -> RGB under the space's white: below 2e-5 (exact) in all of sRGB, and below 5e-3 in P3. In
// the part of the wide spaces that no reflectance can reach, the nearest spectrum by CIE L*a*b* is returned. The
// table's error is 4e-4 in the mean and 8e-3 at worst. Measured by tests/unit/spectrum/sigmoid_test.cpp.
#pragma once

#include "dapple/spectrum/color_space.h"
#include "dapple/spectrum/spectrum.h"

#include <array>
#include <cmath>
#include <vector>

namespace dapple {

struct SigmoidCoefficients {
    float c[3] = {0, 0, 0};

    // Reflectance in [0, 1] at a wavelength [nm]. Coefficients are finite, also for black and white.
    float at(float lambda) const
    {
        const float x = (c[0] * lambda + c[1]) * lambda + c[2];
        return 0.5f + 0.5f * x / std::sqrt(1.0f + x * x);
    }
};

// The reflectance of a colour, components clamped to [0, 1]. Greys are constant spectra. Cold.
SigmoidCoefficients rgb_to_sigmoid(const ColorSpace& space, const Vec3& rgb);

// Solved coefficients on a grid over all colours of a space: largest channel, its value (dense at both ends), and the
// ratios of the other two to it. 1.8 MB. The error grows to 3e-2 of the value towards saturated whites, and of very
// dark saturated colours to 1e-1 of theirs.
class SigmoidTable {
public:
    // Solves all entries, in parallel (0.4 s of one core).
    explicit SigmoidTable(const ColorSpace& space);

    // As rgb_to_sigmoid, approximately (greys exactly). Hot.
    SigmoidCoefficients lookup(const Vec3& rgb) const;

private:
    static constexpr int values = 48;  // of the largest channel
    static constexpr int ratios = 32;  // of the others to it

    static constexpr size_t index(int channel, int z, int y, int x)
    {
        return static_cast<size_t>(((channel * values + z) * ratios + y) * ratios + x);
    }

    std::array<float, values> value_{};  // of the largest channel at each z
    std::array<float, values> scale_{};  // the same on the scale of interpolation
    std::vector<std::array<float, 3>> entries_;
};

// The table of a colour space, built when first asked for. Must not be called first from inside a parallel loop.
const SigmoidTable& sigmoid_table(const ColorSpace& space);

}  // namespace dapple
