// Pearson's chi-squared test, for the tests of samplers.
#pragma once

#include <cmath>
#include <vector>

namespace dapple::testing_support {

// The value that a chi-squared variable with `freedom` degrees of freedom exceeds with probability 1 %
// (Wilson and Hilferty 1931; within 0.5 % for freedom >= 3).
inline double chi_squared_limit(double freedom)
{
    const double z = 2.3263478740408408;
    const double t = 2.0 / (9.0 * freedom);
    return freedom * std::pow(1.0 - t + z * std::sqrt(t), 3.0);
}

// Whether counts agree with the expected counts at the 1 % level. Cells that expect fewer than five are pooled; a count
// where nothing is expected fails at once.
inline bool chi_squared_passes(const std::vector<double>& counts, const std::vector<double>& expected)
{
    double statistic = 0.0, pooled_count = 0.0, pooled_expected = 0.0;
    int cells = 0;
    for (size_t i = 0; i < counts.size(); ++i) {
        if (expected[i] <= 0.0 && counts[i] > 0.0) return false;
        if (expected[i] < 5.0) {
            pooled_count += counts[i];
            pooled_expected += expected[i];
            continue;
        }
        statistic += (counts[i] - expected[i]) * (counts[i] - expected[i]) / expected[i];
        ++cells;
    }
    if (pooled_expected >= 5.0) {
        statistic += (pooled_count - pooled_expected) * (pooled_count - pooled_expected) / pooled_expected;
        ++cells;
    }
    return cells > 1 && statistic < chi_squared_limit(cells - 1);
}

}  // namespace dapple::testing_support
