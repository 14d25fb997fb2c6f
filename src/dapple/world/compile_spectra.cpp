#include "dapple/world/compile_parts.h"

namespace dapple::detail {
namespace {

SpectrumRole role_of(SpectrumUsage usage)
{
    switch (usage) {
        case SpectrumUsage::reflectance:
        case SpectrumUsage::unbounded: return SpectrumRole::factor;
        case SpectrumUsage::light: return SpectrumRole::light;
        case SpectrumUsage::index: return SpectrumRole::index;
    }
    return SpectrumRole::factor;
}

struct Make {
    SpectrumPool& pool;
    SpectrumUsage usage;

    SpectrumValue operator()(const scene::Constant& s) const { return make_constant(s.value, role_of(usage)); }
    SpectrumValue operator()(const scene::Rgb& s) const
    {
        const ColorSpace& space = color_space_of(s.color_space);
        switch (usage) {
            case SpectrumUsage::reflectance: return make_albedo(pool, space, s.rgb);
            case SpectrumUsage::light: return make_illuminant(pool, space, s.rgb);
            case SpectrumUsage::unbounded:
            case SpectrumUsage::index: return make_unbounded(pool, space, s.rgb);
        }
        return {};
    }
    SpectrumValue operator()(const scene::Blackbody& s) const { return make_blackbody(pool, s.kelvin, role_of(usage)); }
    SpectrumValue operator()(const scene::Named& s) const { return make_named(pool, s.name); }
    SpectrumValue operator()(const scene::Samples& s) const
    {
        // A refractive index does not end where its measurements do.
        const TableEnds ends = usage == SpectrumUsage::index ? TableEnds::clamp : TableEnds::zero;
        return make_sampled(pool, s.lambda, s.values, role_of(usage), ends);
    }
    SpectrumValue operator()(const scene::White& s) const
    {
        return make_illuminant(pool, color_space_of(s.color_space), Vec3(1, 1, 1));
    }
};

}  // namespace

const ColorSpace& color_space_of(scene::ColorSpace space)
{
    switch (space) {
        case scene::ColorSpace::srgb: return srgb();
        case scene::ColorSpace::rec2020: return color_space("rec2020");
        case scene::ColorSpace::aces2065_1: return color_space("aces2065-1");
        case scene::ColorSpace::dci_p3: return color_space("dci-p3");
    }
    return srgb();
}

SpectrumValue compile_spectrum(SpectrumPool& pool, const scene::SpectrumSource& source, SpectrumUsage usage)
{
    try {
        return std::visit(Make{pool, usage}, source.value);
    } catch (const UserError& error) {
        throw UserError(source.at, error.what());
    }
}

}  // namespace dapple::detail
