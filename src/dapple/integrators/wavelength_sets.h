// The wavelength sets of a pass: eye paths can only read photons of their own wavelengths, so the pixels of a pass
// share a few sets, and photons are traced for each.
#pragma once

#include "dapple/integrators/pixel_loop.h"

namespace dapple {

// The wavelengths of set `set` of `sets` in an epoch (or pass): the sets interleave, so that together they sample the
// visible range finely and no epoch shows a tint.
Wavelengths wavelengths_of_set(ColorModel model, uint64_t seed, uint32_t epoch, int set, int sets);

// The time in the shutter that all paths of a set share in a pass: so light and eye paths see moving things at one
// place. Times are spread evenly as passes go on; sets change places every `sets` passes, so that no wavelengths belong
// to a part of the shutter.
float time_of_set(uint64_t seed, uint32_t pass, int set, int sets);

// The set that a pixel uses in a pass: every block of 2 x 2 pixels uses four sets, and each pixel goes round all of
// them. Blocks do so in orders of their own, which change with every round: the photons of a set are smooth noise, and
// a regular order would show it as a screen of dots.
inline size_t set_of_pixel(Int2 pixel, uint32_t pass, size_t sets)
{
    const auto x = static_cast<uint32_t>(pixel.x), y = static_cast<uint32_t>(pixel.y);
    const uint64_t block = (uint64_t(y / 2) << 32) | (x / 2);
    const auto turn = static_cast<uint32_t>(hash_words(block, pass / sets)) & 3u;
    return ((((x & 1u) + 2u * (y & 1u)) ^ turn) + pass) % sets;
}

// for_each_pixel where pixel after pixel takes its set: calls trace(EyeSample&, i) with wavelengths
// sets[i].wavelengths.
template <class Sets, class Trace>
void for_each_pixel_of_sets(const PassContext& context, Film& film, const Sets& sets, const Trace& trace)
{
    const auto set_of = [&](Int2 pixel) { return set_of_pixel(pixel, context.pass, sets.size()); };
    for_each_pixel(
        context, film, [&](Int2 pixel, RandomStream&) { return sets[set_of(pixel)].wavelengths; },
        [&](EyeSample& sample) { trace(sample, set_of(sample.pixel)); });
}

}  // namespace dapple
