// Sums that do not depend on the order of their terms: numbers are rounded once to a 128-bit fixed-point grid of 2^-60
// and then added as integers, which is associative. Thread count, pass order and merge order therefore leave no trace.
// Resolution 2^-60 = 8.7e-19, range of a sum +-2^67 = 1.5e20. A term may be as large as 2^44 = 1.8e13, so that more
// than eight million of the largest terms fit. Terms outside of that, and terms that are not finite, must not be added:
// films leave them out and count them (Accidents in film.h).
#pragma once

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

}  // namespace dapple
