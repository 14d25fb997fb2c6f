// The pool of spectral tables (see spectrum_value.h).
#include "dapple/spectrum/spectrum_value.h"

#include "dapple/base/assert.h"
#include "dapple/spectrum/standard_tables.h"

namespace dapple {

SpectrumPool::SpectrumPool() : image_space_(&srgb()) { image_white_ = add_table(image_space_->illuminant); }

uint32_t SpectrumPool::add_table(const std::vector<float>& values)
{
    DAPPLE_ASSERT(values.size() == spectrum_table_size);
    for (size_t first = 0; first < tables_.size(); first += spectrum_table_size)
        if (std::equal(values.begin(), values.end(), tables_.begin() + static_cast<ptrdiff_t>(first)))
            return static_cast<uint32_t>(first / spectrum_table_size);
    tables_.insert(tables_.end(), values.begin(), values.end());
    return static_cast<uint32_t>(tables_.size() / spectrum_table_size - 1);
}

void SpectrumPool::prepare_rgb(const ColorSpace& space)
{
    image_space_ = &space;
    image_sigmoids_ = &sigmoid_table(space);
    image_white_ = add_table(space.illuminant);
}

Spectrum SpectrumPool::evaluate_rgb(RgbUse use, const Vec3& rgb, const Wavelengths& wavelengths) const
{
    if (wavelengths.model == ColorModel::rgb) {
        Vec3 color = to_srgb(*image_space_, rgb);
        for (int i = 0; i < 3; ++i) {
            color[i] = color[i] > 0.0f && std::isfinite(color[i]) ? color[i] : 0.0f;
            if (use == RgbUse::albedo) color[i] = std::min(1.0f, color[i]);
        }
        if (use == RgbUse::illuminant) color *= cie_y_integral;
        return {color.x, color.y, color.z, color.y};
    }
    float scale = 1.0f;
    if (use != RgbUse::albedo) {
        scale = 2.0f * max_component(rgb);
        if (!(scale > 0.0f && std::isfinite(scale))) return Spectrum(0.0f);
    }
    const Vec3 color = rgb * (1.0f / scale);
    const SigmoidCoefficients sigmoid =
        image_sigmoids_ ? image_sigmoids_->lookup(color) : rgb_to_sigmoid(*image_space_, color);
    Spectrum result;
    for (int i = 0; i < Spectrum::lanes; ++i) {
        result[i] = scale * sigmoid.at(wavelengths.lambda[i]);
        if (use == RgbUse::illuminant) result[i] *= table_at(image_white_, wavelengths.lambda[i]);
    }
    return result;
}

}  // namespace dapple
