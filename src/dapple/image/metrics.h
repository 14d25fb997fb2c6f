// How far two images are apart: numbers, difference images, block statistics and the perceptual FLIP.
#pragma once

#include "dapple/image/image.h"

#include <cstddef>
#include <limits>
#include <vector>

namespace dapple {

struct CompareOptions {
    // Values of both images are limited to this, and from below to its negative, before anything is computed: against
    // single bright pixels.
    float clamp = std::numeric_limits<float>::infinity();
};

struct ImageComparison {
    std::vector<double> mean_test, mean_reference;  // per channel
    std::vector<double> mean_ratio;                 // mean_test / mean_reference per channel; NaN where the latter is 0
    double mse = 0.0;                               // mean of (t - r)^2 over all values
    double relative_mse = 0.0;                      // mean of (t - r)^2 / (r^2 + 0.01)
    double mae = 0.0;                               // mean of |t - r|
    double max_error = 0.0;                         // largest |t - r|
    size_t non_finite = 0;                          // pixels left out because either image is not finite there
};

// Compares channel by channel. Throws UserError if sizes or channel counts differ, as do the functions below.
ImageComparison compare_images(const Image& test, const Image& reference, const CompareOptions& options = {});

// |test - reference|, channel by channel.
Image absolute_difference(const Image& test, const Image& reference, const CompareOptions& options = {});

// A scale for signed_difference: the least of 1, 2 and 5 times a power of ten that 99 % of the finite pixels do not
// exceed (if these are alike, that none exceeds); 0.1 for images that are alike.
float difference_scale(const Image& test, const Image& reference, const CompareOptions& options = {});

// A picture of the sign: the difference of the channel means, divided by `full_scale`, red where the test is brighter
// and blue where it is darker; full strength at +-1; purple where a value is not finite. Linear RGB.
Image signed_difference(const Image& test, const Image& reference, float full_scale,
                        const CompareOptions& options = {});

// The means of blocks of block_size^2 pixels; blocks at the right and lower edge hold what is left.
Image block_means(const Image& image, int block_size);
// The unbiased variances of the values within the blocks, 0 for blocks of one pixel.
Image block_variances(const Image& image, int block_size);

struct FlipResult {
    double mean = 0.0;  // in [0, 1]
    Image map;          // one channel
};

// LDR FLIP (Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images") of the first three channels,
// taken as linear sRGB and limited to [0, 1] (map tones first). pixels_per_degree: 67 is a 0.7 m wide monitor of 3840
// pixels seen from 0.7 m. Throws UserError for fewer than three channels.
FlipResult flip(const Image& test, const Image& reference, float pixels_per_degree = 67.0206f);

}  // namespace dapple
