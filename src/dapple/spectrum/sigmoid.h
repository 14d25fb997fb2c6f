// Reflectance spectra of RGB colours: the sigmoid of a quadratic polynomial in wavelength (Jakob and Hanika 2019, "A
// low-dimensional function space for efficient spectral upsampling").
//   Exact: solved per colour (about 10 us), for constants of the scene.
//   Table: trilinear in solved coefficients, for the pixels of images.
// Error of RGB -> spectrum -> RGB under the space's white: below 1e-4 (exact) inside the gamut. At the gamut's edge,
// and in the part of wide spaces that no reflectance can reach, the nearest spectrum by CIE L*a*b* is returned (see
// tests/unit/spectrum/sigmoid_test.cpp for measured errors).
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
// ratios of the other two to it. 1.2 MB.
class SigmoidTable {
public:
    // Solves all entries, in parallel (0.3 s of one core).
    explicit SigmoidTable(const ColorSpace& space);

    // As rgb_to_sigmoid, approximately (greys exactly). Hot.
    SigmoidCoefficients lookup(const Vec3& rgb) const;

private:
    static constexpr int resolution = 32;

    const std::array<float, 3>& entry(int channel, int z, int y, int x) const
    {
        return entries_[static_cast<size_t>(((channel * resolution + z) * resolution + y) * resolution + x)];
    }

    std::array<float, resolution> values_{};  // of the largest channel
    std::vector<std::array<float, 3>> entries_;
};

// The table of a colour space, built when first asked for. Must not be called first from inside a parallel loop.
const SigmoidTable& sigmoid_table(const ColorSpace& space);

}  // namespace dapple
