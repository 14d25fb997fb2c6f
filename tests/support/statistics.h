// Statistics of renders: means with standard errors from independent images, and tests of equality by Student's t.
#pragma once

#include "dapple/image/image.h"

#include <vector>

namespace dapple::testing {

// A mean and the standard error of that mean, from `count` independent values.
struct Estimate {
    double mean = 0;
    double error = 0;
    int count = 0;
};
Estimate estimate(const std::vector<double>& values);

// Probability that |T| of Student's distribution exceeds |t|.
double student_two_sided(double t, double degrees_of_freedom);

// Probability of a distance at least as large as that between the estimate and a number, if the number is its mean. A
// distance of up to `allowance` counts as none. Where the error is 0, 1 or 0.
double p_value(const Estimate& a, double expected, double allowance = 0);
// The same for two estimates (Welch's test).
double p_value(const Estimate& a, const Estimate& b, double allowance = 0);

// Mean over the pixels [x0, x1) x [y0, y1) of a channel.
double region_mean(const Image& image, int channel, int x0, int x1, int y0, int y1);
double channel_mean(const Image& image, int channel);
// Estimates of the mean of a channel over a region, one value per image.
Estimate region_estimate(const std::vector<Image>& images, int channel, int x0, int x1, int y0, int y1);
Estimate channel_estimate(const std::vector<Image>& images, int channel);
// The mean of all images, pixel by pixel.
Image mean_image(const std::vector<Image>& images);

}  // namespace dapple::testing
