// Fitting of sigmoid spectra (see sigmoid.h): damped Gauss-Newton (Levenberg 1944, Marquardt 1963) on the difference in
// CIE L*a*b*, with the polynomial in a wavelength scaled to [-1, 1]. Integrals use 95 nodes 5 nm apart whose weights
// integrate piecewise linear reflectances exactly against the 1 nm tables of observer and white.
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

constexpr int node_step = 5;
constexpr int node_count = (spectrum_table_size - 1) / node_step + 1;
constexpr double lambda_centre = 0.5 * (lambda_min + lambda_max);
constexpr double lambda_half = 0.5 * (lambda_max - lambda_min);
// Beyond this a spectrum is a box to within the grid, and a float polynomial in nm loses its digits.
constexpr double largest_coefficient = 200.0;

// Stands for infinity: exact 0 and 1 after the sigmoid, but no NaN.
constexpr float saturated = 1e15f;

class Fitter {
public:
    explicit Fitter(const ColorSpace& space) : xyz_from_rgb_(space.xyz_from_rgb)
    {
        const auto& matching = cie_matching_functions();
        for (int k = 0; k < node_count; ++k) t_[k] = (lambda_min + node_step * k - lambda_centre) / lambda_half;
        for (int i = 0; i < spectrum_table_size; ++i) {
            const int k = std::min(i / node_step, node_count - 2);
            const double f = static_cast<double>(i) / node_step - k;
            for (size_t c = 0; c < 3; ++c) {
                const double w = static_cast<double>(matching[c][i]) * space.illuminant[i] / cie_y_integral;
                weight_[c][k] += (1.0 - f) * w;
                weight_[c][k + 1] += f * w;
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
        for (int iteration = 0; iteration < 60 && error > 1e-12; ++iteration) {
            const Triple step = damped_step(jacobian, residual, damping);
            Triple next;
            for (int i = 0; i < 3; ++i) next[i] = std::clamp(a[i] - step[i], -largest_coefficient, largest_coefficient);
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
        constexpr int ways = 4;
        double sums[12][ways] = {};
        for (int k = 0; k < padded_nodes; k += ways)
            for (int w = 0; w < ways; ++w) {
                const double t = t_[k + w];
                const double x = (a[0] * t + a[1]) * t + a[2];
                const double inverse = 1.0 / std::sqrt(1.0 + x * x);
                const double s = 0.5 + 0.5 * x * inverse;
                const double slope = 0.5 * inverse * inverse * inverse;
                for (int c = 0; c < 3; ++c) {
                    const double weighted = weight_[c][k + w] * slope;
                    sums[c * 4][w] += weight_[c][k + w] * s;
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

    static constexpr int padded_nodes = (node_count + 3) / 4 * 4;

    Matrix3 xyz_from_rgb_;
    std::array<double, padded_nodes> t_{};
    std::array<std::array<double, padded_nodes>, 3> weight_{};
    Triple white_{};
};

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
    return fitters.try_emplace(space.name, space).first->second;
}

double smoothstep(double x) { return x * x * (3.0 - 2.0 * x); }

// The smallest value of the largest channel that the table holds; darker colours are as good as black.
constexpr float darkest = 2e-6f;

}  // namespace

SigmoidCoefficients rgb_to_sigmoid(const ColorSpace& space, const Vec3& rgb)
{
    const Vec3 color(clamp01(rgb.x), clamp01(rgb.y), clamp01(rgb.z));
    if (color.x == color.y && color.y == color.z) return {{0.0f, 0.0f, grey_coefficient(color.x)}};
    if (max_component(color) < darkest) return {{0.0f, 0.0f, -saturated}};
    Triple a = start(color);
    fitter(space).solve(color, a);
    const auto c = in_nanometres(a);
    return {{c[0], c[1], c[2]}};
}

SigmoidTable::SigmoidTable(const ColorSpace& space) : entries_(size_t{3} * resolution * resolution * resolution)
{
    const double last = resolution - 1;
    for (int z = 0; z < resolution; ++z) values_[z] = static_cast<float>(smoothstep(smoothstep(z / last)));
    values_[0] = darkest;

    const Fitter& fit = fitter(space);
    // One column of values of the largest channel at a time, outwards from the middle: neighbours start near the
    // answer.
    parallel_for(int64_t{3} * resolution * resolution, 16, [&](int64_t column) {
        const int x = static_cast<int>(column % resolution);
        const int y = static_cast<int>(column / resolution % resolution);
        const int channel = static_cast<int>(column / (resolution * resolution));
        const auto color_at = [&](int z) {
            Vec3 color;
            color[channel] = values_[z];
            color[(channel + 1) % 3] = values_[z] * static_cast<float>(x / last);
            color[(channel + 2) % 3] = values_[z] * static_cast<float>(y / last);
            return color;
        };
        const auto sweep = [&](int from, int to, int direction) {
            Triple a = start(color_at(from));
            for (int z = from; z != to; z += direction) {
                fit.solve(color_at(z), a);
                entries_[static_cast<size_t>(((channel * resolution + z) * resolution + y) * resolution + x)] =
                    in_nanometres(a);
            }
        };
        sweep(resolution / 2, resolution, 1);
        sweep(resolution / 2, -1, -1);
    });
}

SigmoidCoefficients SigmoidTable::lookup(const Vec3& rgb) const
{
    const Vec3 color(clamp01(rgb.x), clamp01(rgb.y), clamp01(rgb.z));
    if (color.x == color.y && color.y == color.z) return {{0.0f, 0.0f, grey_coefficient(color.x)}};

    const int channel = color.x > color.y ? (color.x > color.z ? 0 : 2) : (color.y > color.z ? 1 : 2);
    const float value = color[channel];
    if (value < darkest) return {{0.0f, 0.0f, -saturated}};
    const float x = color[(channel + 1) % 3] / value * (resolution - 1);
    const float y = color[(channel + 2) % 3] / value * (resolution - 1);
    const int xi = std::min(static_cast<int>(x), resolution - 2);
    const int yi = std::min(static_cast<int>(y), resolution - 2);
    const auto above = std::upper_bound(values_.begin(), values_.end(), value);
    const int zi = std::clamp(static_cast<int>(above - values_.begin()) - 1, 0, resolution - 2);
    const float dx = x - static_cast<float>(xi), dy = y - static_cast<float>(yi);
    const float dz = (value - values_[zi]) / (values_[zi + 1] - values_[zi]);

    SigmoidCoefficients result;
    for (int i = 0; i < 3; ++i) {
        const auto at = [&](int oz, int oy, int ox) { return entry(channel, zi + oz, yi + oy, xi + ox)[i]; };
        const auto face = [&](int oz) {
            return lerp(dy, lerp(dx, at(oz, 0, 0), at(oz, 0, 1)), lerp(dx, at(oz, 1, 0), at(oz, 1, 1)));
        };
        result.c[i] = lerp(dz, face(0), face(1));
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
