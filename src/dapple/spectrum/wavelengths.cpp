// Sampling of wavelengths (see wavelengths.h): the density c / cosh^2(a (lambda - 538)) inverted in closed form.
#include "dapple/spectrum/wavelengths.h"

namespace dapple {

Wavelengths Wavelengths::sample_visible(float u)
{
    Wavelengths result;
    for (int i = 0; i < Spectrum::lanes; ++i) {
        float offset = u + static_cast<float>(i) / Spectrum::lanes;
        if (offset >= 1.0f) offset -= 1.0f;
        const float lambda = 538.0f - 138.888889f * std::atanh(0.85691062f - 1.82750197f * offset);
        result.lambda[i] = std::clamp(lambda, lambda_min, lambda_max);
        const float c = std::cosh(0.0072f * (result.lambda[i] - 538.0f));
        result.pdf[i] = 0.0039398042f / (c * c);
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
