// Textures as nodes in a flat array, joined by ids. Evaluated without mip maps: samples per pixel do the filtering.
#pragma once

#include "dapple/base/id.h"
#include "dapple/image/image.h"
#include "dapple/math/transform.h"
#include "dapple/shapes/surface_point.h"
#include "dapple/spectrum/spectrum_value.h"

#include <cstdint>
#include <vector>

namespace dapple {

struct FloatTextureTag {};
struct SpectrumTextureTag {};
using FloatTextureId = Id<FloatTextureTag>;
using SpectrumTextureId = Id<SpectrumTextureTag>;

struct TextureMapping {
    enum class Kind : uint8_t { uv, spherical, cylindrical, planar };
    Kind kind = Kind::uv;
    float su = 1, sv = 1, du = 0, dv = 0;  // uv and planar
    Vec3 vs{1, 0, 0}, vt{0, 1, 0};         // planar
    Matrix4 texture_from_world;            // all but uv, and checkerboards in 3D
};

enum class ImageWrap : uint8_t { repeat, clamp, black };
enum class ImageFilter : uint8_t { nearest, bilinear };

// How the pixels of a colour image are read as spectra.
enum class SpectrumUse : uint8_t { albedo, unbounded, illuminant };

struct TextureNode {
    enum class Kind : uint8_t {
        constant,
        scale,          // child[0] * amount, or * child[1] if there is no amount
        mix,            // lerp(amount, child[0], child[1])
        direction_mix,  // lerp(|n.dir|, child[1], child[0])
        checkerboard,   // child[0], child[1]
        image,
        bilerp,  // of the values at (0,0), (0,1), (1,0) and (1,1)
    };
    Kind kind = Kind::constant;
    ImageWrap wrap = ImageWrap::repeat;
    ImageFilter filter = ImageFilter::bilinear;
    SpectrumUse use = SpectrumUse::albedo;
    bool invert = false;  // images
    uint8_t checkerboard_dimensions = 2;
    uint32_t child[2] = {0, 0};             // ids of the node's own kind (float or spectrum)
    uint32_t amount = Id<int>::none_value;  // float texture: amount of mix, scale factor of scale
    uint32_t image = 0;
    float scale = 1.0f;  // images
    Vec3 direction{0, 0, 1};
    TextureMapping mapping;
    float value[4] = {0, 0, 0, 0};  // constant (value[0]) and bilerp of float textures
    SpectrumValue spectrum[4];      // the same of spectrum textures
};

// Images hold linear RGB in the colour space that SpectrumPool::prepare_rgb was told. As a float texture an image of
// three channels is their mean, one of four its alpha.
struct Textures {
    std::vector<TextureNode> floats;
    std::vector<TextureNode> spectra;
    std::vector<Image> images;
};

// The texture at a point; ids must be valid. Spectra of images used as illuminants are those of make_illuminant, not
// yet divided by a photometric scale.
float evaluate(const Textures& textures, FloatTextureId id, const SurfacePoint& at);
Spectrum evaluate(const Textures& textures, const SpectrumPool& pool, SpectrumTextureId id, const SurfacePoint& at,
                  const Wavelengths& wavelengths);

}  // namespace dapple
