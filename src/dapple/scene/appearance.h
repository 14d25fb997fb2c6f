// Textures, materials and media. Defaults are pbrt-v4's.
#pragma once

#include "dapple/scene/values.h"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace dapple::scene {

// ---- textures ------------------------------------------------------------------------------------------------------

struct TextureMapping {
    enum class Kind : uint8_t { uv, spherical, cylindrical, planar };
    Kind kind = Kind::uv;
    float u_scale = 1, v_scale = 1, u_delta = 0, v_delta = 0;  // uv; deltas also planar
    Vec3 v1{1, 0, 0}, v2{0, 1, 0};                             // planar
};

enum class Wrap : uint8_t { repeat, clamp, black };
enum class ImageFilter : uint8_t { nearest, bilinear };  // "point" reads as nearest, "trilinear" and "ewa" as bilinear
enum class Encoding : uint8_t { automatic, srgb, linear, gamma };  // automatic: sRGB for 8-bit files, else linear

// Input is FloatInput or SpectrumInput; Value is float or SpectrumSource.
template <class Input>
struct ScaleTexture {
    Input texture{1.0f};
    FloatInput scale{1.0f};
};
template <class Input>
struct MixTexture {  // lerp(amount, first, second)
    Input first{0.0f};
    Input second{1.0f};
    FloatInput amount{0.5f};
};
template <class Input>
struct DirectionMixTexture {  // first where the normal is along +-direction (world space), second across it
    Input first{0.0f};
    Input second{1.0f};
    Vec3 direction{0, 1, 0};
};
template <class Input>
struct CheckerboardTexture {
    int dimension = 2;  // 2: over (u, v) of the mapping; 3: over texture space
    Input first{1.0f};
    Input second{0.0f};
};
struct ImageTexture {
    std::filesystem::path file;  // resolved; may not exist (shown magenta, with a warning)
    Wrap wrap = Wrap::repeat;
    ImageFilter filter = ImageFilter::bilinear;
    Encoding encoding = Encoding::automatic;
    float gamma = 2.2f;  // for Encoding::gamma
    float scale = 1.0f;
    bool invert = false;  // 1 - value, after the scale
};
template <class Value>
struct BilerpTexture {
    Value v00, v01, v10, v11;  // vuv at (u, v)
};

template <class Input, class Value>
struct Texture {
    std::variant<Value, ScaleTexture<Input>, MixTexture<Input>, DirectionMixTexture<Input>, CheckerboardTexture<Input>,
                 ImageTexture, BilerpTexture<Value>>
        kind;  // the bare Value: a constant texture
    TextureMapping mapping;
    Matrix4 world_from_texture;  // where the texture was defined
    ColorSpace color_space = ColorSpace::srgb;
    std::string name;
    SourceLocation at;
};
using FloatTexture = Texture<FloatInput, float>;
using SpectrumTexture = Texture<SpectrumInput, SpectrumSource>;

// ---- materials -----------------------------------------------------------------------------------------------------

// A medium boundary without any surface.
struct InterfaceMaterial {};

struct DiffuseMaterial {
    SpectrumInput reflectance{0.5f};
};
struct DiffuseTransmissionMaterial {
    SpectrumInput reflectance{0.25f};
    SpectrumInput transmittance{0.25f};
    float scale = 1.0f;
};
// Roughness along u and v; GGX alpha = sqrt(roughness) if remapped, else roughness itself.
struct RoughnessInput {
    FloatInput u{0.0f};
    FloatInput v{0.0f};
};
struct DielectricMaterial {
    SpectrumSource eta{Constant{1.5f}};  // index inside over index outside
    RoughnessInput roughness;
    bool remap_roughness = true;
};
struct ThinDielectricMaterial {
    SpectrumSource eta{Constant{1.5f}};
};
struct ConductorMaterial {
    std::optional<SpectrumInput> reflectance;  // if given, stands in place of eta and k
    SpectrumInput eta{SpectrumSource(Named{"metal-Cu-eta"})};
    SpectrumInput k{SpectrumSource(Named{"metal-Cu-k"})};
    RoughnessInput roughness;
    bool remap_roughness = true;
};
// The coat of the layered materials.
struct CoatLayer {
    SpectrumSource eta{Constant{1.5f}};
    RoughnessInput roughness;
    FloatInput thickness{0.01f};
    FloatInput g{0.0f};
    SpectrumInput albedo{0.0f};  // of the medium between coat and base
    int max_depth = 10;
    int samples = 1;
};
struct CoatedDiffuseMaterial {
    SpectrumInput reflectance{0.5f};
    CoatLayer coat;
    bool remap_roughness = true;
};
struct CoatedConductorMaterial {
    std::optional<SpectrumInput> reflectance;
    SpectrumInput eta{SpectrumSource(Named{"metal-Cu-eta"})};
    SpectrumInput k{SpectrumSource(Named{"metal-Cu-k"})};
    RoughnessInput roughness;  // of the conductor
    CoatLayer coat;
    bool remap_roughness = true;
};
struct MixMaterial {
    std::array<MaterialIndex, 2> materials;
    FloatInput amount{0.5f};  // share of the second
};

struct Material {
    std::variant<InterfaceMaterial, DiffuseMaterial, DiffuseTransmissionMaterial, DielectricMaterial,
                 ThinDielectricMaterial, ConductorMaterial, CoatedDiffuseMaterial, CoatedConductorMaterial, MixMaterial>
        kind = DiffuseMaterial{};
    std::optional<FloatInput> displacement;  // bump map: height in the unit of the scene [m]
    std::filesystem::path normal_map;        // empty: none
    std::string name;                        // of MakeNamedMaterial; empty for anonymous ones
    SourceLocation at;
};

// ---- media ---------------------------------------------------------------------------------------------------------

// Values on a regular grid, x fastest.
struct GridData {
    int nx = 1, ny = 1, nz = 1;
    std::vector<float> values;
};
struct RgbGridData {
    int nx = 1, ny = 1, nz = 1;
    std::vector<Vec3> values;
};

struct HomogeneousMedium {
    std::string preset;                      // if given, stands in place of sigma_a and sigma_s (scene/names.h)
    SpectrumSource sigma_a{Constant{1.0f}};  // [1/m]
    SpectrumSource sigma_s{Constant{1.0f}};  // [1/m]
    std::optional<SpectrumSource> emission;  // Le, scaled to a luminance of emission_scale [cd/m2]; times sigma_a
    float emission_scale = 1.0f;
};
struct UniformGridMedium {
    SpectrumSource sigma_a{Constant{1.0f}};  // [1/m] at density 1
    SpectrumSource sigma_s{Constant{1.0f}};
    GridData density;
    std::optional<SpectrumSource> emission;
    GridData emission_scale;                                    // empty values: 1 everywhere
    GridData temperature;                                       // [K] after scale and offset; empty values: none
    float temperature_scale = 1.0f, temperature_offset = 0.0f;  // kelvin = (value - offset) * scale
    Vec3 p0{0, 0, 0}, p1{1, 1, 1};                              // bounds in medium space
};
struct RgbGridMedium {
    RgbGridData sigma_a, sigma_s;  // [1/m]; empty values: 1 everywhere
    RgbGridData emission;          // empty values: none
    float emission_scale = 1.0f;
    ColorSpace color_space = ColorSpace::srgb;
    Vec3 p0{0, 0, 0}, p1{1, 1, 1};
};
struct NanoVdbMedium {
    std::filesystem::path file;
    std::string density_grid = "density";
    std::string temperature_grid = "temperature";
    SpectrumSource sigma_a{Constant{1.0f}};
    SpectrumSource sigma_s{Constant{1.0f}};
    float emission_scale = 1.0f;
    float temperature_scale = 1.0f, temperature_offset = 0.0f;
};

struct Medium {
    std::variant<HomogeneousMedium, UniformGridMedium, RgbGridMedium, NanoVdbMedium> kind;
    float g = 0.0f;      // Henyey-Greenstein mean cosine
    float scale = 1.0f;  // multiplies sigma_a and sigma_s
    Matrix4 world_from_medium;
    std::string name;
    SourceLocation at;
};

}  // namespace dapple::scene
