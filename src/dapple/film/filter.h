// Pixel filters: sampled for eye paths, evaluated for splats, normalised to integrate to 1 over the raster.
// All are separable. Per axis the filter is tabulated and is by definition the linear interpolation of its table (exact
// for box and triangle; the others are within 2e-4 of the formula's peak), so that evaluation, density and
// normalisation agree to rounding. Measured: evaluate 4 ns an axis, sample 60 ns for both.
#pragma once

#include "dapple/math/vec.h"

#include <array>
#include <cstdint>

namespace dapple {

// What the user chooses; pbrt's names, meanings and defaults (see default_radius).
struct FilterShape {
    enum class Kind : uint8_t { box, triangle, gaussian, mitchell, sinc };
    Kind kind = Kind::gaussian;
    Vec2 radius{1.5f, 1.5f};                 // [pixels]
    float sigma = 0.5f;                      // gaussian [pixels]
    float b = 1.0f / 3.0f, c = 1.0f / 3.0f;  // mitchell
    float tau = 3.0f;                        // sinc: the window's first zero [pixels]

    // box 0.5, triangle 2, gaussian 1.5, mitchell 2, sinc 4 [pixels]
    static Vec2 default_radius(Kind kind);
};

class Filter {
public:
    using Kind = FilterShape::Kind;
    static constexpr float max_radius = 16.0f;  // [pixels]

    // Throws UserError for a radius outside of (0, max_radius], a sigma or tau that is not positive, or a filter whose
    // integral is not positive.
    Filter(const FilterShape& shape = {});

    const FilterShape& shape() const { return shape_; }
    const Vec2& radius() const { return shape_.radius; }

    // The filter's value at an offset from the pixel's centre [pixels], normalised: integrates to 1 [1/pixel^2].
    // The support is half open, -radius <= offset < radius, so that boxes tile the raster.
    float evaluate(const Vec2& offset) const { return x_.evaluate(offset.x) * y_.evaluate(offset.y); }
    // One axis' factor of evaluate [1/pixel]; axis 0 is x.
    float evaluate_axis(int axis, float offset) const { return (axis == 0 ? x_ : y_).evaluate(offset); }

    struct Sample {
        Vec2 offset;   // [pixels]
        float weight;  // value / density; +-const, 1 for non-negative filters
    };
    // An offset drawn in proportion to |value|; u in [0, 1)^2.
    Sample sample(const Vec2& u) const;

private:
    // The even function of one axis, on [0, radius].
    struct Axis {
        static constexpr int cells = 256;
        float radius = 0.0f;
        float to_cell = 0.0f;                // cells / radius
        float weight = 1.0f;                 // integral of |f| over integral of f
        std::array<float, cells + 1> value;  // at cell borders
        std::array<float, cells + 1> cdf;    // of |f|, from 0 to 1
        std::array<uint8_t, cells> guide;    // the last cell that begins at or below k / cells: where a search starts

        void build(const FilterShape& shape, float axis_radius);
        float evaluate(float offset) const
        {
            if (!(offset >= -radius && offset < radius)) return 0.0f;
            const float position = std::fabs(offset) * to_cell;
            const int cell = std::min(static_cast<int>(position), cells - 1);
            return lerp(position - static_cast<float>(cell), value[cell], value[cell + 1]);
        }
        // Returns the offset; multiplies `sample_weight` with the weight and the sign of the value there.
        float sample(float u, float& sample_weight) const;
    };

    FilterShape shape_;
    Axis x_, y_;
};

}  // namespace dapple
