#include "dapple/base/log.h"
#include "dapple/base/parallel.h"
#include "dapple/image/image_file.h"
#include "dapple/world/compile_parts.h"

#include <set>

namespace dapple::detail {
namespace {

ColorEncoding encoding_of(scene::Encoding encoding, float gamma)
{
    switch (encoding) {
        case scene::Encoding::automatic: return {ColorEncoding::Kind::automatic, gamma};
        case scene::Encoding::srgb: return {ColorEncoding::Kind::srgb, gamma};
        case scene::Encoding::linear: return {ColorEncoding::Kind::linear, gamma};
        case scene::Encoding::gamma: return {ColorEncoding::Kind::gamma, gamma};
    }
    return {};
}

std::string image_key(const std::filesystem::path& file, scene::Encoding encoding, float gamma)
{
    return file.string() + "\n" + std::to_string(static_cast<int>(encoding)) + "\n" + std::to_string(gamma);
}

// All image textures of both kinds that differ in file or encoding are read in parallel.
void read_images(CompileContext& context)
{
    struct Request {
        const scene::ImageTexture* texture;
        SourceLocation at;
        Image image;
        std::string failure;
    };
    std::vector<Request> requests;
    const auto collect = [&](const auto& textures) {
        for (const auto& texture : textures)
            if (const auto* image = std::get_if<scene::ImageTexture>(&texture.kind)) {
                const std::string key = image_key(image->file, image->encoding, image->gamma);
                const auto id = static_cast<uint32_t>(requests.size());
                if (context.image_ids.emplace(key, id).second) requests.push_back({image, texture.at, {}, {}});
            }
    };
    collect(context.description.float_textures);
    collect(context.description.spectrum_textures);

    parallel_for(static_cast<int64_t>(requests.size()), 1, [&](int64_t i) {
        Request& request = requests[i];
        try {
            request.image = read_image(request.texture->file.string(),
                                       {encoding_of(request.texture->encoding, request.texture->gamma)});
        } catch (const UserError& error) {
            request.failure = error.what();
        }
    });
    for (Request& request : requests) {
        if (!request.failure.empty()) {
            log_warning("{}: {}; it is shown magenta", request.at.to_string(), request.failure);
            context.report.missing_images.push_back(request.texture->file.string());
            request.image = Image(1, 1, 3);
            request.image.pixels = {1.0f, 0.0f, 1.0f};
        }
        context.world.materials.textures.images.push_back(std::move(request.image));
    }
}

// Parts common to float and spectrum textures. Float textures give each other's ids through `children`.
template <class Input, class Value, class Children, class SetConstant>
TextureNode make_node(CompileContext& context, const scene::Texture<Input, Value>& texture, const Children& children,
                      const SetConstant& set_constant)
{
    TextureNode node;
    const scene::TextureMapping& mapping = texture.mapping;
    node.mapping.kind = static_cast<TextureMapping::Kind>(mapping.kind);
    node.mapping.su = mapping.u_scale;
    node.mapping.sv = mapping.v_scale;
    node.mapping.du = mapping.u_delta;
    node.mapping.dv = mapping.v_delta;
    node.mapping.vs = mapping.v1;
    node.mapping.vt = mapping.v2;
    invert(texture.world_from_texture, node.mapping.texture_from_world);

    if (const auto* value = std::get_if<Value>(&texture.kind)) {
        set_constant(node, 0, *value);
    } else if (const auto* scale = std::get_if<scene::ScaleTexture<Input>>(&texture.kind)) {
        node.kind = TextureNode::Kind::scale;
        node.child[0] = children(scale->texture);
        node.amount = float_texture(context, scale->scale).value;
    } else if (const auto* mix = std::get_if<scene::MixTexture<Input>>(&texture.kind)) {
        node.kind = TextureNode::Kind::mix;
        node.child[0] = children(mix->first);
        node.child[1] = children(mix->second);
        node.amount = float_texture(context, mix->amount).value;
    } else if (const auto* direction = std::get_if<scene::DirectionMixTexture<Input>>(&texture.kind)) {
        node.kind = TextureNode::Kind::direction_mix;
        node.child[0] = children(direction->first);
        node.child[1] = children(direction->second);
        node.direction = normalize(direction->direction);
    } else if (const auto* board = std::get_if<scene::CheckerboardTexture<Input>>(&texture.kind)) {
        node.kind = TextureNode::Kind::checkerboard;
        node.checkerboard_dimensions = static_cast<uint8_t>(board->dimension);
        node.child[0] = children(board->first);
        node.child[1] = children(board->second);
    } else if (const auto* image = std::get_if<scene::ImageTexture>(&texture.kind)) {
        node.kind = TextureNode::Kind::image;
        node.image = context.image_ids.at(image_key(image->file, image->encoding, image->gamma));
        node.wrap = static_cast<ImageWrap>(image->wrap);
        node.filter = static_cast<ImageFilter>(image->filter);
        node.scale = image->scale;
        node.invert = image->invert;
    } else if (const auto* bilerp = std::get_if<scene::BilerpTexture<Value>>(&texture.kind)) {
        node.kind = TextureNode::Kind::bilerp;
        set_constant(node, 0, bilerp->v00);
        set_constant(node, 1, bilerp->v01);
        set_constant(node, 2, bilerp->v10);
        set_constant(node, 3, bilerp->v11);
    }
    return node;
}

}  // namespace

uint32_t texture_image(CompileContext& context, const std::filesystem::path& file, scene::Encoding encoding,
                       float gamma, const SourceLocation& at)
{
    auto& images = context.world.materials.textures.images;
    const auto [entry, added] =
        context.image_ids.emplace(image_key(file, encoding, gamma), static_cast<uint32_t>(images.size()));
    if (added) {
        try {
            images.push_back(read_image(file.string(), {encoding_of(encoding, gamma)}));
        } catch (const UserError& error) {
            throw UserError(at, error.what());
        }
    }
    return entry->second;
}

FloatTextureId float_texture(CompileContext& context, const scene::FloatInput& input)
{
    if (input.textured()) return context.float_ids[input.texture.value];
    auto& nodes = context.world.materials.textures.floats;
    // The two roughnesses of an isotropic lobe come one after the other, and should be known as one.
    const bool again =
        !nodes.empty() && nodes.back().kind == TextureNode::Kind::constant && nodes.back().value[0] == input.value;
    if (!again) nodes.emplace_back().value[0] = input.value;
    return FloatTextureId(nodes.size() - 1);
}

SpectrumTextureId spectrum_texture(CompileContext& context, const scene::SpectrumInput& input, SpectrumUsage usage)
{
    if (input.textured()) return context.spectrum_ids[input.texture.value];
    auto& nodes = context.world.materials.textures.spectra;
    TextureNode node;
    node.spectrum[0] = compile_spectrum(context.world.spectra, input.value, usage);
    nodes.push_back(node);
    return SpectrumTextureId(nodes.size() - 1);
}

// Colours of images and grids are looked up in a table of spectra, which is made once and only where it is needed.
static void prepare_colors(CompileContext& context)
{
    const scene::Description& description = context.description;
    const auto prepare = [&](scene::ColorSpace space) { context.world.spectra.prepare_rgb(color_space_of(space)); };
    for (const scene::SpectrumTexture& texture : description.spectrum_textures)
        if (std::holds_alternative<scene::ImageTexture>(texture.kind)) return prepare(texture.color_space);
    for (const scene::Medium& medium : description.media)
        if (const auto* grid = std::get_if<scene::RgbGridMedium>(&medium.kind)) return prepare(grid->color_space);
    for (const scene::AreaLight& light : description.area_lights)
        if (!light.file.empty()) return prepare(light.color_space);
    for (const scene::Light& light : description.lights) {
        const auto* infinite = std::get_if<scene::InfiniteLight>(&light.kind);
        if ((infinite && !infinite->file.empty()) || std::holds_alternative<scene::ProjectionLight>(light.kind))
            return prepare(light.color_space);
    }
}

void compile_textures(CompileContext& context)
{
    read_images(context);
    prepare_colors(context);
    Textures& textures = context.world.materials.textures;
    // Children come before their parents in the description, so that ids are known when asked for.
    for (const scene::FloatTexture& texture : context.description.float_textures) {
        TextureNode node = make_node(
            context, texture, [&](const scene::FloatInput& input) { return float_texture(context, input).value; },
            [](TextureNode& out, int i, float value) { out.value[i] = value; });
        textures.floats.push_back(node);
        context.float_ids.push_back(FloatTextureId(textures.floats.size() - 1));
    }
    for (const scene::SpectrumTexture& texture : context.description.spectrum_textures) {
        TextureNode node = make_node(
            context, texture,
            [&](const scene::SpectrumInput& input) {
                return spectrum_texture(context, input, SpectrumUsage::reflectance).value;
            },
            [&](TextureNode& out, int i, const scene::SpectrumSource& value) {
                out.spectrum[i] = compile_spectrum(context.world.spectra, value, SpectrumUsage::reflectance);
            });
        textures.spectra.push_back(node);
        context.spectrum_ids.push_back(SpectrumTextureId(textures.spectra.size() - 1));
    }
}

}  // namespace dapple::detail
