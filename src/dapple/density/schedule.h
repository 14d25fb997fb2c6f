// The bandwidths of progressive estimation (Knaus and Zwicker 2011; Kaplanyan and Dachsbacher 2013): pass i = 1, 2, ...
// uses r_i with r_i^d = r_1^d Gamma(i + a) / (Gamma(1 + a) Gamma(i + 1)), the closed form of the recurrence
// r_{i+1}^d / r_i^d = (i + a) / (i + 1). Each pass is independent of the others, so any may be computed alone.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace dapple {

// The share of photons kept from pass to pass; 2/3 balances bias and variance on surfaces.
inline constexpr double progressive_alpha = 2.0 / 3.0;

// r_i^d / r_1^d = Gamma(i + a) / (Gamma(1 + a) Gamma(i + 1)) for pass i >= 1 and 0 < a <= 1: 1 at i = 1, falling as
// i^(a - 1). Relative error below 1e-9.
inline double progressive_shrinkage(int64_t pass, double alpha = progressive_alpha)
{
    // The first factors are multiplied. For the rest, the difference of two logarithms of Gamma would cancel (and
    // std::lgamma writes a global), so the quotient's own expansion is used (Tricomi and Erdelyi 1951):
    // Gamma(n + a) / Gamma(n + 1) = m^(a-1) (1 - (a-1)(a-2) a / (24 m^2) + O(m^-4)) with m = n + a / 2.
    constexpr int64_t multiplied = 64;
    double product = 1.0;
    for (int64_t i = 1; i < std::min(pass, multiplied); ++i)
        product *= (static_cast<double>(i) + alpha) / (static_cast<double>(i) + 1.0);
    if (pass <= multiplied) return product;
    const auto quotient = [alpha](int64_t n) {
        const double m = static_cast<double>(n) + 0.5 * alpha;
        return std::pow(m, alpha - 1.0) * (1.0 - (alpha - 1.0) * (alpha - 2.0) * alpha / (24.0 * m * m));
    };
    return product * quotient(pass) / quotient(multiplied);
}

// The radius of pass i >= 1 in dimension 1, 2 or 3, in the unit of first_radius.
inline double progressive_radius(double first_radius, int64_t pass, int dimension, double alpha = progressive_alpha)
{
    const double shrinkage = progressive_shrinkage(pass, alpha);
    switch (dimension) {
        case 1: return first_radius * shrinkage;
        case 2: return first_radius * std::sqrt(shrinkage);
        default: return first_radius * std::cbrt(shrinkage);
    }
}

}  // namespace dapple
