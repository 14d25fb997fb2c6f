// Evaluation of texture nodes, by recursion along the child ids (compile bounds the depth). Meanings are those of
// pbrt-v4: texture coordinates of a 2D mapping, image rows from the top (hence 1 - t), checkerboards of unit squares or
// cubes. Image pixels are interpolated as RGB and the result turned into a spectrum. Cost: a switch per node.

#include "dapple/materials/texture.h"

#include "dapple/materials/image_lookup.h"

namespace dapple {

namespace {

// (s, t) of the mapping at a point.
Vec2 map_2d(const TextureMapping& mapping, const SurfacePoint& at)
{
    if (mapping.kind == TextureMapping::Kind::uv)
        return {mapping.su * at.uv.x + mapping.du, mapping.sv * at.uv.y + mapping.dv};
    const Vec3 p = Transform::apply_point(mapping.texture_from_world, at.position);
    switch (mapping.kind) {
        case TextureMapping::Kind::spherical: {
            const float angle = std::atan2(p.y, p.x);
            return {std::atan2(std::sqrt(sqr(p.x) + sqr(p.y)), p.z) * inv_pi,
                    (angle < 0.0f ? angle + 2.0f * pi : angle) * (0.5f * inv_pi)};
        }
        case TextureMapping::Kind::cylindrical: return {(pi + std::atan2(p.y, p.x)) * (0.5f * inv_pi), p.z};
        default: return {mapping.du + dot(p, mapping.vs), mapping.dv + dot(p, mapping.vt)};
    }
}

// Which of the two children a checkerboard shows.
int checkerboard_cell(const TextureNode& node, const SurfacePoint& at)
{
    const auto odd = [](float x) { return x - 2.0f * std::floor(0.5f * x) >= 1.0f; };
    if (node.checkerboard_dimensions == 3) {
        const Vec3 p = Transform::apply_point(node.mapping.texture_from_world, at.position);
        return odd(p.x) ^ odd(p.y) ^ odd(p.z);
    }
    const Vec2 st = map_2d(node.mapping, at);
    return odd(st.x) ^ odd(st.y);
}

// a + amount (b - a), without looking at a child that does not show.
template <class Value, class Child>
Value mix_children(float amount, const Child& child)
{
    if (amount == 0.0f) return child(0);
    if (amount == 1.0f) return child(1);
    return child(0) * (1.0f - amount) + child(1) * amount;
}

float pixel_value(const TextureNode& node, float value)
{
    value *= node.scale;
    return node.invert ? std::max(0.0f, 1.0f - value) : value;
}

float evaluate_float_image(const Textures& textures, const TextureNode& node, const SurfacePoint& at)
{
    const Image& image = textures.images[node.image];
    const ImageLookup pixels(image, map_2d(node.mapping, at), node.filter, node.wrap);
    switch (image.channels) {
        case 3: return pixel_value(node, (pixels.channel(0) + pixels.channel(1) + pixels.channel(2)) / 3.0f);
        case 4: return pixel_value(node, pixels.channel(3));
        default: return pixel_value(node, pixels.channel(0));
    }
}

Spectrum evaluate_spectrum_image(const Textures& textures, const SpectrumPool& pool, const TextureNode& node,
                                 const SurfacePoint& at, const Wavelengths& wavelengths)
{
    const Image& image = textures.images[node.image];
    const ImageLookup pixels(image, map_2d(node.mapping, at), node.filter, node.wrap);
    Vec3 rgb(pixel_value(node, pixels.channel(0)));
    if (image.channels >= 3) {
        rgb.y = pixel_value(node, pixels.channel(1));
        rgb.z = pixel_value(node, pixels.channel(2));
    }
    for (int c = 0; c < 3; ++c) {
        // Written so that NaN pixels become 0.
        rgb[c] = rgb[c] > 0.0f ? rgb[c] : 0.0f;
        if (node.use == SpectrumUse::albedo) rgb[c] = std::min(rgb[c], 1.0f);
    }
    switch (node.use) {
        case SpectrumUse::unbounded: return pool.evaluate_rgb(RgbUse::unbounded, rgb, wavelengths);
        case SpectrumUse::illuminant: return pool.evaluate_rgb(RgbUse::illuminant, rgb, wavelengths);
        default: return pool.evaluate_rgb(RgbUse::albedo, rgb, wavelengths);
    }
}

}  // namespace

float evaluate(const Textures& textures, FloatTextureId id, const SurfacePoint& at)
{
    const TextureNode& node = textures.floats[id.value];
    const auto child = [&](int i) { return evaluate(textures, FloatTextureId(node.child[i]), at); };
    switch (node.kind) {
        case TextureNode::Kind::constant: return node.value[0];
        case TextureNode::Kind::scale:
            return child(0) * (FloatTextureId(node.amount).valid() ? evaluate(textures, FloatTextureId(node.amount), at)
                                                                   : child(1));
        case TextureNode::Kind::mix:
            return mix_children<float>(evaluate(textures, FloatTextureId(node.amount), at), child);
        case TextureNode::Kind::direction_mix:
            return mix_children<float>(1.0f - std::min(1.0f, abs_dot(at.n_geometric, node.direction)), child);
        case TextureNode::Kind::checkerboard: return child(checkerboard_cell(node, at));
        case TextureNode::Kind::image: return evaluate_float_image(textures, node, at);
        case TextureNode::Kind::bilerp: {
            const Vec2 st = map_2d(node.mapping, at);
            return lerp(st.x, lerp(st.y, node.value[0], node.value[1]), lerp(st.y, node.value[2], node.value[3]));
        }
    }
    return 0.0f;
}

Spectrum evaluate(const Textures& textures, const SpectrumPool& pool, SpectrumTextureId id, const SurfacePoint& at,
                  const Wavelengths& wavelengths)
{
    const TextureNode& node = textures.spectra[id.value];
    const auto child = [&](int i) {
        return evaluate(textures, pool, SpectrumTextureId(node.child[i]), at, wavelengths);
    };
    switch (node.kind) {
        case TextureNode::Kind::constant: return pool.evaluate(node.spectrum[0], wavelengths);
        case TextureNode::Kind::scale:
            if (FloatTextureId(node.amount).valid())
                return child(0) * evaluate(textures, FloatTextureId(node.amount), at);
            return child(0) * child(1);
        case TextureNode::Kind::mix:
            return mix_children<Spectrum>(evaluate(textures, FloatTextureId(node.amount), at), child);
        case TextureNode::Kind::direction_mix:
            return mix_children<Spectrum>(1.0f - std::min(1.0f, abs_dot(at.n_geometric, node.direction)), child);
        case TextureNode::Kind::checkerboard: return child(checkerboard_cell(node, at));
        case TextureNode::Kind::image: return evaluate_spectrum_image(textures, pool, node, at, wavelengths);
        case TextureNode::Kind::bilerp: {
            const Vec2 st = map_2d(node.mapping, at);
            const auto corner = [&](int i) { return pool.evaluate(node.spectrum[i], wavelengths); };
            const Spectrum left = corner(0) * (1.0f - st.y) + corner(1) * st.y;
            const Spectrum right = corner(2) * (1.0f - st.y) + corner(3) * st.y;
            return left * (1.0f - st.x) + right * st.x;
        }
    }
    return Spectrum();
}

}  // namespace dapple
