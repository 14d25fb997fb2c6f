// A spectral quantity as the compiled world holds it: small, trivially copyable, evaluated in either colour model.
// Made by make_spectrum.h. Cost of an evaluation: nothing (constant), one square root and division per lane (colours),
// one interpolation per lane (tables).
#pragma once

#include "dapple/math/vec.h"
#include "dapple/spectrum/color_space.h"
#include "dapple/spectrum/sigmoid.h"
#include "dapple/spectrum/wavelengths.h"

#include <cstdint>
#include <vector>

namespace dapple {

struct SpectrumValue {
    enum class Kind : uint8_t {
        constant,    // scale
        albedo,      // scale * sigmoid(c)                      reflectance from RGB (Jakob and Hanika 2019)
        illuminant,  // scale * sigmoid(c) * table              light from RGB: times the colour space's white
        table,       // scale * table                           measured, 1 nm steps
    };
    Kind kind = Kind::constant;
    uint32_t table = 0;  // index of a table in the pool
    float scale = 0.0f;
    float c[3] = {0, 0, 0};  // sigmoid polynomial in wavelength [nm]
    Vec3 rgb{0, 0, 0};       // the same quantity (scale included) as linear sRGB, for the rgb model
};

// The quantity times a factor, in both colour models.
inline SpectrumValue scaled(SpectrumValue value, float factor)
{
    value.scale *= factor;
    value.rgb *= factor;
    return value;
}

inline constexpr int spectrum_table_size = 471;  // 360..830 nm in steps of 1 nm

// How the RGB of a pixel is read as a spectrum (see make_spectrum.h for the same of constants).
enum class RgbUse : uint8_t { albedo, unbounded, illuminant };

// Owns the tables that SpectrumValues refer to. Filled while compiling, then read only.
class SpectrumPool {
public:
    SpectrumPool();

    // The quantity at the four wavelengths (spectral) or as r, g, b, g (rgb model).
    Spectrum evaluate(const SpectrumValue& value, const Wavelengths& wavelengths) const;
    // The quantity at one wavelength [nm] (spectral model).
    float evaluate(const SpectrumValue& value, float lambda) const;

    // Adds a table of spectrum_table_size values and returns its index (equal tables are shared).
    uint32_t add_table(const std::vector<float>& values);

    // Sets the colour space of the RGB of images and builds its table of spectra. Without this call images are sRGB and
    // evaluate_rgb solves for each pixel anew: right, but a hundred times slower.
    void prepare_rgb(const ColorSpace& space);
    // The spectrum of a pixel in the colour space of prepare_rgb, as make_albedo, make_unbounded and make_illuminant
    // give it (the last not yet divided by a photometric scale). Pixels that are not finite are black.
    Spectrum evaluate_rgb(RgbUse use, const Vec3& rgb, const Wavelengths& wavelengths) const;

private:
    float table_at(uint32_t table, float lambda) const
    {
        const float x = std::clamp(lambda - lambda_min, 0.0f, lambda_max - lambda_min);
        const int i = std::min(static_cast<int>(x), spectrum_table_size - 2);
        const float* values = tables_.data() + static_cast<size_t>(table) * spectrum_table_size + i;
        return lerp(x - static_cast<float>(i), values[0], values[1]);
    }

    // The same at four wavelengths.
    Spectrum table_at(uint32_t table, const float* lambda) const
    {
        const float* values = tables_.data() + static_cast<size_t>(table) * spectrum_table_size;
        Spectrum t, low, high;
        for (int i = 0; i < Spectrum::lanes; ++i) {
            const float x = std::min(std::max(lambda[i] - lambda_min, 0.0f), lambda_max - lambda_min);
            const int cell = std::min(static_cast<int>(x), spectrum_table_size - 2);
            t[i] = x - static_cast<float>(cell);
            low[i] = values[cell];
            high[i] = values[cell + 1];
        }
        return low * (Spectrum(1.0f) - t) + high * t;  // lerp
    }

    std::vector<float> tables_;
    const ColorSpace* image_space_;
    const SigmoidTable* image_sigmoids_ = nullptr;
    uint32_t image_white_ = 0;
};

inline float SpectrumPool::evaluate(const SpectrumValue& value, float lambda) const
{
    if (value.kind == SpectrumValue::Kind::constant) return value.scale;
    float result = value.scale;
    if (value.kind != SpectrumValue::Kind::table)
        result *= SigmoidCoefficients{{value.c[0], value.c[1], value.c[2]}}.at(lambda);
    if (value.kind != SpectrumValue::Kind::albedo) result *= table_at(value.table, lambda);
    return result;
}

inline Spectrum SpectrumPool::evaluate(const SpectrumValue& value, const Wavelengths& wavelengths) const
{
    if (wavelengths.model == ColorModel::rgb) return {value.rgb.x, value.rgb.y, value.rgb.z, value.rgb.y};
    if (value.kind == SpectrumValue::Kind::constant) return Spectrum(value.scale);
    Spectrum result(value.scale);
    if (value.kind != SpectrumValue::Kind::table) {
        const SigmoidCoefficients sigmoid{{value.c[0], value.c[1], value.c[2]}};
        for (int i = 0; i < Spectrum::lanes; ++i) result.v[i] *= sigmoid.at(wavelengths.lambda[i]);
    }
    if (value.kind != SpectrumValue::Kind::albedo) result *= table_at(value.table, wavelengths.lambda);
    return result;
}

}  // namespace dapple
