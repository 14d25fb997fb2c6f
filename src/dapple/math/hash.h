// Integer mixing: the base of every random number and of every deterministic choice.
#pragma once

#include <bit>
#include <cstdint>

namespace dapple {

// splitmix64's finaliser (Steele, Lea, Flood 2014): a bijection of 64-bit words with good avalanche.
constexpr uint64_t mix64(uint64_t x)
{
    x += 0x9e3779b97f4a7c15ull;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}

// Mixes any number of words into one; the order matters.
template <class... Words>
constexpr uint64_t hash_words(uint64_t first, Words... rest)
{
    uint64_t h = mix64(first);
    ((h = mix64(h ^ static_cast<uint64_t>(rest))), ...);
    return h;
}

inline uint64_t float_bits(float x) { return std::bit_cast<uint32_t>(x); }

// A float in [0, 1) from the upper 24 bits.
constexpr float to_unit_float(uint64_t bits) { return static_cast<float>(bits >> 40) * 0x1p-24f; }

}  // namespace dapple
