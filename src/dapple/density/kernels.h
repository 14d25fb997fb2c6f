// Kernels of density estimation in one, two and three dimensions (Silverman 1986, "Density estimation for statistics
// and data analysis", ch. 4). Each is a function of t = d / r (distance over bandwidth), 0 from t = 1 on, and
// integrates to 1 over the unit ball of its dimension; an estimate sums K(d / r) / r^dimension.
//   disc:    constant 1/pi, cone 3/pi (1-t), Epanechnikov 2/pi (1-t^2), Silverman (biweight) 3/pi (1-t^2)^2
//   ball:    constant 3/(4 pi), cone 3/pi (1-t), Epanechnikov 15/(8 pi) (1-t^2), Silverman 105/(32 pi) (1-t^2)^2
//   segment: constant 1/2, cone 1-t, Epanechnikov 3/4 (1-t^2), Silverman 15/16 (1-t^2)^2
// The Gaussian exp(-t^2 / (2 s^2)) has s = 0.4 and is cut at t = 1, where 4.4 % of its peak are left; the part within
// is normalised to 1 exactly. (Jensen's Gaussian filter has s = 0.716 and lowers it by its edge value instead.)
#pragma once

#include "dapple/math/vec.h"

#include <array>
#include <string_view>

namespace dapple {

enum class KernelKind : uint8_t { constant, cone, gaussian, epanechnikov, silverman };
inline constexpr int kernel_count = 5;
inline constexpr std::array<std::string_view, kernel_count> kernel_names = {"constant", "cone", "gaussian",
                                                                            "epanechnikov", "silverman"};

// The kernel of a name in kernel_names; Epanechnikov's for any other.
inline KernelKind kernel_named(std::string_view name)
{
    for (size_t i = 0; i < kernel_names.size(); ++i)
        if (kernel_names[i] == name) return static_cast<KernelKind>(i);
    return KernelKind::epanechnikov;
}

inline constexpr float gaussian_kernel_sigma = 0.4f;

namespace detail {

// K(t) = scale[kind] * shape(t) for t in [0, 1).
inline float kernel_shape(KernelKind kind, float t)
{
    switch (kind) {
        case KernelKind::constant: return 1.0f;
        case KernelKind::cone: return 1.0f - t;
        case KernelKind::gaussian: return std::exp(t * t * (-0.5f / sqr(gaussian_kernel_sigma)));
        case KernelKind::epanechnikov: return 1.0f - t * t;
        case KernelKind::silverman: return sqr(1.0f - t * t);
    }
    return 0.0f;
}

inline float kernel(KernelKind kind, float t, const std::array<float, kernel_count>& scales)
{
    return t < 1.0f ? scales[static_cast<size_t>(kind)] * kernel_shape(kind, t) : 0.0f;
}

// The Gaussian's, with s = 0.4 and e = exp(-1 / (2 s^2)), g = erf(1 / (s sqrt(2))):
// disc 1 / (2 pi s^2 (1 - e)), ball 1 / (4 pi (s^3 sqrt(pi/2) g - s^2 e)), segment 1 / (s sqrt(2 pi) g).
inline constexpr std::array<float, kernel_count> disc_scales = {inv_pi, 3.0f * inv_pi, 1.04043178f, 2.0f * inv_pi,
                                                                3.0f * inv_pi};
inline constexpr std::array<float, kernel_count> ball_scales = {0.75f * inv_pi, 3.0f * inv_pi, 1.10239458f,
                                                                1.875f * inv_pi, 3.28125f * inv_pi};
inline constexpr std::array<float, kernel_count> segment_scales = {0.5f, 1.0f, 1.00989796f, 0.75f, 0.9375f};

}  // namespace detail

// K(t) per unit area, t >= 0.
inline float kernel_disc(KernelKind kind, float t) { return detail::kernel(kind, t, detail::disc_scales); }
// K(t) per unit volume, t >= 0.
inline float kernel_ball(KernelKind kind, float t) { return detail::kernel(kind, t, detail::ball_scales); }
// K(t) per unit length, for both signs of the offset: t >= 0 is its magnitude.
inline float kernel_segment(KernelKind kind, float t) { return detail::kernel(kind, t, detail::segment_scales); }

}  // namespace dapple
