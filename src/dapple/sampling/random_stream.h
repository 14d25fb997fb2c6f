// Random numbers as a pure function of (seed, stream, path index, dimension): any pixel or photon path can be replayed,
// and nothing depends on threads. The first dimensions are points of an Owen-scrambled Sobol sequence in the path index
// (padded 2D points, shuffled per dimension pair; Burley 2020, "Practical hash-based Owen scrambling"), so that
// successive paths of one stream spread evenly; later dimensions are hashes.
#pragma once

#include "dapple/math/hash.h"
#include "dapple/math/vec.h"

namespace dapple {

class RandomStream {
public:
    // stream: which sequence (a pixel, or a purpose such as "photons of set 3"); index: which point of it.
    RandomStream(uint64_t seed, uint64_t stream, uint32_t index);

    // The next number in [0, 1).
    float next();
    // The next pair in [0, 1)^2, well distributed as a pair.
    Vec2 next_2d();
    // The next number as an integer in [0, n), n > 0.
    uint32_t next_index(uint32_t n);
    // Passes over `count` numbers that would not be looked at; those after them stay the same.
    void skip(uint32_t count) { dimension_ += count; }

    uint32_t dimension() const { return dimension_; }

private:
    static constexpr uint32_t low_discrepancy_dimensions = 64;

    // The index with its bits shuffled for one dimension (or pair of them).
    uint32_t shuffled_index(uint64_t h) const;

    uint64_t key_;
    uint32_t index_;
    uint32_t reversed_index_;
    uint32_t dimension_ = 0;
};

namespace detail {

constexpr uint32_t reverse_bits(uint32_t x)
{
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    return __builtin_bswap32(x);
}

constexpr uint64_t reverse_bits(uint64_t x)
{
    x = ((x >> 1) & 0x5555555555555555u) | ((x & 0x5555555555555555u) << 1);
    x = ((x >> 2) & 0x3333333333333333u) | ((x & 0x3333333333333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0f0f0f0f0fu) | ((x & 0x0f0f0f0f0f0f0f0fu) << 4);
    return __builtin_bswap64(x);
}

// Owen scrambling of a bit-reversed word: each bit is flipped by a hash of the bits below it (Laine and Karras 2011
// in the improved form of Burley 2020, listing 3's family of constants by N. Vegdahl).
constexpr uint32_t owen_scramble_reversed(uint32_t x, uint32_t seed)
{
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

constexpr uint32_t owen_scramble(uint32_t x, uint32_t seed)
{
    return reverse_bits(owen_scramble_reversed(reverse_bits(x), seed));
}

// Second Sobol dimension (primitive polynomial x + 1), bit-reversed, of the point `index`. Its generator matrix is
// Pascal's triangle modulo 2, the Kronecker power of [1 1; 0 1]: five steps, one per factor.
constexpr uint32_t sobol_second_reversed(uint32_t index)
{
    index ^= (index >> 1) & 0x55555555u;
    index ^= (index >> 2) & 0x33333333u;
    index ^= (index >> 4) & 0x0f0f0f0fu;
    index ^= (index >> 8) & 0x00ff00ffu;
    index ^= (index >> 16) & 0x0000ffffu;
    return index;
}

constexpr float to_unit_float32(uint32_t x) { return static_cast<float>(x >> 8) * 0x1p-24f; }

}  // namespace detail

inline RandomStream::RandomStream(uint64_t seed, uint64_t stream, uint32_t index)
    : key_(mix64(hash_words(seed, stream))), index_(index), reversed_index_(detail::reverse_bits(index))
{
}

inline uint32_t RandomStream::shuffled_index(uint64_t h) const
{
    return detail::reverse_bits(detail::owen_scramble_reversed(reversed_index_, static_cast<uint32_t>(h)));
}

inline Vec2 RandomStream::next_2d()
{
    const uint64_t h = mix64(key_ ^ dimension_);
    dimension_ += 2;
    if (dimension_ > low_discrepancy_dimensions) {
        const uint64_t bits = mix64(h ^ index_);
        return {detail::to_unit_float32(static_cast<uint32_t>(bits)),
                detail::to_unit_float32(static_cast<uint32_t>(bits >> 32))};
    }
    // Shuffling the index keeps pairs of dimensions independent; scrambling the points randomises each pair.
    const uint32_t shuffled = shuffled_index(h);
    const uint64_t scramble = mix64(h);
    const uint32_t x = detail::owen_scramble_reversed(shuffled, static_cast<uint32_t>(scramble));
    const uint32_t y =
        detail::owen_scramble_reversed(detail::sobol_second_reversed(shuffled), static_cast<uint32_t>(scramble >> 32));
    const uint64_t both = detail::reverse_bits((static_cast<uint64_t>(y) << 32) | x);  // x comes out above
    return {detail::to_unit_float32(static_cast<uint32_t>(both >> 32)),
            detail::to_unit_float32(static_cast<uint32_t>(both))};
}

inline float RandomStream::next()
{
    const uint64_t h = mix64(key_ ^ dimension_);
    dimension_ += 1;
    if (dimension_ > low_discrepancy_dimensions)
        return detail::to_unit_float32(static_cast<uint32_t>(mix64(h ^ index_)));
    const uint32_t shuffled = shuffled_index(h);
    const uint32_t x = detail::owen_scramble_reversed(shuffled, static_cast<uint32_t>(mix64(h)));
    return detail::to_unit_float32(detail::reverse_bits(x));
}

inline uint32_t RandomStream::next_index(uint32_t n)
{
    return std::min(static_cast<uint32_t>(next() * static_cast<float>(n)), n - 1);
}

}  // namespace dapple
