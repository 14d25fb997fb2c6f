#include "support/statistics.h"

#include <cmath>

namespace dapple::testing {
namespace {

// The continued fraction of the incomplete beta function (Abramowitz and Stegun 26.5.8), by Lentz's method.
double beta_fraction(double a, double b, double x)
{
    constexpr double tiny = 1e-300;
    double c = 1, d = 1 - (a + b) * x / (a + 1);
    d = 1 / (std::abs(d) < tiny ? tiny : d);
    double fraction = d;
    for (int m = 1; m < 500; ++m) {
        for (const double term : {m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
                                  -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))}) {
            d = 1 + term * d;
            d = 1 / (std::abs(d) < tiny ? tiny : d);
            c = 1 + term / c;
            c = std::abs(c) < tiny ? tiny : c;
            fraction *= c * d;
        }
        if (std::abs(c * d - 1) < 1e-14) break;
    }
    return fraction;
}

double incomplete_beta(double a, double b, double x)
{
    if (x <= 0) return 0;
    if (x >= 1) return 1;
    const double front =
        std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
    return x < (a + 1) / (a + b + 2) ? front * beta_fraction(a, b, x) / a : 1 - front * beta_fraction(b, a, 1 - x) / b;
}

double p_of_distance(double distance, double error, double degrees_of_freedom, double allowance)
{
    const double beyond = std::abs(distance) - allowance;
    if (beyond <= 0) return 1;
    if (!(error > 0)) return 0;
    return student_two_sided(beyond / error, degrees_of_freedom);
}

}  // namespace

Estimate estimate(const std::vector<double>& values)
{
    const auto n = static_cast<double>(values.size());
    double sum = 0;
    for (double value : values) sum += value;
    const double mean = sum / n;
    double squares = 0;
    for (double value : values) squares += (value - mean) * (value - mean);
    return {mean, values.size() > 1 ? std::sqrt(squares / (n - 1) / n) : 0.0, static_cast<int>(values.size())};
}

double student_two_sided(double t, double degrees_of_freedom)
{
    return incomplete_beta(degrees_of_freedom / 2, 0.5, degrees_of_freedom / (degrees_of_freedom + t * t));
}

double p_value(const Estimate& a, double expected, double allowance)
{
    return p_of_distance(a.mean - expected, a.error, a.count - 1, allowance);
}

double p_value(const Estimate& a, const Estimate& b, double allowance)
{
    const double va = a.error * a.error, vb = b.error * b.error;
    const double spread = va * va / (a.count - 1) + vb * vb / (b.count - 1);
    const double freedom = spread > 0 ? (va + vb) * (va + vb) / spread : 1;
    return p_of_distance(a.mean - b.mean, std::sqrt(va + vb), freedom, allowance);
}

double region_mean(const Image& image, int channel, int x0, int x1, int y0, int y1)
{
    double sum = 0;
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) sum += image.at(x, y, channel);
    return sum / (double(x1 - x0) * (y1 - y0));
}

double channel_mean(const Image& image, int channel)
{
    return region_mean(image, channel, 0, image.width, 0, image.height);
}

Estimate region_estimate(const std::vector<Image>& images, int channel, int x0, int x1, int y0, int y1)
{
    std::vector<double> values;
    for (const Image& image : images) values.push_back(region_mean(image, channel, x0, x1, y0, y1));
    return estimate(values);
}

Estimate channel_estimate(const std::vector<Image>& images, int channel)
{
    return region_estimate(images, channel, 0, images.at(0).width, 0, images.at(0).height);
}

Image mean_image(const std::vector<Image>& images)
{
    Image mean(images.at(0).width, images.at(0).height, images.at(0).channels);
    for (size_t i = 0; i < mean.pixels.size(); ++i) {
        double sum = 0;
        for (const Image& image : images) sum += image.pixels[i];
        mean.pixels[i] = static_cast<float>(sum / static_cast<double>(images.size()));
    }
    return mean;
}

}  // namespace dapple::testing
