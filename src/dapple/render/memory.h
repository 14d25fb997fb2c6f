// What a render will take, known before it starts.
#pragma once

#include "dapple/film/film.h"
#include "dapple/render/scene_defaults.h"
#include "dapple/world/compile.h"

#include <cstdint>

namespace dapple {

// What the program takes by itself: code, libraries, stacks, caches of the allocator. A constant, so that what is left
// for photons, and with it the image, depends on nothing else (measured with a tiny scene: 141 MiB).
inline constexpr uint64_t program_bytes = uint64_t{144} << 20;

// Pixels of the crop window.
uint64_t pixel_count(const FilmSettings& settings);

// Bytes of the film's sums (128 bits per pixel and channel), at most: layers that stay black take none.
uint64_t film_bytes(const FilmSettings& settings);

// Bytes of geometry, accelerator, textures and media.
uint64_t scene_bytes(const CompileReport& report);

// Holds a render to a limit [bytes]; 0: none. Throws UserError, with the parts, if program, scene, film (with a copy of
// the image, a quarter of it), what a pass keeps for each pixel and the record of techniques (TechniqueRecord::bytes;
// 0: none) alone exceed it.
// Otherwise what they leave goes to the integrator's setting "memory" if it has one that is still "auto".
void check_memory(uint64_t limit, const CompileReport& report, const FilmSettings& settings, IntegratorChoice& choice,
                  uint64_t techniques = 0);

}  // namespace dapple
