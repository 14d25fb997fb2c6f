// Turns pbrt's directives into a scene::Description. Materials and media may be named before they are made, so names
// get their index when first seen, and materials are read at the end, when all textures are known.
#pragma once

#include "dapple/formats/pbrt_state.h"
#include "dapple/scene/description.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace dapple {

class PbrtBuilder {
public:
    PbrtBuilder(std::filesystem::path base_folder, const ReadLimits& limits);

    PbrtContext& context() { return context_; }
    GraphicsState& state() { return state_; }
    bool in_world() const { return in_world_; }

    // Entities; `at` is the place of the directive.
    void camera(const std::string& type, PbrtParameters parameters);
    void film(const std::string& type, PbrtParameters parameters);
    void filter(const std::string& type, PbrtParameters parameters);
    void sampler(const std::string& type, PbrtParameters parameters);
    void integrator(const std::string& type, PbrtParameters parameters);
    void accelerator(const std::string& type, PbrtParameters parameters);
    void option(const std::string& name, const PbrtToken& value, const SourceLocation& at);
    void shape(const std::string& type, PbrtParameters parameters);
    void light(const std::string& type, PbrtParameters parameters);
    void area_light(const std::string& type, PbrtParameters parameters);
    void material(const std::string& type, PbrtParameters parameters);
    void named_material(const std::string& name, PbrtParameters parameters);
    void texture(const std::string& name, const std::string& value_type, const std::string& type,
                 PbrtParameters parameters);
    void medium(const std::string& name, PbrtParameters parameters);

    // State.
    void world_begin(const SourceLocation& at);
    void push(const SourceLocation& at);
    void pop(const SourceLocation& at);
    void object_begin(const std::string& name, const SourceLocation& at);
    void object_end(const SourceLocation& at);
    void object_instance(const std::string& name, const SourceLocation& at);
    void coordinate_system(const std::string& name);
    void coordinate_system_transform(const std::string& name, const SourceLocation& at);
    void attribute(const std::string& target, std::vector<PbrtParameter> parameters, const SourceLocation& at);
    void use_material(const std::string& name, const SourceLocation& at);
    void use_media(const std::string& inside, const std::string& outside, const SourceLocation& at);

    // The depth of open AttributeBegin and ObjectBegin blocks, and the place of the innermost.
    size_t open_blocks() const { return blocks_.size(); }
    const SourceLocation& innermost_block() const { return blocks_.back().at; }

    // Reads what was put off and checks that all names were made. Call once, at the end.
    scene::Description finish(const SourceLocation& end);

private:
    struct Block {
        GraphicsState saved;
        SourceLocation at;
        bool object = false;
    };
    template <class Index>
    struct Reference {
        Index index;
        bool made = false;
        SourceLocation first_use;
    };
    struct PendingMaterial {
        scene::MaterialIndex index;
        std::string type;
        std::string name;
        PbrtParameters parameters;
    };
    struct PendingAlpha {
        scene::ObjectIndex object;  // none: in the world
        size_t shape;
        std::string texture;
        SourceLocation at;
    };

    scene::MediumIndex medium_reference(const std::string& name, const SourceLocation& at);
    scene::MaterialIndex material_reference(const std::string& name, const SourceLocation& at);
    void read_pending_materials();
    scene::Material read_material(const PendingMaterial& pending, PbrtParameters& parameters);
    scene::MixMaterial read_mix(PbrtParameters& parameters);
    void resolve_pending_alphas();
    void check_mixes_end() const;
    template <class Map>
    void check_all_made(const Map& references, std::string_view what) const;

    PbrtContext context_;
    GraphicsState state_;
    scene::Description scene_;
    bool in_world_ = false;
    std::vector<Block> blocks_;
    std::map<std::string, TransformPair, std::less<>> coordinate_systems_;
    std::map<std::string, Reference<scene::MaterialIndex>, std::less<>> materials_;
    std::map<std::string, Reference<scene::MediumIndex>, std::less<>> media_;
    std::map<std::string, scene::ObjectIndex, std::less<>> objects_;
    std::map<std::string, std::shared_ptr<const scene::MeshData>> ply_files_;
    scene::ObjectIndex open_object_;  // between ObjectBegin and ObjectEnd
    std::vector<PendingMaterial> pending_materials_;
    std::vector<PendingAlpha> pending_alphas_;
};

// Readers of one kind of entity each; they leave parameters.finish() to the caller.
scene::Camera read_camera(const std::string& type, PbrtParameters& parameters);
scene::Film read_film(const std::string& type, PbrtParameters& parameters);
scene::Filter read_filter(const std::string& type, PbrtParameters& parameters);
scene::Sampler read_sampler(const std::string& type, PbrtParameters& parameters);
scene::Integrator read_integrator(const std::string& type, PbrtParameters& parameters);
scene::Light read_light(const std::string& type, PbrtParameters& parameters, scene::ColorSpace color_space);
scene::AreaLight read_area_light(const std::string& type, PbrtParameters& parameters, scene::ColorSpace color_space);
scene::Medium read_medium(PbrtParameters& parameters, scene::ColorSpace color_space);
scene::FloatTexture read_float_texture(const std::string& type, PbrtParameters& parameters);
scene::SpectrumTexture read_spectrum_texture(const std::string& type, PbrtParameters& parameters);
// All materials but mixes.
scene::Material read_simple_material(const std::string& type, PbrtParameters& parameters);

// The geometry of a shape; nothing when the kind of shape is known but left out (a warning says so).
using ShapeGeometry = decltype(scene::Shape::geometry);
using PlyCache = std::map<std::string, std::shared_ptr<const scene::MeshData>>;
std::optional<ShapeGeometry> read_geometry(const std::string& type, PbrtParameters& parameters, PlyCache& ply_files);

// Throws "unknown `what` 'type'" with the nearest of `known`.
[[noreturn]] void fail_type(std::string_view what, const std::string& type, std::span<const std::string_view> known,
                            const SourceLocation& at, const std::string& legacy = {});

}  // namespace dapple
