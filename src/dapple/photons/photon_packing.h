// How a photon map keeps directions, normals and fluxes.
//  - A unit vector is projected onto an octahedron and unfolded to a square (Cigolle et al. 2014, "A survey of
//    efficient representations for independent unit vectors"): two words of 16 bits (error below 1e-4 rad) or, for
//    normals that are compared with another normal or with flat discs, of 8 bits (error below 0.02 rad).
//  - A flux is four signed mantissas of 14 bits with one exponent of 8 bits: 64 bits. The step is at most 2.5e-4 of
//    the largest lane, and the mantissas are rounded up or down at random (by a hash of the photon's number) so that
//    the expected value is exact: sums over many photons, even of faint lanes, have no bias.
#pragma once

#include "dapple/math/hash.h"
#include "dapple/math/vec.h"
#include "dapple/spectrum/spectrum.h"

#include <array>
#include <bit>

namespace dapple {

// The point of [-1, 1]^2 that unit vector w unfolds to.
inline Vec2 octahedral_from_unit(const Vec3& w)
{
    const float scale = 1.0f / (std::fabs(w.x) + std::fabs(w.y) + std::fabs(w.z));
    const float u = w.x * scale;
    const float v = w.y * scale;
    if (w.z >= 0.0f) return {u, v};
    return {std::copysign(1.0f - std::fabs(v), u), std::copysign(1.0f - std::fabs(u), v)};
}

// The unit vector of a point of [-1, 1]^2.
inline Vec3 unit_from_octahedral(float u, float v)
{
    Vec3 w(u, v, 1.0f - std::fabs(u) - std::fabs(v));
    if (w.z < 0.0f) {
        w.x = std::copysign(1.0f - std::fabs(v), u);
        w.y = std::copysign(1.0f - std::fabs(u), v);
    }
    return normalize(w);
}

// Two words of `bits` bits, u in the lower ones; 0 and 2^bits - 2 are -1 and 1, so that 0 has a code of its own.
template <int bits>
constexpr float octahedral_steps = static_cast<float>((1 << (bits - 1)) - 1);

template <int bits>
uint32_t pack_unit(const Vec3& w)
{
    const Vec2 p = octahedral_from_unit(w);
    const auto word = [](float x) {
        return static_cast<uint32_t>(std::floor((std::clamp(x, -1.0f, 1.0f) + 1.0f) * octahedral_steps<bits> + 0.5f));
    };
    return word(p.x) | word(p.y) << bits;
}

template <int bits>
Vec3 unpack_unit(uint32_t packed)
{
    constexpr float step = 1.0f / octahedral_steps<bits>;
    const auto number = [](uint32_t word) { return static_cast<float>(word) * step - 1.0f; };
    return unit_from_octahedral(number(packed & ((1u << bits) - 1u)), number(packed >> bits));
}

// Bits 0 to 7: exponent + 112, bits 8 + 14 i and up: mantissa of lane i; value = mantissa 2^(exponent - 13). Fluxes
// below 2^-113 become 0; lanes must be below 2^127 in magnitude.
struct PackedFlux {
    std::array<uint16_t, 4> words{};
};

inline constexpr int flux_mantissa_bits = 14;
inline constexpr int flux_exponent_bias = 112;

inline PackedFlux pack_flux(const Spectrum& flux, uint64_t photon_number)
{
    float largest = 0.0f;
    for (int i = 0; i < Spectrum::lanes; ++i) largest = std::max(largest, std::fabs(flux[i]));
    if (largest < 0x1p-113f) return {};
    // 2^exponent is the power of two above the largest lane; all of these numbers are normal floats.
    const auto power_of_two = [](int e) { return std::bit_cast<float>(static_cast<uint32_t>(e + 127) << 23); };
    int exponent = static_cast<int>(std::bit_cast<uint32_t>(largest) >> 23) - 126;
    // A lane within one step of that power could be rounded up to it, which has no code.
    constexpr float largest_mantissa = static_cast<float>((1 << (flux_mantissa_bits - 1)) - 1);
    if (largest * power_of_two(flux_mantissa_bits - 1 - exponent) > largest_mantissa) ++exponent;
    const float scale = power_of_two(flux_mantissa_bits - 1 - exponent);
    uint64_t bits = static_cast<uint64_t>(exponent + flux_exponent_bias);
    uint64_t dither = mix64(photon_number);
    for (int i = 0; i < Spectrum::lanes; ++i, dither >>= 16) {
        const float u = static_cast<float>(dither & 0xffffu) * 0x1p-16f;
        const float scaled = flux[i] * scale;
        const float whole = std::floor(scaled);
        const int32_t mantissa = static_cast<int32_t>(whole) + (scaled - whole > u ? 1 : 0);
        bits |= (static_cast<uint64_t>(mantissa) & 0x3fffu) << (8 + flux_mantissa_bits * i);
    }
    PackedFlux packed;
    for (int i = 0; i < 4; ++i) packed.words[static_cast<size_t>(i)] = static_cast<uint16_t>(bits >> (16 * i));
    return packed;
}

inline Spectrum unpack_flux(const PackedFlux& packed)
{
    uint64_t bits = 0;
    for (int i = 0; i < 4; ++i) bits |= static_cast<uint64_t>(packed.words[static_cast<size_t>(i)]) << (16 * i);
    // 2^(exponent - 13), written as the bits of a float: all codes give normal numbers.
    const int exponent = static_cast<int>(bits & 0xffu) - flux_exponent_bias - (flux_mantissa_bits - 1);
    const float step = std::bit_cast<float>(static_cast<uint32_t>(exponent + 127) << 23);
    Spectrum flux;
    for (int i = 0; i < Spectrum::lanes; ++i) {
        const int shift = 64 - (8 + flux_mantissa_bits * (i + 1));
        const auto mantissa = static_cast<int64_t>(bits << shift) >> (64 - flux_mantissa_bits);
        flux[i] = static_cast<float>(mantissa) * step;
    }
    return flux;
}

}  // namespace dapple
