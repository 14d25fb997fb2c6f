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

// What a render takes besides photons and light paths [bytes]: the account of --memory and of `inspect`.
struct MemoryAccount {
    uint64_t program = program_bytes;
    uint64_t geometry = 0, accelerator = 0, textures = 0, media = 0;
    uint64_t film = 0;        // with the copy of the image that is written, a quarter of the sums; all films of a pass
    uint64_t points = 0;      // what a pass keeps for each pixel
    uint64_t techniques = 0;  // TechniqueRecord::bytes

    uint64_t scene() const { return geometry + accelerator + textures + media; }
    uint64_t total() const { return program + scene() + film + points + techniques; }
};
MemoryAccount memory_account(const CompileReport& report, const FilmSettings& settings, const IntegratorEntry& entry,
                             uint64_t techniques = 0, bool time_limit = false);

// Holds a render to a limit [bytes]; 0: none. Throws UserError, with the parts, if the account alone reaches it.
// Otherwise what it leaves goes to the integrator's setting "memory" if it has one that is still "auto".
void check_memory(uint64_t limit, const MemoryAccount& account, IntegratorChoice& choice);

}  // namespace dapple
