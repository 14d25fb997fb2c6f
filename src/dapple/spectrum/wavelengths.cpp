// Sampling of wavelengths (see wavelengths.h): the density c / cosh^2(a (lambda - 538)) inverted in closed form.
#include "dapple/spectrum/wavelengths.h"

namespace dapple {

Wavelengths Wavelengths::sample_visible(float u)
{
    Wavelengths result;
    for (int i = 0; i < Spectrum::lanes; ++i) {
        float offset = u + static_cast<float>(i) / Spectrum::lanes;
        if (offset >= 1.0f) offset -= 1.0f;
        const float x = 0.85691062f - 1.82750197f * offset;
        // 1 / 0.0072 = 138.888889, times artanh x = log((1 + x) / (1 - x)) / 2
        const float lambda = 538.0f - 69.4444444f * std::log((1.0f + x) / (1.0f - x));
        result.lambda[i] = std::clamp(lambda, lambda_min, lambda_max);
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
