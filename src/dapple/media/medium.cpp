// Coefficients and emission at a point (semantics of pbrt-v4's media; see medium.h).
// Emission is sigma_a Le: a medium in local equilibrium at the temperature of Le (Kirchhoff), so that an optically
// thick one shows Le itself.

#include "dapple/media/medium.h"

#include "dapple/media/grid.h"
#include "dapple/spectrum/photometry.h"

namespace dapple {

namespace {

bool present(uint32_t index) { return index != Id<int>::none_value; }

// pbrt-v4 lets nothing cooler than this glow [K].
constexpr float coolest = 100.0f;

// Blackbody radiation relative to its largest value over wavelengths.
Spectrum relative_blackbody(const Media& media, float kelvin, const Wavelengths& wavelengths)
{
    if (wavelengths.model == ColorModel::rgb) {
        const float x = std::clamp(std::log2(kelvin / coolest) * blackbody_steps_per_octave, 0.0f,
                                   static_cast<float>(media.blackbody_rgb.size() - 1));
        const size_t i = std::min(static_cast<size_t>(x), media.blackbody_rgb.size() - 2);
        const Vec3 rgb = lerp(x - static_cast<float>(i), media.blackbody_rgb[i], media.blackbody_rgb[i + 1]);
        return {rgb.x, rgb.y, rgb.z, rgb.y};
    }
    const float peak = blackbody(blackbody_peak(kelvin), kelvin);
    Spectrum result;
    for (int i = 0; i < Spectrum::lanes; ++i) result[i] = blackbody(wavelengths.lambda[i], kelvin) / peak;
    return result;
}

Vec3 lookup_rgb(const Grid& grid, const Vec3& p)
{
    const auto value = lookup_grid<3>(grid, p);
    return {std::max(0.0f, value[0]), std::max(0.0f, value[1]), std::max(0.0f, value[2])};
}

// Le of a uniform_grid at p in the unit cube.
Spectrum grid_emission(const Media& media, const SpectrumPool& pool, const Medium& medium, const Vec3& p,
                       const Wavelengths& wavelengths)
{
    const float scale =
        present(medium.emission_scale) ? lookup_grid<1>(media.grids[medium.emission_scale], p)[0] : 1.0f;
    if (!(scale > 0.0f)) return Spectrum(0.0f);
    if (!present(medium.temperature)) return pool.evaluate(medium.emission, wavelengths) * scale;
    const float kelvin =
        (lookup_grid<1>(media.grids[medium.temperature], p)[0] - medium.temperature_offset) * medium.temperature_scale;
    if (!(kelvin > coolest)) return Spectrum(0.0f);
    return relative_blackbody(media, kelvin, wavelengths) * (scale * medium.emission_grid_scale);
}

}  // namespace

bool Medium::emits() const
{
    constexpr uint32_t none = Id<int>::none_value;
    return emission.scale != 0.0f || temperature != none || emission_grid != none;
}

bool Medium::scatters() const { return kind == Kind::rgb_grid ? sigma_scale != 0.0f : sigma_s.scale != 0.0f; }

MediumPoint evaluate(const Media& media, const SpectrumPool& pool, const Medium& medium, const Vec3& p,
                     const Wavelengths& wavelengths)
{
    if (medium.kind == Medium::Kind::homogeneous) {
        MediumPoint point{pool.evaluate(medium.sigma_a, wavelengths), pool.evaluate(medium.sigma_s, wavelengths), {}};
        point.emission = point.sigma_a * pool.evaluate(medium.emission, wavelengths);
        return point;
    }
    const Vec3 unit = (medium.medium_from_world.point(p) - medium.grid_bounds.min) /
                      (medium.grid_bounds.max - medium.grid_bounds.min);
    if (medium.kind == Medium::Kind::uniform_grid) {
        const float density = lookup_grid<1>(media.grids[medium.density], unit)[0];
        if (!(density > 0.0f)) return {};
        MediumPoint point{pool.evaluate(medium.sigma_a, wavelengths) * density,
                          pool.evaluate(medium.sigma_s, wavelengths) * density,
                          {}};
        point.emission = point.sigma_a * grid_emission(media, pool, medium, unit, wavelengths);
        return point;
    }
    const auto coefficient = [&](uint32_t grid) {
        if (!present(grid)) return Spectrum(medium.sigma_scale);
        return pool.evaluate_rgb(RgbUse::unbounded, lookup_rgb(media.grids[grid], unit), wavelengths) *
               medium.sigma_scale;
    };
    MediumPoint point{coefficient(medium.sigma_a_grid), coefficient(medium.sigma_s_grid), {}};
    if (present(medium.emission_grid))
        point.emission =
            point.sigma_a *
            pool.evaluate_rgb(RgbUse::illuminant, lookup_rgb(media.grids[medium.emission_grid], unit), wavelengths) *
            medium.emission_grid_scale;
    return point;
}

}  // namespace dapple
