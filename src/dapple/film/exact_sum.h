// Sums that do not depend on the order of their terms: numbers are rounded once to a 128-bit fixed-point grid of 2^-60
// and then added as integers, which is associative. Thread count, pass order and merge order therefore leave no trace.
// Resolution 2^-60 = 8.7e-19, range of a sum +-2^67 = 1.5e20. A term may be as large as 2^44 = 1.8e13, so that more
// than eight million of the largest terms fit. Terms outside of that, and terms that are not finite, are refused, never
// clamped: the caller counts them. Cost of an atomic addition: one or two locked additions.
#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>

namespace dapple {

using Fixed128 = __int128;

inline constexpr double exact_sum_unit = 0x1p-60;
inline constexpr double exact_sum_limit = 0x1p44;  // largest magnitude of a term

// Whether a term can be added; false for NaN and infinities.
inline bool exact_sum_accepts(double term) { return std::fabs(term) <= exact_sum_limit; }

// The term on the grid, rounded to nearest; the term must be acceptable.
inline Fixed128 to_fixed(double term)
{
    const double scaled = term * 0x1p60;  // exact: a power of two
    if (std::fabs(scaled) < 0x1p62) return std::llrint(scaled);
    return static_cast<Fixed128>(scaled);  // an integer already, as doubles beyond 2^53 are
}

inline double from_fixed(Fixed128 sum) { return static_cast<double>(sum) * exact_sum_unit; }

// A sum with a single writer.
class ExactSum {
public:
    // Adds a term and returns true; returns false and adds nothing if the term is refused.
    bool add(double term)
    {
        if (!exact_sum_accepts(term)) return false;
        sum_ += to_fixed(term);
        return true;
    }
    void add(const ExactSum& other) { sum_ += other.sum_; }
    double value() const { return from_fixed(sum_); }
    Fixed128 fixed() const { return sum_; }

private:
    Fixed128 sum_ = 0;
};

// A sum with many writers, as two words that are zero for the sum 0: memory of zero bytes is a valid array of these.
// Reading is meant for when no one writes.
struct AtomicExactSum {
    uint64_t low;
    uint64_t high;

    void add(Fixed128 term)
    {
        const uint64_t term_low = static_cast<uint64_t>(term);
        const uint64_t old_low = std::atomic_ref<uint64_t>(low).fetch_add(term_low, std::memory_order_relaxed);
        const uint64_t carry = old_low + term_low < old_low ? 1u : 0u;
        // Small terms rarely reach the upper word: a carry out of the lower cancels the sign of a negative term.
        const uint64_t term_high = static_cast<uint64_t>(static_cast<unsigned __int128>(term) >> 64) + carry;
        if (term_high != 0) std::atomic_ref<uint64_t>(high).fetch_add(term_high, std::memory_order_relaxed);
    }
    // The same where no other thread may write: without locked instructions.
    void add_alone(Fixed128 term)
    {
        const auto sum = static_cast<unsigned __int128>(fixed()) + static_cast<unsigned __int128>(term);
        low = static_cast<uint64_t>(sum);
        high = static_cast<uint64_t>(sum >> 64);
    }
    Fixed128 fixed() const { return static_cast<Fixed128>((static_cast<unsigned __int128>(high) << 64) | low); }
};

}  // namespace dapple
