// The small values scenes are made of: spectra as written, inputs that may be textured, transforms that may move.
#pragma once

#include "dapple/base/error.h"
#include "dapple/base/id.h"
#include "dapple/math/transform.h"

#include <string>
#include <variant>
#include <vector>

namespace dapple::scene {

// The colour space in which RGB triples are meant; its white is also the default spectrum of lights.
enum class ColorSpace : uint8_t { srgb, rec2020, aces2065_1, dci_p3 };

// The same value at all wavelengths.
struct Constant {
    float value = 0.0f;
    friend bool operator==(const Constant&, const Constant&) = default;
};
// Linear RGB. What it stands for depends on its use: a reflectance (each in [0,1]), an unbounded quantity, or a light
// (then multiplied by the colour space's white, as pbrt-v4 does).
struct Rgb {
    Vec3 rgb{0, 0, 0};
    ColorSpace color_space = ColorSpace::srgb;
    friend bool operator==(const Rgb&, const Rgb&) = default;
};
// Planck's law, scaled to a maximum of 1 over all wavelengths.
struct Blackbody {
    float kelvin = 6500.0f;
    friend bool operator==(const Blackbody&, const Blackbody&) = default;
};
// A measured spectrum by name, e.g. "metal-Au-eta", "glass-BK7", "stdillum-D65" (scene/names.h lists them).
struct Named {
    std::string name;
    friend bool operator==(const Named&, const Named&) = default;
};
// Values at increasing wavelengths [nm], piecewise linear between them, zero outside.
struct Samples {
    std::vector<float> lambda;
    std::vector<float> values;
    friend bool operator==(const Samples&, const Samples&) = default;
};
// The white of a colour space: the spectrum of a light whose spectrum is not given.
struct White {
    ColorSpace color_space = ColorSpace::srgb;
    friend bool operator==(const White&, const White&) = default;
};

struct SpectrumSource {
    std::variant<Constant, Rgb, Blackbody, Named, Samples, White> value;
    SourceLocation at;  // where it was written; empty for defaults

    SpectrumSource() = default;
    template <class Value>
    explicit SpectrumSource(Value v, SourceLocation where = {}) : value(std::move(v)), at(std::move(where))
    {
    }
};

struct FloatTextureTag {};
struct SpectrumTextureTag {};
struct MaterialTag {};
struct MediumTag {};
struct AreaLightTag {};
struct ObjectTag {};
using FloatTextureIndex = Id<FloatTextureTag>;        // into Description::float_textures
using SpectrumTextureIndex = Id<SpectrumTextureTag>;  // into Description::spectrum_textures
using MaterialIndex = Id<MaterialTag>;                // into Description::materials
using MediumIndex = Id<MediumTag>;                    // into Description::media; none: vacuum
using AreaLightIndex = Id<AreaLightTag>;              // into Description::area_lights
using ObjectIndex = Id<ObjectTag>;                    // into Description::objects

// A number, or a float texture in its place when `texture` is valid.
struct FloatInput {
    float value = 0.0f;
    FloatTextureIndex texture;
    SourceLocation at;

    FloatInput() = default;
    explicit FloatInput(float v) : value(v) {}
    bool textured() const { return texture.valid(); }
};

// A spectrum, or a spectrum texture in its place when `texture` is valid.
struct SpectrumInput {
    SpectrumSource value;
    SpectrumTextureIndex texture;

    SpectrumInput() = default;
    explicit SpectrumInput(SpectrumSource v) : value(std::move(v)) {}
    explicit SpectrumInput(float constant) : value(Constant{constant}) {}
    bool textured() const { return texture.valid(); }
};

// A transform at two times [s]; constant when both are the same. Both matrices are invertible.
struct MovingMatrix {
    Matrix4 start;
    Matrix4 end;
    float start_time = 0.0f;
    float end_time = 1.0f;

    bool moves() const { return start != end; }
};

}  // namespace dapple::scene
