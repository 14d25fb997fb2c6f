// FLIP for low dynamic range (Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild, "FLIP: A Difference
// Evaluator for Alternating Images", HPG 2020; constants from the paper, sections 4.1 to 4.4):
//   colour:   both images through contrast sensitivity filters in the YCxCz space, then the HyAB distance of their
//             Hunt-adjusted L*a*b* values, raised to 0.7 and mapped to [0, 1];
//   features: differences of edge and point strengths of the unfiltered luminance, to [0, 1];
//   result:   colour difference ^ (1 - feature difference).
// Outside of the image the nearest pixel counts. All filters are sums of products of one-dimensional ones. Cost: about
// 40 filter rows of 20 to 30 taps a pixel.
#include "dapple/base/error.h"
#include "dapple/image/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace dapple {

namespace {

using Triple = std::array<double, 3>;
using Plane = std::vector<double>;
using Taps = std::vector<double>;  // of odd length, centred

// sRGB primaries, D65.
constexpr double xyz_from_rgb[3][3] = {
    {0.4124564, 0.3575761, 0.1804375}, {0.2126729, 0.7151522, 0.0721750}, {0.0193339, 0.1191920, 0.9503041}};

Triple white_xyz()
{
    Triple white{};
    for (int i = 0; i < 3; ++i) white[i] = xyz_from_rgb[i][0] + xyz_from_rgb[i][1] + xyz_from_rgb[i][2];
    return white;
}

// XYZ relative to the white.
Triple relative_xyz(const Triple& rgb)
{
    const Triple white = white_xyz();
    Triple result{};
    for (int i = 0; i < 3; ++i)
        result[i] =
            (xyz_from_rgb[i][0] * rgb[0] + xyz_from_rgb[i][1] * rgb[1] + xyz_from_rgb[i][2] * rgb[2]) / white[i];
    return result;
}

Triple ycxcz_from_rgb(const Triple& rgb)
{
    const Triple v = relative_xyz(rgb);
    return {116.0 * v[1] - 16.0, 500.0 * (v[0] - v[1]), 200.0 * (v[1] - v[2])};
}

Triple rgb_from_ycxcz(const Triple& ycxcz)
{
    // Inverse of xyz_from_rgb by cofactors.
    const auto& m = xyz_from_rgb;
    const Triple white = white_xyz();
    const double y = (ycxcz[0] + 16.0) / 116.0;
    const Triple xyz = {(y + ycxcz[1] / 500.0) * white[0], y * white[1], (y - ycxcz[2] / 200.0) * white[2]};
    Triple result{};
    double determinant = 0.0;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        Triple cofactor;
        for (int r = 0; r < 3; ++r) {
            const int s = (r + 1) % 3, t = (r + 2) % 3;
            cofactor[r] = m[s][j] * m[t][k] - m[s][k] * m[t][j];
            result[i] += cofactor[r] * xyz[r];
        }
        if (i == 0) determinant = m[0][0] * cofactor[0] + m[1][0] * cofactor[1] + m[2][0] * cofactor[2];
    }
    for (double& v : result) v = std::clamp(v / determinant, 0.0, 1.0);
    return result;
}

// L*a*b* of linear RGB, chroma scaled by lightness for Hunt's effect.
Triple hunt_lab(const Triple& rgb)
{
    const auto f = [](double t) {
        constexpr double delta = 6.0 / 29.0;
        return t > delta * delta * delta ? std::cbrt(t) : t / (3.0 * delta * delta) + 4.0 / 29.0;
    };
    const Triple v = relative_xyz(rgb);
    const double lightness = 116.0 * f(v[1]) - 16.0;
    return {lightness, 0.01 * lightness * 500.0 * (f(v[0]) - f(v[1])), 0.01 * lightness * 200.0 * (f(v[1]) - f(v[2]))};
}

double hyab(const Triple& a, const Triple& b) { return std::fabs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]); }

// Horizontal then vertical filter.
Plane convolve(const Plane& in, int width, int height, const Taps& across, const Taps& down)
{
    Plane middle(in.size()), out(in.size());
    const int rx = static_cast<int>(across.size() / 2), ry = static_cast<int>(down.size() / 2);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            double sum = 0.0;
            for (int i = -rx; i <= rx; ++i)
                sum += across[i + rx] * in[size_t(y) * width + std::clamp(x + i, 0, width - 1)];
            middle[size_t(y) * width + x] = sum;
        }
    for (int y = 0; y < height; ++y)
        for (int i = -ry; i <= ry; ++i) {
            const double* row = &middle[size_t(std::clamp(y + i, 0, height - 1)) * width];
            for (int x = 0; x < width; ++x) out[size_t(y) * width + x] += down[i + ry] * row[x];
        }
    return out;
}

// A contrast sensitivity function: the sum of two Gaussians a sqrt(pi / b) exp(-pi^2 x^2 / b), x in degrees.
struct Sensitivity {
    double a1, b1, a2, b2;
};
constexpr std::array<Sensitivity, 3> sensitivities = {
    {{1.0, 0.0047, 0.0, 1e-5}, {1.0, 0.0053, 0.0, 1e-5}, {34.1, 0.04, 13.5, 0.025}}};

Plane filter_channel(const Plane& in, int width, int height, const Sensitivity& s, double pixels_per_degree)
{
    constexpr double pi_d = 3.14159265358979323846;
    constexpr double widest = 0.04;  // one radius for all channels
    const int radius = static_cast<int>(std::ceil(3.0 * std::sqrt(widest / (2.0 * pi_d * pi_d)) * pixels_per_degree));
    Plane out(in.size());
    double total = 0.0;
    for (const auto& [a, b] : {std::pair(s.a1, s.b1), std::pair(s.a2, s.b2)}) {
        if (a == 0.0) continue;
        Taps taps;
        double sum = 0.0;
        for (int i = -radius; i <= radius; ++i) {
            taps.push_back(std::exp(-pi_d * pi_d * sqr(i / pixels_per_degree) / b));
            sum += taps.back();
        }
        // The paper's amplitude is that of the two-dimensional Gaussian.
        const double amplitude = a * std::sqrt(pi_d / b);
        total += amplitude * sum * sum;
        const Plane part = convolve(in, width, height, taps, taps);
        for (size_t i = 0; i < out.size(); ++i) out[i] += amplitude * part[i];
    }
    for (double& v : out) v /= total;
    return out;
}

struct Views {
    std::array<Plane, 3> filtered;  // YCxCz
    Plane luminance;                // (Y + 16) / 116
};

Views prepare(const Image& image, double pixels_per_degree)
{
    const size_t pixels = size_t(image.width) * image.height;
    std::array<Plane, 3> ycxcz;
    Views views;
    for (Plane& plane : ycxcz) plane.resize(pixels);
    views.luminance.resize(pixels);
    for (size_t i = 0; i < pixels; ++i) {
        Triple rgb;
        for (int c = 0; c < 3; ++c) {
            const float v = image.pixels[i * image.channels + c];
            rgb[c] = v > 0.0f ? std::min(v, 1.0f) : 0.0f;  // NaN becomes black
        }
        const Triple v = ycxcz_from_rgb(rgb);
        for (int c = 0; c < 3; ++c) ycxcz[c][i] = v[c];
        views.luminance[i] = (v[0] + 16.0) / 116.0;
    }
    for (int c = 0; c < 3; ++c)
        views.filtered[c] = filter_channel(ycxcz[c], image.width, image.height, sensitivities[c], pixels_per_degree);
    return views;
}

// Strengths of edges (first derivative of a Gaussian) or points (second): the gradient's length at each pixel.
Plane feature_strength(const Plane& luminance, int width, int height, bool points, double pixels_per_degree)
{
    const double sigma = 0.5 * 0.082 * pixels_per_degree;
    const int radius = static_cast<int>(std::ceil(3.0 * sigma));
    Taps smooth, derivative;
    double smooth_sum = 0.0, positive = 0.0, negative = 0.0;
    for (int i = -radius; i <= radius; ++i) {
        const double gaussian = std::exp(-0.5 * sqr(i / sigma));
        smooth.push_back(gaussian);
        smooth_sum += gaussian;
        derivative.push_back(gaussian * (points ? sqr(i / sigma) - 1.0 : -i));
        (derivative.back() > 0.0 ? positive : negative) += std::fabs(derivative.back());
    }
    for (double& v : smooth) v /= smooth_sum;
    for (double& v : derivative) v /= v > 0.0 ? positive : negative;
    const Plane across = convolve(luminance, width, height, derivative, smooth);
    const Plane down = convolve(luminance, width, height, smooth, derivative);
    Plane strength(across.size());
    for (size_t i = 0; i < strength.size(); ++i) strength[i] = std::hypot(across[i], down[i]);
    return strength;
}

// The HyAB distance to the power 0.7, mapped so that 0.4 of the largest goes to 0.95 and the largest to 1.
double color_error(double distance)
{
    static const double largest = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), 0.7);
    const double knee = 0.4 * largest, error = std::pow(distance, 0.7);
    return error < knee ? 0.95 / knee * error : 0.95 + 0.05 * (error - knee) / (largest - knee);
}

}  // namespace

FlipResult flip(const Image& test, const Image& reference, float pixels_per_degree)
{
    if (test.width != reference.width || test.height != reference.height || test.empty())
        throw UserError("FLIP needs two images of one size");
    if (test.channels < 3 || reference.channels < 3) throw UserError("FLIP needs images of three channels");
    if (!(pixels_per_degree > 0.0f)) throw UserError("FLIP needs a positive number of pixels per degree");

    const int width = test.width, height = test.height;
    const Views a = prepare(test, pixels_per_degree), b = prepare(reference, pixels_per_degree);
    FlipResult result;
    result.map = Image(width, height, 1);
    std::vector<double> features(result.map.pixels.size());
    for (const bool points : {false, true}) {
        const Plane fa = feature_strength(a.luminance, width, height, points, pixels_per_degree);
        const Plane fb = feature_strength(b.luminance, width, height, points, pixels_per_degree);
        for (size_t i = 0; i < features.size(); ++i) features[i] = std::max(features[i], std::fabs(fa[i] - fb[i]));
    }
    double sum = 0.0;
    for (size_t i = 0; i < features.size(); ++i) {
        const Triple lab_a = hunt_lab(rgb_from_ycxcz({a.filtered[0][i], a.filtered[1][i], a.filtered[2][i]}));
        const Triple lab_b = hunt_lab(rgb_from_ycxcz({b.filtered[0][i], b.filtered[1][i], b.filtered[2][i]}));
        const double feature = std::min(1.0, std::sqrt(features[i] * std::sqrt(0.5)));
        const double error = std::pow(std::min(1.0, color_error(hyab(lab_a, lab_b))), 1.0 - feature);
        result.map.pixels[i] = static_cast<float>(error);
        sum += error;
    }
    result.mean = sum / static_cast<double>(features.size());
    return result;
}

}  // namespace dapple
