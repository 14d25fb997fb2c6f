// Sampling of wavelengths (see wavelengths.h): the density c / cosh^2(a (lambda - 538)) inverted in closed form.
#include "dapple/spectrum/wavelengths.h"

#include <bit>
#include <cstdint>

namespace dapple {

namespace {

// Natural logarithm of a positive normal float, within 2 units in the last place of 1: written without branches, so
// that the compiler takes four at once. The mantissa m in [sqrt(1/2), sqrt(2)) has log m = 2 artanh((m - 1) / (m + 1)).
inline float log_positive(float x)
{
    constexpr int32_t root_half = 0x3f3504f3;  // bits of sqrt(1/2)
    const int32_t bits = std::bit_cast<int32_t>(x) - root_half;
    const auto exponent = static_cast<float>(bits >> 23);
    const float m = std::bit_cast<float>((bits & 0x7fffff) + root_half);
    const float s = (m - 1.0f) / (m + 1.0f);
    const float s2 = s * s;
    const float series = (((s2 * (1.0f / 9.0f) + 1.0f / 7.0f) * s2 + 0.2f) * s2 + 1.0f / 3.0f) * s2 + 1.0f;
    return exponent * 0.693147181f + 2.0f * s * series;
}

}  // namespace

Wavelengths Wavelengths::sample_visible(float u)
{
    Wavelengths result;
    for (int i = 0; i < Spectrum::lanes; ++i) {
        const float shifted = u + static_cast<float>(i) / Spectrum::lanes;
        const float offset = shifted - (shifted >= 1.0f ? 1.0f : 0.0f);
        const float x = 0.85691062f - 1.82750197f * offset;
        // 1 / 0.0072 = 138.888889, times artanh x = log((1 + x) / (1 - x)) / 2
        const float lambda = 538.0f - 69.4444444f * log_positive((1.0f + x) / (1.0f - x));
        result.lambda[i] = std::min(std::max(lambda, lambda_min), lambda_max);
        result.pdf[i] = 0.0039398042f * (1.0f - x * x);  // cosh(artanh x)^2 = 1 / (1 - x^2)
    }
    return result;
}

Wavelengths Wavelengths::rgb()
{
    Wavelengths result;
    result.model = ColorModel::rgb;
    return result;
}

}  // namespace dapple
