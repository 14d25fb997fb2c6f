// The Henyey-Greenstein phase function (Henyey and Greenstein 1941, "Diffuse radiation in the Galaxy"):
//     p(c) = (1 - g^2) / (4 pi (1 + g^2 - 2 g c)^(3/2)),   c the cosine of the scattering angle, mean cosine g.
// The usual inversion of its distribution function divides by g and cancels near |g| = 1; solved for 1 - c and 1 + c
// apart (below) it does neither, so that g = 0 is no special case and forward peaks keep their shape. Cost: a square
// root and a division; sampling adds a sine and a cosine.
#pragma once

#include "dapple/math/frame.h"

namespace dapple {

namespace detail {

// Beyond this the lobe is a delta function to single precision.
inline float limited_henyey_greenstein_g(float g)
{
    constexpr float largest_g = 0.99999f;
    return std::clamp(g, -largest_g, largest_g);
}

// The density for a given 1 - c (g >= 0) or 1 + c (g < 0).
inline float henyey_greenstein_density(float g, float distance_from_peak)
{
    const float a = std::fabs(g);
    const float d = sqr(1.0f - a) + 2.0f * a * distance_from_peak;
    return 0.25f * inv_pi * (1.0f - a) * (1.0f + a) / (d * std::sqrt(d));
}

}  // namespace detail

// The value [1/sr] of the phase function, which integrates to 1; wo points back along the way here, wi on along the way
// from here (unit vectors), so that cos = -dot(wo, wi) is the scattering angle's cosine and g > 0 is forward. g is
// limited to just inside (-1, 1).
inline float henyey_greenstein(float g, const Vec3& wo, const Vec3& wi)
{
    // |wo + wi|^2 = 2 (1 - c) and |wo - wi|^2 = 2 (1 + c) for unit vectors, without cancellation.
    g = detail::limited_henyey_greenstein_g(g);
    return detail::henyey_greenstein_density(g, 0.5f * length_squared(g >= 0.0f ? wo + wi : wo - wi));
}

// Samples wi in proportion to the phase function, from u in [0,1)^2; returns its density per solid angle (= value).
inline float sample_henyey_greenstein(float g, const Vec3& wo, const Vec2& u, Vec3& wi)
{
    g = detail::limited_henyey_greenstein_g(g);
    const float v = u.x;  // the probability of a scattering angle smaller than the one returned
    const float w = 1.0f - u.x;
    // For either sign of g the denominator is a sum of positive terms.
    const float denominator = g >= 0.0f ? 1.0f - g + 2.0f * g * w : 1.0f + g - 2.0f * g * v;
    const float inv2 = 1.0f / sqr(denominator);
    const float one_minus_c = 2.0f * v * sqr(1.0f - g) * (1.0f + g * w) * inv2;
    const float one_plus_c = 2.0f * w * sqr(1.0f + g) * (1.0f - g * v) * inv2;
    const float c = v < w ? 1.0f - one_minus_c : one_plus_c - 1.0f;
    const Vec3 local =
        spherical_direction(safe_sqrt(one_minus_c * one_plus_c), std::clamp(c, -1.0f, 1.0f), 2.0f * pi * u.y);
    wi = Frame(-wo).to_world(local);
    return detail::henyey_greenstein_density(g, g >= 0.0f ? one_minus_c : one_plus_c);
}

}  // namespace dapple
