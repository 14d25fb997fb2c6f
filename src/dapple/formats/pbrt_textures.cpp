// Textures of pbrt-v4, of float and spectrum type alike.
#include "dapple/formats/pbrt_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace dapple {
namespace {

constexpr std::string_view supported[] = {"constant",     "scale",    "mix",   "directionmix",
                                          "checkerboard", "imagemap", "bilerp"};
constexpr std::string_view float_stand_ins[] = {"dots", "fbm", "wrinkled", "windy", "ptex"};
constexpr std::string_view spectrum_stand_ins[] = {"dots", "marble", "ptex"};
constexpr float stand_in_value = 0.5f;

// What differs between the two types of texture.
struct FloatKind {
    using Input = scene::FloatInput;
    using Value = float;
    static constexpr std::string_view word = "float";
    static Input input(PbrtParameters& p, std::string_view name, float fallback)
    {
        return p.float_input(name, fallback);
    }
    static Value value(PbrtParameters& p, std::string_view name, float fallback) { return p.number(name, fallback); }
    static Value constant(float v) { return v; }
};
// A spectrum texture does not know its use: whether values over 1 are right shows when it is used.
struct SpectrumKind {
    using Input = scene::SpectrumInput;
    using Value = scene::SpectrumSource;
    static constexpr std::string_view word = "spectrum";
    static Input input(PbrtParameters& p, std::string_view name, float fallback)
    {
        return p.spectrum_input(name, Input(fallback), SpectrumMeaning::unbounded);
    }
    static Value value(PbrtParameters& p, std::string_view name, float fallback)
    {
        return p.spectrum(name, SpectrumMeaning::unbounded).value_or(constant(fallback));
    }
    static Value constant(float v) { return Value(scene::Constant{v}); }
};

scene::TextureMapping read_mapping(PbrtParameters& parameters)
{
    constexpr std::string_view words[] = {"uv", "spherical", "cylindrical", "planar"};
    scene::TextureMapping mapping;
    mapping.kind = static_cast<scene::TextureMapping::Kind>(parameters.word("mapping", 0, words));
    if (mapping.kind == scene::TextureMapping::Kind::uv) {
        mapping.u_scale = parameters.number("uscale", 1.0f);
        mapping.v_scale = parameters.number("vscale", 1.0f);
    }
    if (mapping.kind == scene::TextureMapping::Kind::planar) {
        mapping.v1 = parameters.vector("v1", mapping.v1);
        mapping.v2 = parameters.vector("v2", mapping.v2);
    }
    if (mapping.kind == scene::TextureMapping::Kind::uv || mapping.kind == scene::TextureMapping::Kind::planar) {
        mapping.u_delta = parameters.number("udelta", 0.0f);
        mapping.v_delta = parameters.number("vdelta", 0.0f);
    }
    return mapping;
}

void read_encoding(PbrtParameters& parameters, scene::ImageTexture& image)
{
    if (!parameters.has("encoding")) return;
    const std::string text = parameters.string("encoding", "");
    constexpr std::string_view gamma_prefix = "gamma ";
    if (text == "sRGB") {
        image.encoding = scene::Encoding::srgb;
    } else if (text == "linear") {
        image.encoding = scene::Encoding::linear;
    } else if (text.starts_with(gamma_prefix)) {
        image.encoding = scene::Encoding::gamma;
        const char* end = text.data() + text.size();
        const auto result = std::from_chars(text.data() + gamma_prefix.size(), end, image.gamma);
        const bool good =
            result.ec == std::errc{} && result.ptr == end && image.gamma > 0.0f && std::isfinite(image.gamma);
        if (!good)
            throw UserError(parameters.where("encoding"),
                            fmt::format("the encoding '{}' needs a positive number after 'gamma'", shown(text)));
    } else {
        constexpr std::string_view words[] = {"sRGB", "linear", "gamma 2.2"};
        fail_type("encoding", text, words, parameters.where("encoding"));
    }
}

scene::ImageTexture read_image(PbrtParameters& parameters)
{
    constexpr std::string_view wraps[] = {"repeat", "clamp", "black"};
    constexpr std::string_view filters[] = {"point", "bilinear", "trilinear", "ewa", "EWA"};
    scene::ImageTexture image;
    image.file = parameters.file("filename");
    if (image.file.empty()) throw UserError(parameters.at(), fmt::format("{} needs a 'filename'", parameters.what()));
    image.wrap = static_cast<scene::Wrap>(parameters.word("wrap", 0, wraps));
    const size_t filter = parameters.word("filter", 1, filters);
    image.filter = filter == 0 ? scene::ImageFilter::nearest : scene::ImageFilter::bilinear;
    if (filter > 1)
        parameters.context().warn(parameters.where("filter"),
                                  fmt::format("texture filter '{}' reads as 'bilinear': samples "
                                              "per pixel do the rest",
                                              filters[filter]));
    parameters.number("maxanisotropy", 8.0f);  // only for the filters above
    image.scale = parameters.number("scale", 1.0f);
    image.invert = parameters.boolean("invert", false);
    read_encoding(parameters, image);
    return image;
}

template <class Kind>
auto read_texture(const std::string& type, PbrtParameters& parameters, std::span<const std::string_view> stand_ins)
{
    using Input = typename Kind::Input;
    using Value = typename Kind::Value;
    scene::Texture<Input, Value> texture;
    if (type == "constant") {
        texture.kind = Kind::value(parameters, "value", 1.0f);
    } else if (type == "scale") {
        texture.kind =
            scene::ScaleTexture<Input>{Kind::input(parameters, "tex", 1.0f), parameters.float_input("scale", 1.0f)};
    } else if (type == "mix") {
        texture.kind =
            scene::MixTexture<Input>{Kind::input(parameters, "tex1", 0.0f), Kind::input(parameters, "tex2", 1.0f),
                                     parameters.float_input("amount", 0.5f)};
    } else if (type == "directionmix") {
        const Vec3 direction = parameters.vector("dir", Vec3(0, 1, 0));
        if (length_squared(direction) == 0.0f)
            throw UserError(parameters.where("dir"), "parameter 'dir' has no direction");
        texture.kind = scene::DirectionMixTexture<Input>{Kind::input(parameters, "tex1", 0.0f),
                                                         Kind::input(parameters, "tex2", 1.0f), direction};
    } else if (type == "checkerboard") {
        const int dimension = parameters.integer("dimension", 2, 2, 3);
        texture.kind = scene::CheckerboardTexture<Input>{dimension, Kind::input(parameters, "tex1", 1.0f),
                                                         Kind::input(parameters, "tex2", 0.0f)};
        if (dimension == 2) texture.mapping = read_mapping(parameters);
    } else if (type == "imagemap") {
        texture.kind = read_image(parameters);
        texture.mapping = read_mapping(parameters);
    } else if (type == "bilerp") {
        texture.kind =
            scene::BilerpTexture<Value>{Kind::value(parameters, "v00", 0.0f), Kind::value(parameters, "v01", 1.0f),
                                        Kind::value(parameters, "v10", 0.0f), Kind::value(parameters, "v11", 1.0f)};
        texture.mapping = read_mapping(parameters);
    } else if (std::find(stand_ins.begin(), stand_ins.end(), type) != stand_ins.end()) {
        texture.kind = Kind::constant(stand_in_value);
        parameters.ignore_rest();
        parameters.context().warn(parameters.at(),
                                  fmt::format("texture '{}' is not supported: the constant {} stands in "
                                              "for it",
                                              type, stand_in_value));
    } else {
        std::vector<std::string_view> known(std::begin(supported), std::end(supported));
        known.insert(known.end(), stand_ins.begin(), stand_ins.end());
        fail_type(fmt::format("{} texture", Kind::word), type, known, parameters.at());
    }
    return texture;
}

}  // namespace

scene::FloatTexture read_float_texture(const std::string& type, PbrtParameters& parameters)
{
    return read_texture<FloatKind>(type, parameters, float_stand_ins);
}

scene::SpectrumTexture read_spectrum_texture(const std::string& type, PbrtParameters& parameters)
{
    return read_texture<SpectrumKind>(type, parameters, spectrum_stand_ins);
}

}  // namespace dapple
