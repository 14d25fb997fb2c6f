// Materials of pbrt-v4. They are read at the end of the scene, when all textures and material names are known.
#include "dapple/formats/pbrt_builder.h"
#include "dapple/formats/pbrt_legacy.h"

#include <fmt/format.h>

#include <algorithm>

namespace dapple {
namespace {

constexpr std::string_view material_types[] = {"interface",     "diffuse",         "diffusetransmission",
                                               "dielectric",    "thindielectric",  "conductor",
                                               "coateddiffuse", "coatedconductor", "mix",
                                               "hair",          "subsurface",      "measured"};

scene::RoughnessInput read_roughness(PbrtParameters& parameters, std::string_view both, std::string_view u,
                                     std::string_view v)
{
    const scene::FloatInput roughness = parameters.float_input(both, 0.0f);
    return {parameters.optional_float_input(u).value_or(roughness),
            parameters.optional_float_input(v).value_or(roughness)};
}

scene::RoughnessInput read_roughness(PbrtParameters& parameters)
{
    return read_roughness(parameters, "roughness", "uroughness", "vroughness");
}

scene::SpectrumSource read_eta(PbrtParameters& parameters, std::string_view name, scene::SpectrumSource fallback)
{
    auto eta = parameters.spectrum_or_number(name, SpectrumMeaning::unbounded);
    if (!eta) return fallback;
    const auto* constant = std::get_if<scene::Constant>(&eta->value);
    if (constant && !(constant->value > 0.0f))
        throw UserError(eta->at, fmt::format("parameter '{}' must be greater than 0, got {}", name, constant->value));
    return std::move(*eta);
}

// eta and k, or the reflectance that stands in for them.
template <class Conductor>
void read_conductor(PbrtParameters& parameters, std::string_view eta, std::string_view k, Conductor& conductor)
{
    conductor.reflectance = parameters.optional_spectrum_input("reflectance", SpectrumMeaning::reflectance);
    if (conductor.reflectance && (parameters.has(eta) || parameters.has(k)))
        throw UserError(parameters.where("reflectance"),
                        fmt::format("{} takes 'reflectance' or '{}' and '{}', not both", parameters.what(), eta, k));
    conductor.eta = parameters.spectrum_input(eta, conductor.eta, SpectrumMeaning::unbounded);
    conductor.k = parameters.spectrum_input(k, conductor.k, SpectrumMeaning::unbounded);
}

// What both layered materials have but for the names of index and roughness.
void read_coat(PbrtParameters& parameters, scene::CoatLayer& coat)
{
    constexpr int most = 255;
    coat.thickness = parameters.float_input("thickness", 0.01f);
    coat.g = parameters.float_input("g", 0.0f);
    coat.albedo = parameters.spectrum_input("albedo", coat.albedo, SpectrumMeaning::reflectance);
    coat.max_depth = parameters.integer("maxdepth", coat.max_depth, 1, most);
    coat.samples = parameters.integer("nsamples", coat.samples, 1, most);
}

scene::CoatedDiffuseMaterial read_coated_diffuse(PbrtParameters& parameters)
{
    scene::CoatedDiffuseMaterial material;
    material.reflectance = parameters.spectrum_input("reflectance", material.reflectance, SpectrumMeaning::reflectance);
    material.coat.eta = read_eta(parameters, "eta", material.coat.eta);
    material.coat.roughness = read_roughness(parameters);
    read_coat(parameters, material.coat);
    material.remap_roughness = parameters.boolean("remaproughness", true);
    return material;
}

scene::CoatedConductorMaterial read_coated_conductor(PbrtParameters& parameters)
{
    scene::CoatedConductorMaterial material;
    read_conductor(parameters, "conductor.eta", "conductor.k", material);
    material.roughness =
        read_roughness(parameters, "conductor.roughness", "conductor.uroughness", "conductor.vroughness");
    material.coat.eta = read_eta(parameters, "interface.eta", material.coat.eta);
    material.coat.roughness =
        read_roughness(parameters, "interface.roughness", "interface.uroughness", "interface.vroughness");
    read_coat(parameters, material.coat);
    material.remap_roughness = parameters.boolean("remaproughness", true);
    return material;
}

// A diffuse surface in place of what is known but not supported.
scene::DiffuseMaterial read_stand_in(const std::string& type, PbrtParameters& parameters)
{
    scene::DiffuseMaterial material;
    std::string said = "a diffuse material of reflectance 0.5";
    if (type != "measured" && parameters.has("reflectance")) {
        material.reflectance =
            parameters.spectrum_input("reflectance", material.reflectance, SpectrumMeaning::reflectance);
        said = "a diffuse material of its reflectance";
    }
    parameters.context().warn(parameters.at(),
                              fmt::format("material '{}' is not supported: {} stands in for it", type, said));
    parameters.ignore_rest();
    return material;
}

}  // namespace

scene::Material read_simple_material(const std::string& type, PbrtParameters& parameters)
{
    scene::Material material;
    if (type.empty() || type == "none" || type == "interface") {
        material.kind = scene::InterfaceMaterial{};
        if (type != "interface")
            parameters.context().warn(parameters.at(),
                                      fmt::format("material '{}' is an old name of 'interface'", type));
        return material;
    }
    if (type == "diffuse") {
        scene::DiffuseMaterial diffuse;
        diffuse.reflectance =
            parameters.spectrum_input("reflectance", diffuse.reflectance, SpectrumMeaning::reflectance);
        material.kind = std::move(diffuse);
    } else if (type == "diffusetransmission") {
        scene::DiffuseTransmissionMaterial sheet;
        sheet.reflectance = parameters.spectrum_input("reflectance", sheet.reflectance, SpectrumMeaning::reflectance);
        sheet.transmittance =
            parameters.spectrum_input("transmittance", sheet.transmittance, SpectrumMeaning::reflectance);
        sheet.scale = parameters.number("scale", 1.0f, PbrtRange::not_negative);
        material.kind = std::move(sheet);
    } else if (type == "dielectric") {
        scene::DielectricMaterial dielectric;
        dielectric.eta = read_eta(parameters, "eta", dielectric.eta);
        dielectric.roughness = read_roughness(parameters);
        dielectric.remap_roughness = parameters.boolean("remaproughness", true);
        material.kind = std::move(dielectric);
    } else if (type == "thindielectric") {
        scene::ThinDielectricMaterial pane;
        pane.eta = read_eta(parameters, "eta", pane.eta);
        material.kind = std::move(pane);
    } else if (type == "conductor") {
        scene::ConductorMaterial conductor;
        read_conductor(parameters, "eta", "k", conductor);
        conductor.roughness = read_roughness(parameters);
        conductor.remap_roughness = parameters.boolean("remaproughness", true);
        material.kind = std::move(conductor);
    } else if (type == "coateddiffuse") {
        material.kind = read_coated_diffuse(parameters);
    } else if (type == "coatedconductor") {
        material.kind = read_coated_conductor(parameters);
    } else if (type == "hair" || type == "subsurface" || type == "measured") {
        material.kind = read_stand_in(type, parameters);
    } else {
        fail_type("material", type, material_types, parameters.at(), legacy_hint(LegacyKind::material, type));
    }
    material.displacement = parameters.optional_float_input("displacement");
    material.normal_map = parameters.file("normalmap");
    return material;
}

scene::MixMaterial PbrtBuilder::read_mix(PbrtParameters& parameters)
{
    const std::vector<std::string> names = parameters.strings("materials");
    const SourceLocation where = parameters.where("materials");
    if (names.size() != 2)
        throw UserError(where, fmt::format("material 'mix' takes 2 'materials', got {}", names.size()));
    scene::MixMaterial mix;
    for (size_t i = 0; i < 2; ++i) mix.materials[i] = material_reference(names[i], where);
    mix.amount = parameters.float_input("amount", 0.5f);
    return mix;
}

scene::Material PbrtBuilder::read_material(const PendingMaterial& pending, PbrtParameters& parameters)
{
    std::string type = pending.type;
    if (!pending.name.empty()) {
        if (!parameters.has("type"))
            throw UserError(parameters.at(), fmt::format("{} needs a parameter \"string type\"", parameters.what()));
        type = parameters.string("type", "");
    }
    scene::Material material;
    if (type == "mix")
        material.kind = read_mix(parameters);
    else
        material = read_simple_material(type, parameters);
    parameters.finish();
    material.name = pending.name;
    material.at = parameters.at();
    return material;
}

void PbrtBuilder::material(const std::string& type, PbrtParameters parameters)
{
    state_.material = scene::MaterialIndex(scene_.materials.size());
    scene_.materials.emplace_back();
    pending_materials_.push_back({state_.material, type, "", std::move(parameters)});
}

void PbrtBuilder::named_material(const std::string& name, PbrtParameters parameters)
{
    const scene::MaterialIndex index = material_reference(name, parameters.at());
    auto& reference = materials_[name];
    if (reference.made) throw UserError(parameters.at(), fmt::format("material '{}' was already made", shown(name)));
    reference.made = true;
    pending_materials_.push_back({index, "", name, std::move(parameters)});
}

void PbrtBuilder::read_pending_materials()
{
    for (PendingMaterial& pending : pending_materials_) {
        scene::Material material = read_material(pending, pending.parameters);
        scene_.materials[pending.index.value] = std::move(material);
    }
}

// Follows each mix down to its leaves; a material met again on its own path would never end.
void PbrtBuilder::check_mixes_end() const
{
    enum class Mark : uint8_t { fresh, open, done };
    std::vector<Mark> marks(scene_.materials.size(), Mark::fresh);
    struct Step {
        uint32_t material;
        int next_child;
    };
    for (uint32_t root = 0; root < scene_.materials.size(); ++root) {
        std::vector<Step> path;
        if (marks[root] == Mark::fresh) path.push_back({root, 0});
        while (!path.empty()) {
            const uint32_t current = path.back().material;
            const scene::Material& material = scene_.materials[current];
            const auto* mix = std::get_if<scene::MixMaterial>(&material.kind);
            if (!mix || path.back().next_child == 2) {
                marks[current] = Mark::done;
                path.pop_back();
                continue;
            }
            marks[current] = Mark::open;
            const uint32_t child = mix->materials[path.back().next_child++].value;
            if (marks[child] == Mark::open)
                throw UserError(material.at, fmt::format("material '{}' is a mix of itself", shown(material.name)));
            if (marks[child] == Mark::fresh) path.push_back({child, 0});
        }
    }
}

}  // namespace dapple
