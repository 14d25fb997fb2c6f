// The k smallest of a stream of squared distances, without a heap: candidates below the current limit are appended, and
// when the buffer is full a threshold search by counting (eight comparisons at a time, no branch on the data) throws
// away all but the k nearest and tightens the limit. One such object per thread is reused for all its queries.
#pragma once

#include "dapple/base/assert.h"
#include "dapple/math/vec.h"
#include "dapple/photons/float8.h"

#include <bit>
#include <deque>
#include <vector>

namespace dapple {

class NearestPoints {
public:
    // Allocates room for the k nearest points (k >= 1) of any number of later queries.
    explicit NearestPoints(int k) : k_(std::max(1, k)), capacity_(k_ == 1 ? 1 : k_ + 40 + k_ / 8)
    {
        distance_squared_.resize(static_cast<size_t>(capacity_) + 24);
        index_.resize(static_cast<size_t>(capacity_) + 24);
    }

    int k() const { return k_; }
    // How many points the last query found: k, or fewer if the search radius held fewer. Their order is not sorted,
    // but it depends on the tree and the query alone.
    int count() const { return count_; }
    uint32_t index(int i) const { return index_[static_cast<size_t>(i)]; }
    float distance_squared(int i) const { return distance_squared_[static_cast<size_t>(i)]; }

    // The place (0 to count() - 1) of the farthest point found; count() must not be 0.
    int farthest() const
    {
        int best = 0;
        for (int i = 1; i < count_; ++i)
            if (distance_squared(i) > distance_squared(best)) best = i;
        return best;
    }

    // The three below are for searches: begin, then add candidates nearer than sqrt(limit()), then finish.
    void begin(float max_distance_squared)
    {
        count_ = 0;
        limit_ = max_distance_squared;
    }
    float limit() const { return limit_; }
    // Adds those of eight candidates whose mask bit is set; the squared distances must be below limit().
    void add(Float8 distance_squared, uint32_t first_index, uint32_t mask)
    {
        count_ += compress_store(distance_squared, first_index, mask, distance_squared_.data() + count_,
                                 index_.data() + count_);
        if (count_ >= capacity_) keep_nearest();
    }
    void finish()
    {
        if (count_ > k_) keep_nearest();
    }

private:
    void keep_nearest();
    int count_below(float threshold) const;
    float largest() const;
    void compact(float threshold, int ties);

    int k_;
    int capacity_;  // candidates before the next threshold search; tuned on k = 50
    int count_ = 0;
    float limit_ = infinity;
    std::vector<float> distance_squared_;
    std::vector<uint32_t> index_;
};

inline int NearestPoints::count_below(float threshold) const
{
    const float* d = distance_squared_.data();
#ifdef __AVX2__
    const __m256 limit = _mm256_set1_ps(threshold);
    __m256i sum = _mm256_setzero_si256();
    for (int i = 0; i < count_; i += 8)
        sum = _mm256_sub_epi32(sum, _mm256_castps_si256(_mm256_cmp_ps(_mm256_loadu_ps(d + i), limit, _CMP_LT_OQ)));
    __m128i s = _mm_add_epi32(_mm256_castsi256_si128(sum), _mm256_extracti128_si256(sum, 1));
    s = _mm_add_epi32(s, _mm_shuffle_epi32(s, 0x4e));
    s = _mm_add_epi32(s, _mm_shuffle_epi32(s, 0xb1));
    return _mm_cvtsi128_si32(s);
#else
    int sum = 0;
    for (int i = 0; i < count_; ++i) sum += d[i] < threshold;
    return sum;
#endif
}

inline float NearestPoints::largest() const
{
    Float8 largest = Float8::all(0.0f);
    float lanes[8];
    int i = 0;
    for (; i + 8 <= count_; i += 8) largest = max(largest, Float8::load(distance_squared_.data() + i));
    largest.store(lanes);
    float result = *std::max_element(lanes, lanes + 8);
    for (; i < count_; ++i) result = std::max(result, distance_squared_[static_cast<size_t>(i)]);
    return result;
}

// Keeps all entries below the threshold and the first `ties` of those equal to it.
inline void NearestPoints::compact(float threshold, int ties)
{
    float* d = distance_squared_.data();
    uint32_t* index = index_.data();
    int kept = 0;
    if (ties > 0) {
        for (int i = 0; i < count_; ++i) {
            if (!(d[i] < threshold) && (d[i] != threshold || ties-- <= 0)) continue;
            d[kept] = d[i];
            index[kept++] = index[i];
        }
        count_ = kept;
        return;
    }
    const Float8 limit = Float8::all(threshold);
    for (int i = 0; i < count_; i += 8) {
        const Float8 values = Float8::load(d + i);
        kept += compress_store(values, index + i, less_mask(values, limit), d + kept, index + kept);
    }
    count_ = kept;
}

// Finds a threshold with exactly k entries below it, first by interpolating between counts (squared distances of points
// on a surface are spread evenly), then by halving the interval of bit patterns, which ends after 31 steps at most.
inline void NearestPoints::keep_nearest()
{
    if (k_ == 1) {
        size_t best = 0;
        for (size_t i = 1; i < static_cast<size_t>(count_); ++i)
            if (distance_squared_[i] < distance_squared_[best]) best = i;
        limit_ = distance_squared_[0] = distance_squared_[best];
        index_[0] = index_[best];
        count_ = 1;
        return;
    }
    // Entries after the last are infinite, so that full registers may be compared.
    for (int i = 0; i < 8; ++i) distance_squared_[static_cast<size_t>(count_ + i)] = infinity;
    float low = 0.0f;
    float high = std::bit_cast<float>(std::bit_cast<uint32_t>(largest()) + 1u);
    int below_low = 0;
    int below_high = count_;
    for (int step = 0;; ++step) {
        const uint32_t low_bits = std::bit_cast<uint32_t>(low);
        const uint32_t high_bits = std::bit_cast<uint32_t>(high);
        if (high_bits - low_bits < 2) break;
        float middle =
            low + (high - low) * (static_cast<float>(k_ - below_low) / static_cast<float>(below_high - below_low));
        if (step > 5 || !(middle > low && middle < high))
            middle = std::bit_cast<float>(low_bits + (high_bits - low_bits) / 2);
        const int below = count_below(middle);
        if (below == k_) {
            compact(middle, 0);
            limit_ = largest();
            return;
        }
        (below < k_ ? low : high) = middle;
        (below < k_ ? below_low : below_high) = below;
    }
    compact(low, k_ - below_low);
    limit_ = low;
}

// Scratch space of the thread for searches of k points, until it asks for the same k again. (A few k in a render.)
inline NearestPoints& thread_nearest_points(int k)
{
    thread_local std::deque<NearestPoints> all;
    for (NearestPoints& nearest : all)
        if (nearest.k() == std::max(k, 1)) return nearest;
    return all.emplace_back(k);
}

}  // namespace dapple
