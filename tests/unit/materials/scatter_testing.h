// What the tests of scattering share: a gallery of Bsdfs, quadrature over directions, and a chi-squared test.
#pragma once

#include "dapple/materials/bsdf.h"
#include "dapple/math/hash.h"

#include <cmath>
#include <string>
#include <vector>

namespace dapple::testing {

// Independent numbers from a counter.
class Numbers {
public:
    explicit Numbers(uint64_t seed) : state_(mix64(seed)) {}
    float next() { return to_unit_float(mix64(state_++)); }
    Vec2 next_2d()
    {
        const float x = next();
        return {x, next()};
    }
    Vec3 direction()
    {
        const float z = 1.0f - 2.0f * next();
        return spherical_direction(std::sqrt(1.0f - z * z), z, 2.0f * pi * next());
    }

private:
    uint64_t state_;
};

struct NamedBsdf {
    std::string name;
    Bsdf bsdf;
};

inline Bsdf make_dielectric(float eta, Roughness roughness)
{
    Bsdf bsdf;
    bsdf.kind = BsdfKind::dielectric;
    bsdf.eta = eta;
    bsdf.roughness = roughness;
    return bsdf;
}

inline Bsdf make_conductor(Roughness roughness)
{
    Bsdf bsdf;
    bsdf.kind = BsdfKind::conductor;
    bsdf.a = Spectrum(0.2f, 0.9f, 1.4f, 2.0f);
    bsdf.b = Spectrum(3.9f, 2.4f, 7.0f, 1.5f);
    bsdf.roughness = roughness;
    return bsdf;
}

inline Bsdf make_diffuse(const Spectrum& reflectance)
{
    Bsdf bsdf;
    bsdf.kind = BsdfKind::diffuse;
    bsdf.a = reflectance;
    return bsdf;
}

inline Bsdf make_diffuse_transmission()
{
    Bsdf bsdf;
    bsdf.kind = BsdfKind::diffuse_transmission;
    bsdf.a = Spectrum(0.3f, 0.1f, 0.2f, 0.25f);
    bsdf.b = Spectrum(0.5f, 0.6f, 0.4f, 0.1f);
    return bsdf;
}

inline Bsdf make_coated_diffuse(float eta, Roughness coat, float thickness, const Spectrum& reflectance)
{
    Bsdf bsdf = make_diffuse(reflectance);
    bsdf.kind = BsdfKind::coated_diffuse;
    bsdf.eta = eta;
    bsdf.roughness = coat;
    bsdf.layer_thickness = thickness;
    return bsdf;
}

inline Bsdf make_coated_conductor(Roughness coat, Roughness base)
{
    Bsdf bsdf = make_conductor(coat);
    bsdf.kind = BsdfKind::coated_conductor;
    bsdf.base_roughness = base;
    bsdf.eta = 1.5f;
    return bsdf;
}

inline std::vector<NamedBsdf> smooth_and_rough(const std::string& name, Bsdf (*make)(Roughness))
{
    return {{name + " 0.02", make({0.02f, 0.02f})},
            {name + " 0.1", make({0.1f, 0.1f})},
            {name + " 0.5", make({0.5f, 0.5f})},
            {name + " 0.4 x 0.08", make({0.4f, 0.08f})}};
}

// Everything that is neither a delta nor layered.
inline std::vector<NamedBsdf> plain_bsdfs()
{
    std::vector<NamedBsdf> all = {{"diffuse", make_diffuse(Spectrum(0.2f, 0.4f, 0.6f, 0.8f))},
                                  {"diffuse transmission", make_diffuse_transmission()}};
    for (const auto& list : {smooth_and_rough("conductor", make_conductor),
                             smooth_and_rough("glass", [](Roughness r) { return make_dielectric(1.5f, r); }),
                             smooth_and_rough("air bubble", [](Roughness r) { return make_dielectric(0.75f, r); })})
        all.insert(all.end(), list.begin(), list.end());
    return all;
}

// A spread of directions on both sides: steep, oblique, grazing.
inline std::vector<Vec3> view_directions()
{
    return {normalize(Vec3(0.05f, -0.1f, 1.0f)), normalize(Vec3(-0.9f, 0.5f, 0.6f)), normalize(Vec3(0.7f, 0.9f, -0.8f)),
            normalize(Vec3(0.3f, -1.0f, 0.12f))};
}

// A grid of cells over the sphere, equal in solid angle.
struct SphereGrid {
    static constexpr int rows = 48;
    static constexpr int columns = 96;
    static constexpr int cells = rows * columns;
    static constexpr double cell_area = 4.0 * 3.14159265358979 / cells;

    static Vec3 direction(double row, double column)
    {
        const double z = 1.0 - 2.0 * row / rows;
        const double angle = 2.0 * 3.14159265358979 * column / columns;
        const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
        return Vec3(float(r * std::cos(angle)), float(r * std::sin(angle)), float(z));
    }
    static int cell(const Vec3& w)
    {
        const int row = std::clamp(int((1.0 - double(w.z)) * 0.5 * rows), 0, rows - 1);
        double fraction = std::atan2(double(w.y), double(w.x)) / (2.0 * 3.14159265358979);
        if (fraction < 0.0) fraction += 1.0;
        return row * columns + std::min(int(fraction * columns), columns - 1);
    }
};

namespace detail {

template <class Function>
double patch(const Function& f, double row, double column, double size, int n)
{
    double sum = 0.0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            sum += f(SphereGrid::direction(row + size * (i + 0.5) / n, column + size * (j + 0.5) / n));
    return sum / (n * n) * size * size;
}

template <class Function>
double adaptive_patch(const Function& f, double row, double column, double size, double coarse, double tolerance,
                      int depth)
{
    const double half = size / 2.0;
    double parts[4], fine = 0.0;
    for (int i = 0; i < 4; ++i) fine += parts[i] = patch(f, row + half * (i & 1), column + half * (i >> 1), half, 2);
    if (depth == 0 || std::fabs(fine - coarse) < tolerance) return fine;
    double sum = 0.0;
    for (int i = 0; i < 4; ++i)
        sum += adaptive_patch(f, row + half * (i & 1), column + half * (i >> 1), half, parts[i], tolerance / 2.0,
                              depth - 1);
    return sum;
}

}  // namespace detail

// The integral of f over solid angle, per cell of the grid.
template <class Function>
std::vector<double> integrate_cells(const Function& f, double tolerance = 1e-3)
{
    std::vector<double> result(SphereGrid::cells);
    for (int row = 0; row < SphereGrid::rows; ++row)
        for (int column = 0; column < SphereGrid::columns; ++column) {
            const double coarse = detail::patch(f, row, column, 1.0, 3);
            result[row * SphereGrid::columns + column] =
                SphereGrid::cell_area * detail::adaptive_patch(f, row, column, 1.0, coarse, tolerance, 7);
        }
    return result;
}

// Probability that counts as far off as these come from a multinomial with the expected means. Cells that expect few
// are pooled. The chi-squared tail is that of Wilson and Hilferty 1931.
inline double chi_squared_p_value(const std::vector<double>& observed, const std::vector<double>& expected)
{
    double statistic = 0.0, pooled_observed = 0.0, pooled_expected = 0.0;
    int terms = 0;
    const auto add = [&](double o, double e) {
        statistic += (o - e) * (o - e) / e;
        ++terms;
    };
    for (size_t i = 0; i < observed.size(); ++i) {
        if (expected[i] >= 10.0) {
            add(observed[i], expected[i]);
        } else {
            pooled_observed += observed[i];
            pooled_expected += expected[i];
        }
    }
    if (pooled_expected >= 10.0) add(pooled_observed, pooled_expected);
    // What should never happen must not.
    else if (pooled_observed > 10.0 + 5.0 * std::sqrt(10.0))
        return 0.0;
    const double k = std::max(1, terms - 1);
    const double spread = 2.0 / (9.0 * k);
    return 0.5 * std::erfc((std::cbrt(statistic / k) - (1.0 - spread)) / std::sqrt(2.0 * spread));
}

}  // namespace dapple::testing
