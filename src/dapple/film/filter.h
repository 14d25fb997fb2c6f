// Pixel filters: sampled for eye paths, evaluated for splats, normalised to integrate to 1 over the raster.
#pragma once

#include "dapple/math/vec.h"

#include <cstdint>

namespace dapple {

struct Filter {
    enum class Kind : uint8_t { box, triangle, gaussian, mitchell, sinc };
    Kind kind = Kind::gaussian;
    Vec2 radius{1.5f, 1.5f};  // [pixels]
    float sigma = 0.5f;       // gaussian
    float b = 1.0f / 3.0f, c = 1.0f / 3.0f;  // mitchell
    float tau = 3.0f;         // sinc

    // The filter's value at an offset from the pixel's centre, normalised: integrates to 1 [1/pixel^2].
    float evaluate(const Vec2& offset) const;

    struct Sample {
        Vec2 offset;
        float weight;  // value / density; +-const, 1 for non-negative filters
    };
    // An offset drawn in proportion to |value|.
    Sample sample(const Vec2& u) const;
};

}  // namespace dapple
