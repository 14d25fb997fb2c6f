#include "dapple/formats/pbrt_builder.h"

#include "dapple/scene/names.h"

#include <fmt/format.h>

#include <algorithm>

namespace dapple {
namespace {

// Attribute defaults are copied into every entity that they fit, so they may not be large.
constexpr size_t most_default_values = 1024;
constexpr size_t most_defaults = 256;

}  // namespace

void fail_type(std::string_view what, const std::string& type, std::span<const std::string_view> known,
               const SourceLocation& at, const std::string& legacy)
{
    throw UserError(
        at, fmt::format("unknown {} '{}'{}", what, shown(type), legacy.empty() ? suggest(type, known) : legacy));
}

PbrtBuilder::PbrtBuilder(std::filesystem::path base_folder, const ReadLimits& limits)
    : context_(std::move(base_folder), limits)
{
    scene_.materials.emplace_back();
    scene_.base_folder = context_.base_folder();
}

void PbrtBuilder::world_begin(const SourceLocation& at)
{
    if (in_world_) throw UserError(at, "WorldBegin stands here a second time");
    in_world_ = true;
    state_.transform = {};
    state_.start_active = state_.end_active = true;
    coordinate_systems_["world"] = state_.transform;
}

void PbrtBuilder::push(const SourceLocation& at) { blocks_.push_back({state_, at, false}); }

void PbrtBuilder::pop(const SourceLocation& at)
{
    if (blocks_.empty()) throw UserError(at, "AttributeEnd without an AttributeBegin");
    if (blocks_.back().object)
        throw UserError(at, fmt::format("AttributeEnd closes the ObjectBegin at {}", blocks_.back().at.to_string()));
    state_ = std::move(blocks_.back().saved);
    blocks_.pop_back();
}

void PbrtBuilder::object_begin(const std::string& name, const SourceLocation& at)
{
    if (open_object_.valid()) throw UserError(at, "ObjectBegin within another object");
    const auto [entry, fresh] = objects_.try_emplace(name, scene::ObjectIndex(scene_.objects.size()));
    if (!fresh)
        throw UserError(at, fmt::format("object '{}' was already made at {}", shown(name),
                                        scene_.objects[entry->second.value].at.to_string()));
    blocks_.push_back({state_, at, true});
    open_object_ = entry->second;
    scene_.objects.push_back({name, {}, at});
}

void PbrtBuilder::object_end(const SourceLocation& at)
{
    if (!open_object_.valid()) throw UserError(at, "ObjectEnd without an ObjectBegin");
    if (!blocks_.back().object)
        throw UserError(at, fmt::format("ObjectEnd closes the AttributeBegin at {}", blocks_.back().at.to_string()));
    state_ = std::move(blocks_.back().saved);
    blocks_.pop_back();
    open_object_ = {};
}

void PbrtBuilder::object_instance(const std::string& name, const SourceLocation& at)
{
    if (open_object_.valid()) throw UserError(at, "ObjectInstance within an object: instances cannot be nested");
    const auto object = objects_.find(name);
    if (object == objects_.end())
        throw UserError(at, fmt::format("no object is named '{}'{}", shown(name), suggest(name, names_of(objects_))));
    scene_.instances.push_back({object->second, current_transform(state_, at), at});
}

void PbrtBuilder::coordinate_system(const std::string& name) { coordinate_systems_[name] = state_.transform; }

void PbrtBuilder::coordinate_system_transform(const std::string& name, const SourceLocation& at)
{
    const auto system = coordinate_systems_.find(name);
    if (system == coordinate_systems_.end())
        throw UserError(at, fmt::format("no coordinate system is named '{}'{}", shown(name),
                                        suggest(name, names_of(coordinate_systems_))));
    state_.transform = system->second;
}

void PbrtBuilder::attribute(const std::string& target, std::vector<PbrtParameter> parameters, const SourceLocation& at)
{
    const auto word = std::find(attribute_target_words.begin(), attribute_target_words.end(), target);
    if (word == attribute_target_words.end()) fail_type("attribute target", target, attribute_target_words, at);
    auto& slot = state_.defaults[static_cast<size_t>(word - attribute_target_words.begin())];

    auto merged = slot ? *slot : std::vector<PbrtParameter>();
    for (PbrtParameter& parameter : parameters) {
        if (parameter.numbers.size() + parameter.integers.size() + parameter.strings.size() > most_default_values)
            throw UserError(parameter.where(),
                            fmt::format("a default may have at most {} values", most_default_values));
        std::erase_if(merged, [&](auto& old) { return old.name == parameter.name && old.type == parameter.type; });
        merged.push_back(std::move(parameter));
        if (merged.size() > most_defaults)
            throw UserError(at, fmt::format("more than {} defaults for '{}'", most_defaults, target));
    }
    slot = std::make_shared<const std::vector<PbrtParameter>>(std::move(merged));
}

scene::MaterialIndex PbrtBuilder::material_reference(const std::string& name, const SourceLocation& at)
{
    const auto [entry, fresh] = materials_.try_emplace(name);
    if (fresh) {
        entry->second = {scene::MaterialIndex(scene_.materials.size()), false, at};
        scene_.materials.emplace_back();
    }
    return entry->second.index;
}

scene::MediumIndex PbrtBuilder::medium_reference(const std::string& name, const SourceLocation& at)
{
    if (name.empty()) return {};
    const auto [entry, fresh] = media_.try_emplace(name);
    if (fresh) {
        entry->second = {scene::MediumIndex(scene_.media.size()), false, at};
        scene_.media.emplace_back();
    }
    return entry->second.index;
}

void PbrtBuilder::use_material(const std::string& name, const SourceLocation& at)
{
    state_.material = material_reference(name, at);
}

void PbrtBuilder::use_media(const std::string& inside, const std::string& outside, const SourceLocation& at)
{
    state_.inside = medium_reference(inside, at);
    state_.outside = medium_reference(outside, at);
    state_.medium_interface = true;
}

void PbrtBuilder::medium(const std::string& name, PbrtParameters parameters)
{
    medium_reference(name, parameters.at());
    auto& reference = media_[name];
    if (reference.made) throw UserError(parameters.at(), fmt::format("medium '{}' was already made", shown(name)));
    reference.made = true;
    scene::Medium medium = read_medium(parameters, state_.color_space);
    parameters.finish();
    const scene::MovingMatrix transform = current_transform(state_, parameters.at());
    if (transform.moves())
        context_.warn(parameters.at(), "a medium cannot move: only the transform at the start time is used");
    medium.world_from_medium = transform.start;
    medium.name = name;
    medium.at = parameters.at();
    scene_.media[reference.index.value] = std::move(medium);
}

void PbrtBuilder::light(const std::string& type, PbrtParameters parameters)
{
    scene::Light light = read_light(type, parameters, state_.color_space);
    parameters.finish();
    light.world_from_light = current_transform(state_, parameters.at());
    light.medium = state_.outside;
    scene_.lights.push_back(std::move(light));
}

void PbrtBuilder::area_light(const std::string& type, PbrtParameters parameters)
{
    state_.area_light = scene::AreaLightIndex(scene_.area_lights.size());
    scene_.area_lights.push_back(read_area_light(type, parameters, state_.color_space));
    parameters.finish();
}

void PbrtBuilder::texture(const std::string& name, const std::string& value_type, const std::string& type,
                          PbrtParameters parameters)
{
    const SourceLocation at = parameters.at();
    const auto place = [&](auto& list, auto& names, auto texture) {
        using Index = typename std::decay_t<decltype(names)>::mapped_type;
        parameters.finish();
        const scene::MovingMatrix transform = current_transform(state_, at);
        if (transform.moves()) context_.warn(at, "a texture cannot move: only the transform at the start time is used");
        texture.world_from_texture = transform.start;
        texture.color_space = state_.color_space;
        texture.name = name;
        texture.at = at;
        if (!names.try_emplace(name, Index(list.size())).second)
            throw UserError(at, fmt::format("{} texture '{}' was already made", value_type, shown(name)));
        list.push_back(std::move(texture));
    };
    if (value_type == "float")
        place(scene_.float_textures, context_.float_textures, read_float_texture(type, parameters));
    else
        place(scene_.spectrum_textures, context_.spectrum_textures, read_spectrum_texture(type, parameters));
}

void PbrtBuilder::shape(const std::string& type, PbrtParameters parameters)
{
    scene::Shape shape;
    shape.at = parameters.at();
    const std::string alpha_texture = parameters.texture_name("alpha");
    const SourceLocation alpha_at = parameters.where("alpha");
    if (alpha_texture.empty()) shape.alpha.value = parameters.number("alpha", 1.0f, PbrtRange::unit);

    auto geometry = read_geometry(type, parameters, ply_files_);
    parameters.finish();
    if (!geometry) return;
    shape.geometry = std::move(*geometry);
    shape.name = type;
    shape.world_from_object = current_transform(state_, shape.at);
    shape.reverse_orientation = state_.reverse_orientation;
    shape.material = state_.material;
    shape.area_light = state_.area_light;
    shape.inside = state_.inside;
    shape.outside = state_.outside;
    shape.medium_interface = state_.medium_interface;
    if (open_object_.valid() && shape.area_light.valid()) {
        context_.warn(shape.at, "a shape within an object cannot emit: its area light is ignored");
        shape.area_light = {};
    }
    auto& shapes = open_object_.valid() ? scene_.objects[open_object_.value].shapes : scene_.shapes;
    if (!alpha_texture.empty()) pending_alphas_.push_back({open_object_, shapes.size(), alpha_texture, alpha_at});
    shapes.push_back(std::move(shape));
}

void PbrtBuilder::resolve_pending_alphas()
{
    for (const PendingAlpha& pending : pending_alphas_) {
        auto& shapes = pending.object.valid() ? scene_.objects[pending.object.value].shapes : scene_.shapes;
        const auto texture = context_.float_textures.find(pending.texture);
        if (texture == context_.float_textures.end())
            throw UserError(pending.at, fmt::format("no float texture is named '{}'{}", shown(pending.texture),
                                                    suggest(pending.texture, names_of(context_.float_textures))));
        shapes[pending.shape].alpha.texture = texture->second;
        shapes[pending.shape].alpha.at = pending.at;
    }
}

template <class Map>
void PbrtBuilder::check_all_made(const Map& references, std::string_view what) const
{
    for (const auto& [name, reference] : references) {
        if (reference.made) continue;
        std::vector<std::string_view> made;
        for (const auto& [other, other_reference] : references)
            if (other_reference.made) made.push_back(other);
        throw UserError(reference.first_use,
                        fmt::format("no {} is named '{}'{}", what, shown(name), suggest(name, made)));
    }
}

scene::Description PbrtBuilder::finish(const SourceLocation& end)
{
    if (!blocks_.empty()) {
        const char* what = blocks_.back().object ? "ObjectBegin" : "AttributeBegin";
        throw UserError(blocks_.back().at, fmt::format("{} is never closed", what));
    }
    if (!in_world_) throw UserError(end, "the file ends before WorldBegin: it is not a whole scene");
    read_pending_materials();
    resolve_pending_alphas();
    check_all_made(materials_, "material");
    check_all_made(media_, "medium");
    check_mixes_end();
    scene_.warnings = context_.warnings();
    scene_.files = context_.files();
    return std::move(scene_);
}

}  // namespace dapple
