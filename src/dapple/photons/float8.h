// Eight floats at a time: AVX2 where the compiler may use it, plain loops elsewhere. Both give the same bits (no fused
// multiply-add), so a tree query does not depend on the build.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

#ifdef __AVX2__
#include <immintrin.h>
#endif

namespace dapple {

#ifdef __AVX2__

struct Float8 {
    static constexpr int size = 8;
    __m256 v;

    static Float8 load(const float* p) { return {_mm256_loadu_ps(p)}; }
    static Float8 all(float x) { return {_mm256_set1_ps(x)}; }
    void store(float* p) const { _mm256_storeu_ps(p, v); }

    friend Float8 operator+(Float8 a, Float8 b) { return {_mm256_add_ps(a.v, b.v)}; }
    friend Float8 operator-(Float8 a, Float8 b) { return {_mm256_sub_ps(a.v, b.v)}; }
    friend Float8 operator*(Float8 a, Float8 b) { return {_mm256_mul_ps(a.v, b.v)}; }
};
// The second operand where either is NaN.
inline Float8 max(Float8 a, Float8 b) { return {_mm256_max_ps(a.v, b.v)}; }
inline Float8 min(Float8 a, Float8 b) { return {_mm256_min_ps(a.v, b.v)}; }
inline Float8 abs(Float8 a) { return {_mm256_andnot_ps(_mm256_set1_ps(-0.0f), a.v)}; }
inline Float8 sqrt(Float8 a) { return {_mm256_sqrt_ps(a.v)}; }
// Bit i of the result: a[i] < b[i].
inline uint32_t less_mask(Float8 a, Float8 b)
{
    return static_cast<uint32_t>(_mm256_movemask_ps(_mm256_cmp_ps(a.v, b.v, _CMP_LT_OQ)));
}
// The low and the high bytes of eight 16-bit words, as floats.
inline void bytes_to_floats(const uint16_t* words, Float8& low, Float8& high)
{
    const __m256i wide = _mm256_cvtepu16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(words)));
    low.v = _mm256_cvtepi32_ps(_mm256_and_si256(wide, _mm256_set1_epi32(0xff)));
    high.v = _mm256_cvtepi32_ps(_mm256_srli_epi32(wide, 8));
}
// |a| with the sign of s.
inline Float8 copy_sign(Float8 a, Float8 s)
{
    const __m256 sign = _mm256_set1_ps(-0.0f);
    return {_mm256_or_ps(_mm256_andnot_ps(sign, a.v), _mm256_and_ps(sign, s.v))};
}
// a where x < 0, else b.
inline Float8 select_negative(Float8 x, Float8 a, Float8 b) { return {_mm256_blendv_ps(b.v, a.v, x.v)}; }

#else

struct Float8 {
    static constexpr int size = 8;
    float v[8];

    static Float8 load(const float* p)
    {
        Float8 r;
        std::memcpy(r.v, p, sizeof r.v);
        return r;
    }
    static Float8 all(float x) { return {{x, x, x, x, x, x, x, x}}; }
    void store(float* p) const { std::memcpy(p, v, sizeof v); }

    friend Float8 operator+(Float8 a, const Float8& b)
    {
        for (int i = 0; i < 8; ++i) a.v[i] += b.v[i];
        return a;
    }
    friend Float8 operator-(Float8 a, const Float8& b)
    {
        for (int i = 0; i < 8; ++i) a.v[i] -= b.v[i];
        return a;
    }
    friend Float8 operator*(Float8 a, const Float8& b)
    {
        for (int i = 0; i < 8; ++i) a.v[i] *= b.v[i];
        return a;
    }
};
inline Float8 max(Float8 a, const Float8& b)
{
    for (int i = 0; i < 8; ++i) a.v[i] = a.v[i] > b.v[i] ? a.v[i] : b.v[i];
    return a;
}
inline Float8 min(Float8 a, const Float8& b)
{
    for (int i = 0; i < 8; ++i) a.v[i] = a.v[i] < b.v[i] ? a.v[i] : b.v[i];
    return a;
}
inline Float8 abs(Float8 a)
{
    for (float& x : a.v) x = __builtin_fabsf(x);
    return a;
}
inline Float8 sqrt(Float8 a)
{
    for (float& x : a.v) x = __builtin_sqrtf(x);
    return a;
}
inline uint32_t less_mask(const Float8& a, const Float8& b)
{
    uint32_t mask = 0;
    for (int i = 0; i < 8; ++i) mask |= static_cast<uint32_t>(a.v[i] < b.v[i]) << i;
    return mask;
}
inline void bytes_to_floats(const uint16_t* words, Float8& low, Float8& high)
{
    for (int i = 0; i < 8; ++i) {
        low.v[i] = static_cast<float>(words[i] & 0xff);
        high.v[i] = static_cast<float>(words[i] >> 8);
    }
}
inline Float8 copy_sign(Float8 a, const Float8& s)
{
    for (int i = 0; i < 8; ++i) a.v[i] = __builtin_copysignf(a.v[i], s.v[i]);
    return a;
}
inline Float8 select_negative(const Float8& x, const Float8& a, Float8 b)
{
    for (int i = 0; i < 8; ++i) b.v[i] = __builtin_signbit(x.v[i]) ? a.v[i] : b.v[i];
    return b;
}

#endif

// For each 8-bit mask, the positions of its set bits in order (unused places 0), one byte each.
struct CompressTable {
    uint8_t order[256][8] = {};

    constexpr CompressTable()
    {
        for (int mask = 0; mask < 256; ++mask) {
            int n = 0;
            for (int bit = 0; bit < 8; ++bit)
                if (mask >> bit & 1) order[mask][n++] = static_cast<uint8_t>(bit);
        }
    }
};
inline constexpr CompressTable compress_table;

// Moves the entries of values and ids whose mask bit is set to the front of the outputs, in order, and returns how many
// those are. Always writes eight entries; in-place use is safe where the outputs do not lie behind the inputs.
inline int compress_store(Float8 values, const uint32_t* ids, uint32_t mask, float* out_values, uint32_t* out_ids)
{
#ifdef __AVX2__
    const __m128i packed = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(compress_table.order[mask]));
    const __m256i order = _mm256_cvtepu8_epi32(packed);
    const __m256i moved = _mm256_permutevar8x32_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(ids)), order);
    _mm256_storeu_ps(out_values, _mm256_permutevar8x32_ps(values.v, order));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(out_ids), moved);
#else
    uint32_t moved[8];
    for (int i = 0; i < 8; ++i) moved[i] = ids[compress_table.order[mask][i]];
    for (int i = 0; i < 8; ++i) out_values[i] = values.v[compress_table.order[mask][i]];
    std::memcpy(out_ids, moved, sizeof moved);
#endif
    return std::popcount(mask);
}

// The same for the ids first_id, first_id + 1, ..., first_id + 7.
inline int compress_store(Float8 values, uint32_t first_id, uint32_t mask, float* out_values, uint32_t* out_ids)
{
#ifdef __AVX2__
    const __m128i packed = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(compress_table.order[mask]));
    const __m256i order = _mm256_cvtepu8_epi32(packed);
    _mm256_storeu_ps(out_values, _mm256_permutevar8x32_ps(values.v, order));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(out_ids),
                        _mm256_add_epi32(order, _mm256_set1_epi32(static_cast<int>(first_id))));
#else
    for (int i = 0; i < 8; ++i) {
        out_values[i] = values.v[compress_table.order[mask][i]];
        out_ids[i] = first_id + compress_table.order[mask][i];
    }
#endif
    return std::popcount(mask);
}

// Collects what range queries find, so that the visitor runs in one plain loop and not in a branch per lane.
class HitBuffer {
public:
    // ids: a pointer to eight ids, or the first of eight successive ones. Calls visit(id, value) whenever it is full.
    template <class Ids, class Visitor>
    void add(Float8 values, Ids ids, uint32_t mask, Visitor&& visit)
    {
        count_ += compress_store(values, ids, mask, values_ + count_, ids_ + count_);
        if (count_ >= capacity) flush(visit);
    }
    template <class Visitor>
    void flush(Visitor&& visit)
    {
        for (int i = 0; i < count_; ++i) visit(ids_[i], values_[i]);
        count_ = 0;
    }

private:
    static constexpr int capacity = 64;

    int count_ = 0;
    alignas(32) float values_[capacity + 8];
    alignas(32) uint32_t ids_[capacity + 8];
};

// Sorts eight keys, smallest first.
inline void sort8(int32_t* keys)
{
#ifdef __AVX2__
    // Odd-even merge network on one register: six rounds of compare and exchange.
    __m256i x = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(keys));
    const auto exchange = [&x](const __m256i& partner, int high_places) {
        const __m256i other = _mm256_permutevar8x32_epi32(x, partner);
        const __m256i low = _mm256_min_epi32(x, other);
        const __m256i high = _mm256_max_epi32(x, other);
        const __m256i bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
        const __m256i take_high = _mm256_cmpeq_epi32(_mm256_and_si256(bits, _mm256_set1_epi32(high_places)), bits);
        x = _mm256_blendv_epi8(low, high, take_high);
    };
    exchange(_mm256_setr_epi32(1, 0, 3, 2, 5, 4, 7, 6), 0b10101010);
    exchange(_mm256_setr_epi32(3, 2, 1, 0, 7, 6, 5, 4), 0b11001100);
    exchange(_mm256_setr_epi32(1, 0, 3, 2, 5, 4, 7, 6), 0b10101010);
    exchange(_mm256_setr_epi32(7, 6, 5, 4, 3, 2, 1, 0), 0b11110000);
    exchange(_mm256_setr_epi32(2, 3, 0, 1, 6, 7, 4, 5), 0b11001100);
    exchange(_mm256_setr_epi32(1, 0, 3, 2, 5, 4, 7, 6), 0b10101010);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(keys), x);
#else
    for (int i = 1; i < 8; ++i) {
        const int32_t key = keys[i];
        int j = i;
        for (; j > 0 && keys[j - 1] > key; --j) keys[j] = keys[j - 1];
        keys[j] = key;
    }
#endif
}

}  // namespace dapple
