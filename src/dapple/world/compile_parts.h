// The steps of compile(), one per kind of thing; private to the world room.
#pragma once

#include "dapple/scene/description.h"
#include "dapple/spectrum/make_spectrum.h"
#include "dapple/world/compile.h"

#include <map>
#include <string>
#include <vector>

namespace dapple::detail {

struct CompileContext {
    const scene::Description& description;
    World& world;
    CompileReport& report;
    scene::Camera camera;                             // of the description, held still where its options want no jitter
    std::map<std::string, uint32_t> image_ids;        // by path and reading options: index into Textures::images
    std::map<std::string, uint32_t> light_image_ids;  // by path: index into Lights::images
    std::vector<SpectrumTextureId> spectrum_ids;      // of description.spectrum_textures, as albedo
    std::vector<FloatTextureId> float_ids;
};

// What a spectrum of the scene is for.
enum class SpectrumUsage : uint8_t { reflectance, unbounded, light, index };

const ColorSpace& color_space_of(scene::ColorSpace space);

// A spectrum as written, made ready for its use; lights are not yet scaled (photometric_scale).
SpectrumValue compile_spectrum(SpectrumPool& pool, const scene::SpectrumSource& source, SpectrumUsage usage);

// Images are read first and in parallel, then nodes are made.
void compile_textures(CompileContext& context);
// The texture of an input: its own, or a new constant one.
FloatTextureId float_texture(CompileContext& context, const scene::FloatInput& input);
SpectrumTextureId spectrum_texture(CompileContext& context, const scene::SpectrumInput& input, SpectrumUsage usage);
// Index into Textures::images; a missing or unreadable file gives a magenta pixel and a warning.
uint32_t texture_image(CompileContext& context, const std::filesystem::path& file, scene::Encoding encoding,
                       float gamma, const SourceLocation& at);

void compile_materials(CompileContext& context);
void compile_media(CompileContext& context);
void compile_shapes(CompileContext& context);
// After compile_shapes and the accelerator (far lights need the scene's bounds).
void compile_lights(CompileContext& context);
void compile_camera(CompileContext& context);

// Adds one light per primitive of an emissive geometry; returns the first. Called by compile_shapes.
LightId compile_area_lights(CompileContext& context, const scene::Shape& shape, const Geometry& geometry,
                            const std::vector<Primitive>& primitives);

// Re-keys a transform given at scene times to the camera's shutter interval: ray times run from 0 to 1 over it.
AnimatedTransform over_shutter(const scene::MovingMatrix& matrix, const scene::Camera& camera);

inline MediumId medium_id(scene::MediumIndex index) { return index.valid() ? MediumId(index.value) : MediumId(); }

// The group of that name, added when new; the empty name is group 0.
LightGroup light_group(World& world, const std::string& name);

}  // namespace dapple::detail
