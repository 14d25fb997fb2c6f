// A spectral quantity as the compiled world holds it: small, trivially copyable, evaluated in either colour model.
#pragma once

#include "dapple/math/vec.h"
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
    uint32_t table = 0;       // index of a table in the pool
    float scale = 0.0f;
    float c[3] = {0, 0, 0};   // sigmoid polynomial in wavelength [nm]
    Vec3 rgb{0, 0, 0};        // the same quantity (scale included) as linear sRGB, for the rgb model
};

inline constexpr int spectrum_table_size = 471;  // 360..830 nm in steps of 1 nm

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

private:
    std::vector<float> tables_;
};

}  // namespace dapple
