#include "dapple/world/compile_parts.h"

namespace dapple::detail {
namespace {

// Fills the parts of Material that each kind has.
struct Fill {
    CompileContext& context;
    Material& out;

    FloatTextureId number(const scene::FloatInput& input) const { return float_texture(context, input); }
    SpectrumTextureId reflectance(const scene::SpectrumInput& input) const
    {
        return spectrum_texture(context, input, SpectrumUsage::reflectance);
    }
    SpectrumTextureId index(const scene::SpectrumInput& input) const
    {
        return spectrum_texture(context, input, SpectrumUsage::index);
    }
    SpectrumValue index(const scene::SpectrumSource& source) const
    {
        return compile_spectrum(context.world.spectra, source, SpectrumUsage::index);
    }
    void roughness(const scene::RoughnessInput& input) const
    {
        out.u_roughness = number(input.u);
        out.v_roughness = number(input.v);
    }
    void coat(const scene::CoatLayer& coat) const
    {
        out.dielectric_eta = index(coat.eta);
        out.coat_u_roughness = number(coat.roughness.u);
        out.coat_v_roughness = number(coat.roughness.v);
        out.thickness = number(coat.thickness);
        out.g = number(coat.g);
        out.albedo = reflectance(coat.albedo);
        out.layer_max_depth = static_cast<uint8_t>(std::clamp(coat.max_depth, 1, 255));
        out.layer_samples = static_cast<uint8_t>(std::clamp(coat.samples, 1, 255));
        out.pbrt_coat_weights = context.description.options.pbrt_coat_weights;
    }
    template <class Metal>
    void metal(const Metal& metal) const
    {
        roughness(metal.roughness);
        out.remap_roughness = metal.remap_roughness;
        out.conductor_from_reflectance = metal.reflectance.has_value();
        if (metal.reflectance) {
            out.reflectance = reflectance(*metal.reflectance);
        } else {
            out.eta = index(metal.eta);
            out.k = index(metal.k);
        }
    }

    void operator()(const scene::InterfaceMaterial&) const { out.kind = Material::Kind::interface; }
    void operator()(const scene::DiffuseMaterial& m) const
    {
        out.kind = Material::Kind::diffuse;
        out.reflectance = reflectance(m.reflectance);
    }
    void operator()(const scene::DiffuseTransmissionMaterial& m) const
    {
        out.kind = Material::Kind::diffuse_transmission;
        out.reflectance = reflectance(m.reflectance);
        out.transmittance = reflectance(m.transmittance);
        out.scale = m.scale;
    }
    void operator()(const scene::DielectricMaterial& m) const
    {
        out.kind = Material::Kind::dielectric;
        out.dielectric_eta = index(m.eta);
        roughness(m.roughness);
        out.remap_roughness = m.remap_roughness;
    }
    void operator()(const scene::ThinDielectricMaterial& m) const
    {
        out.kind = Material::Kind::thin_dielectric;
        out.dielectric_eta = index(m.eta);
    }
    void operator()(const scene::ConductorMaterial& m) const
    {
        out.kind = Material::Kind::conductor;
        metal(m);
    }
    void operator()(const scene::CoatedDiffuseMaterial& m) const
    {
        out.kind = Material::Kind::coated_diffuse;
        out.reflectance = reflectance(m.reflectance);
        coat(m.coat);
        out.remap_roughness = m.remap_roughness;
    }
    void operator()(const scene::CoatedConductorMaterial& m) const
    {
        out.kind = Material::Kind::coated_conductor;
        metal(m);
        coat(m.coat);
    }
    void operator()(const scene::MixMaterial& m) const
    {
        out.kind = Material::Kind::mix;
        out.mix[0] = MaterialId(m.materials[0].value);
        out.mix[1] = MaterialId(m.materials[1].value);
        out.mix_amount = number(m.amount);
    }
};

}  // namespace

void compile_materials(CompileContext& context)
{
    for (const scene::Material& material : context.description.materials) {
        Material out;
        std::visit(Fill{context, out}, material.kind);
        if (material.displacement) out.displacement = float_texture(context, *material.displacement);
        if (!material.normal_map.empty())
            out.normal_map = texture_image(context, material.normal_map, scene::Encoding::linear, 1.0f, material.at);
        context.world.materials.list.push_back(out);
    }
}

}  // namespace dapple::detail
