// Fitting of sigmoid spectra (see sigmoid.h): damped Gauss-Newton (Levenberg 1944, Marquardt 1963) on the difference in
// CIE L*a*b*, with the polynomial in a wavelength scaled to [-1, 1]. Integrals use nodes whose weights integrate
// piecewise cubic reflectances exactly against the 1 nm tables of observer and white.
#include "dapple/spectrum/sigmoid.h"

#include "dapple/base/parallel.h"
#include "dapple/spectrum/spectrum_value.h"
#include "dapple/spectrum/standard_tables.h"

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>

namespace dapple {
namespace {

using Triple = std::array<double, 3>;

// Nodes of the integrals, in nm: every entry of the 1 nm tables for single colours; few, for the table of all colours.
constexpr int fine_step = 1;
constexpr int coarse_step = 5;
constexpr double lambda_centre = 0.5 * (lambda_min + lambda_max);
constexpr double lambda_half = 0.5 * (lambda_max - lambda_min);
// Beyond this a spectrum is a box to within the grid, and a float polynomial in nm loses its digits. Dark colours need
// more: a reflectance of s has a polynomial of -0.5 / sqrt(s).
double largest_coefficient(const Vec3& rgb) { return 200.0 + 5.0 / std::sqrt(static_cast<double>(max_component(rgb))); }

// Stands for infinity: exact 0 and 1 after the sigmoid, but no NaN.
constexpr float saturated = 1e15f;

class Fitter {
public:
    Fitter(const ColorSpace& space, int node_step, double tolerance)
        : xyz_from_rgb_(space.xyz_from_rgb), tolerance_(tolerance)
    {
        const int node_count = (spectrum_table_size - 1) / node_step + 1;
        const size_t padded = (static_cast<size_t>(node_count) + ways - 1) / ways * ways;
        t_.resize(padded);
        for (auto& weights : weight_) weights.resize(padded);
        for (int k = 0; k < node_count; ++k) t_[k] = (lambda_min + node_step * k - lambda_centre) / lambda_half;

        const auto& matching = cie_matching_functions();
        for (int i = 0; i < spectrum_table_size; ++i) {
            // Cubic Lagrange interpolation between four nodes; with nodes at every entry, the entry itself.
            const int first = std::clamp(i / node_step - 1, 0, node_count - 4);
            const double x = static_cast<double>(i) / node_step - first;
            const double share[4] = {-(x - 1.0) * (x - 2.0) * (x - 3.0) / 6.0, x * (x - 2.0) * (x - 3.0) / 2.0,
                                     -x * (x - 1.0) * (x - 3.0) / 2.0, x * (x - 1.0) * (x - 2.0) / 6.0};
            for (size_t c = 0; c < 3; ++c) {
                const double w = static_cast<double>(matching[c][i]) * space.illuminant[i] / cie_y_integral;
                for (int k = 0; k < 4; ++k) weight_[c][first + k] += share[k] * w;
                white_[c] += w;
            }
        }
    }

    // Improves `a` (polynomial in t) until its spectrum has the colour rgb.
    void solve(const Vec3& rgb, Triple& a) const
    {
        const Triple target = lab(to_xyz(rgb));
        Triple residual;
        Jacobian jacobian;
        double error = evaluate(a, target, residual, jacobian);
        double damping = 1e-3;
        const double limit = largest_coefficient(rgb);
        for (int iteration = 0; iteration < 60 && error > tolerance_; ++iteration) {
            const Triple step = damped_step(jacobian, residual, damping);
            Triple next;
            for (int i = 0; i < 3; ++i) next[i] = std::clamp(a[i] - step[i], -limit, limit);
            Triple next_residual;
            Jacobian next_jacobian;
            const double next_error = evaluate(next, target, next_residual, next_jacobian);
            if (next_error < error) {
                const bool stalled = next_error > error * (1.0 - 1e-4);
                a = next;
                residual = next_residual;
                jacobian = next_jacobian;
                error = next_error;
                damping = std::max(damping * 0.1, 1e-9);
                if (stalled) return;
            } else {
                damping *= 8.0;
                if (damping > 1e9) return;
            }
        }
    }

private:
    using Jacobian = std::array<Triple, 3>;

    Triple to_xyz(const Vec3& rgb) const
    {
        Triple xyz;
        for (size_t i = 0; i < 3; ++i)
            xyz[i] = static_cast<double>(xyz_from_rgb_[i][0]) * rgb.x +
                     static_cast<double>(xyz_from_rgb_[i][1]) * rgb.y +
                     static_cast<double>(xyz_from_rgb_[i][2]) * rgb.z;
        return xyz;
    }

    // The compressive function of CIE L*a*b* and its derivative.
    static double compress(double t) { return t > 216.0 / 24389.0 ? std::cbrt(t) : t * (841.0 / 108.0) + 4.0 / 29.0; }
    static double compress_slope(double t)
    {
        return t > 216.0 / 24389.0 ? 1.0 / (3.0 * std::cbrt(t) * std::cbrt(t)) : 841.0 / 108.0;
    }

    Triple lab(const Triple& xyz) const
    {
        const double fx = compress(xyz[0] / white_[0]), fy = compress(xyz[1] / white_[1]),
                     fz = compress(xyz[2] / white_[2]);
        return {116.0 * fy - 16.0, 500.0 * (fx - fy), 200.0 * (fy - fz)};
    }

    // Residual in L*a*b*, its derivatives after a, and the sum of squares. Four partial sums let the loop run in SIMD.
    double evaluate(const Triple& a, const Triple& target, Triple& residual, Jacobian& jacobian) const
    {
        double sums[12][ways] = {};
        const double a0 = a[0], a1 = a[1], a2 = a[2];
        const double* const weights[3] = {weight_[0].data(), weight_[1].data(), weight_[2].data()};
        const double* const nodes = t_.data();
        const size_t count = t_.size();
        for (size_t k = 0; k < count; k += ways)
            for (size_t w = 0; w < ways; ++w) {
                const double t = nodes[k + w];
                const double x = (a0 * t + a1) * t + a2;
                const double inverse = 1.0 / std::sqrt(1.0 + x * x);
                const double s = 0.5 + 0.5 * x * inverse;
                const double slope = 0.5 * inverse * inverse * inverse;
                for (int c = 0; c < 3; ++c) {
                    const double weighted = weights[c][k + w] * slope;
                    sums[c * 4][w] += weights[c][k + w] * s;
                    sums[c * 4 + 1][w] += weighted * t * t;
                    sums[c * 4 + 2][w] += weighted * t;
                    sums[c * 4 + 3][w] += weighted;
                }
            }
        Triple xyz;
        Jacobian d;  // of f(xyz / white) after a
        for (int c = 0; c < 3; ++c) {
            const auto total = [&](int i) { return (sums[i][0] + sums[i][1]) + (sums[i][2] + sums[i][3]); };
            xyz[c] = total(c * 4);
            const double slope = compress_slope(xyz[c] / white_[c]) / white_[c];
            for (int j = 0; j < 3; ++j) d[c][j] = slope * total(c * 4 + 1 + j);
        }
        const Triple value = lab(xyz);
        double error = 0.0;
        for (int i = 0; i < 3; ++i) {
            residual[i] = value[i] - target[i];
            error += residual[i] * residual[i];
        }
        for (int j = 0; j < 3; ++j) {
            jacobian[0][j] = 116.0 * d[1][j];
            jacobian[1][j] = 500.0 * (d[0][j] - d[1][j]);
            jacobian[2][j] = 200.0 * (d[1][j] - d[2][j]);
        }
        return error;
    }

    // Solves (J^T J + damping diag(J^T J)) step = J^T residual by Cramer's rule.
    static Triple damped_step(const Jacobian& jacobian, const Triple& residual, double damping)
    {
        Jacobian m{};
        Triple b{};
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                for (int k = 0; k < 3; ++k) m[i][j] += jacobian[k][i] * jacobian[k][j];
                b[i] += jacobian[j][i] * residual[j];
            }
        for (int i = 0; i < 3; ++i) m[i][i] += damping * m[i][i] + 1e-30;
        const auto determinant = [](const Jacobian& n) {
            return n[0][0] * (n[1][1] * n[2][2] - n[1][2] * n[2][1]) -
                   n[0][1] * (n[1][0] * n[2][2] - n[1][2] * n[2][0]) +
                   n[0][2] * (n[1][0] * n[2][1] - n[1][1] * n[2][0]);
        };
        const double whole = determinant(m);
        Triple step{};
        if (!(std::abs(whole) > 1e-200)) return step;
        for (int column = 0; column < 3; ++column) {
            Jacobian replaced = m;
            for (int i = 0; i < 3; ++i) replaced[i][column] = b[i];
            step[column] = determinant(replaced) / whole;
        }
        return step;
    }

    static constexpr size_t ways = 4;

    Matrix3 xyz_from_rgb_;
    double tolerance_;  // squared distance in L*a*b* at which a colour is met
    std::vector<double> t_;
    std::array<std::vector<double>, 3> weight_;
    Triple white_{};
};

// Components in [0, 1]; what is not a number counts as 0.
Vec3 bounded(const Vec3& rgb)
{
    const auto bound = [](float c) { return c > 0.0f ? std::min(c, 1.0f) : 0.0f; };
    return {bound(rgb.x), bound(rgb.y), bound(rgb.z)};
}

// The constant spectrum of a grey: x with sigmoid(x) = grey.
float grey_coefficient(float grey)
{
    if (grey <= 0.0f) return -saturated;
    if (grey >= 1.0f) return saturated;
    return (grey - 0.5f) / std::sqrt(grey * (1.0f - grey));
}

// From the polynomial in t = (lambda - centre) / half to one in lambda.
std::array<float, 3> in_nanometres(const Triple& a)
{
    const double p = a[0] / (lambda_half * lambda_half);
    const double q = a[1] / lambda_half;
    return {static_cast<float>(p), static_cast<float>(q - 2.0 * p * lambda_centre),
            static_cast<float>((p * lambda_centre - q) * lambda_centre + a[2])};
}

Triple start(const Vec3& rgb)
{
    const float grey = std::clamp((rgb.x + rgb.y + rgb.z) / 3.0f, 1e-6f, 1.0f - 1e-4f);
    return {0.0, 0.0, grey_coefficient(grey)};
}

const Fitter& fitter(const ColorSpace& space)
{
    static std::mutex mutex;
    static std::map<std::string_view, Fitter> fitters;
    const std::lock_guard lock(mutex);
    return fitters.try_emplace(space.name, space, fine_step, 1e-12).first->second;
}

double smoothstep(double x) { return x * x * (3.0 - 2.0 * x); }

// The smallest value of the largest channel that the table holds; darker colours are as good as black.
constexpr float darkest = 2e-6f;

// The scale on which coefficients are interpolated along the value: exact for greys.
float value_scale(float value)
{
    const float v = std::min(value, 0.9999f);
    return (v - 0.5f) / std::sqrt(v * (1.0f - v));
}

}  // namespace

SigmoidCoefficients rgb_to_sigmoid(const ColorSpace& space, const Vec3& rgb)
{
    const Vec3 color = bounded(rgb);
    if (color.x == color.y && color.y == color.z) return {{0.0f, 0.0f, grey_coefficient(color.x)}};
    if (max_component(color) < darkest) return {{0.0f, 0.0f, -saturated}};
    Triple a = start(color);
    fitter(space).solve(color, a);
    const auto c = in_nanometres(a);
    return {{c[0], c[1], c[2]}};
}

SigmoidTable::SigmoidTable(const ColorSpace& space) : entries_(index(3, 0, 0, 0))
{
    for (int z = 0; z < values; ++z) {
        const double u = static_cast<double>(z) / (values - 1);
        value_[z] = std::max(darkest, static_cast<float>(smoothstep(0.5 * (u + smoothstep(u)))));
        scale_[z] = value_scale(value_[z]);
    }
    const Fitter fit(space, coarse_step, 1e-8);
    // One column of values of the largest channel at a time, outwards from the middle: neighbours start near the
    // answer.
    parallel_for(int64_t{3} * ratios * ratios, 16, [&](int64_t column) {
        const int x = static_cast<int>(column % ratios);
        const int y = static_cast<int>(column / ratios % ratios);
        const int channel = static_cast<int>(column / (ratios * ratios));
        const auto color_at = [&](int z) {
            Vec3 color;
            color[channel] = value_[z];
            color[(channel + 1) % 3] = value_[z] * static_cast<float>(x) / (ratios - 1);
            color[(channel + 2) % 3] = value_[z] * static_cast<float>(y) / (ratios - 1);
            return color;
        };
        const auto sweep = [&](int from, int to, int direction) {
            Triple a = start(color_at(from));
            for (int z = from; z != to; z += direction) {
                fit.solve(color_at(z), a);
                entries_[index(channel, z, y, x)] = in_nanometres(a);
            }
        };
        sweep(values / 2, values, 1);
        sweep(values / 2, -1, -1);
    });
}

SigmoidCoefficients SigmoidTable::lookup(const Vec3& rgb) const
{
    const Vec3 color = bounded(rgb);
    if (color.x == color.y && color.y == color.z) return {{0.0f, 0.0f, grey_coefficient(color.x)}};

    const int channel = color.x > color.y ? (color.x > color.z ? 0 : 2) : (color.y > color.z ? 1 : 2);
    const float value = color[channel];
    if (value < darkest) return {{0.0f, 0.0f, -saturated}};
    const float x = color[(channel + 1) % 3] / value * (ratios - 1);
    const float y = color[(channel + 2) % 3] / value * (ratios - 1);
    const int xi = std::min(static_cast<int>(x), ratios - 2);
    const int yi = std::min(static_cast<int>(y), ratios - 2);
    const auto above = std::upper_bound(value_.begin(), value_.end(), value);
    const int zi = std::clamp(static_cast<int>(above - value_.begin()) - 1, 0, values - 2);
    const float dx = x - static_cast<float>(xi), dy = y - static_cast<float>(yi);
    const float dz = clamp01((value_scale(value) - scale_[zi]) / (scale_[zi + 1] - scale_[zi]));

    SigmoidCoefficients result;
    for (int i = 0; i < 3; ++i) {
        const auto at = [&](int z, int oy, int ox) { return entries_[index(channel, z, yi + oy, xi + ox)][i]; };
        const auto face = [&](int z) {
            return lerp(dy, lerp(dx, at(z, 0, 0), at(z, 0, 1)), lerp(dx, at(z, 1, 0), at(z, 1, 1)));
        };
        result.c[i] = lerp(dz, face(zi), face(zi + 1));
    }
    return result;
}

const SigmoidTable& sigmoid_table(const ColorSpace& space)
{
    static std::mutex mutex;
    static std::map<std::string_view, std::unique_ptr<SigmoidTable>> tables;
    const std::lock_guard lock(mutex);
    auto& table = tables[space.name];
    if (!table) table = std::make_unique<SigmoidTable>(space);
    return *table;
}

}  // namespace dapple
