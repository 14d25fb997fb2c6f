// The Henyey-Greenstein phase function (Henyey and Greenstein 1941, "Diffuse radiation in the Galaxy"):
//     p(c) = (1 - g^2) / (4 pi (1 + g^2 - 2 g c)^(3/2)),   c the cosine of the scattering angle, mean cosine g.
// The usual inversion of its distribution function divides by g and cancels near |g| = 1; solved for 1 - c and 1 + c
// apart (below) it does neither, so that g = 0 is no special case and forward peaks keep their shape.

#include "dapple/math/frame.h"
#include "dapple/media/medium.h"

namespace dapple {

namespace {

// Beyond this the lobe is a delta function to single precision.
constexpr float largest_g = 0.99999f;

float limited(float g) { return std::clamp(g, -largest_g, largest_g); }

// The density for a given 1 - c (g >= 0) or 1 + c (g < 0).
float density(float g, float distance_from_peak)
{
    const float a = std::fabs(g);
    const float d = sqr(1.0f - a) + 2.0f * a * distance_from_peak;
    return 0.25f * inv_pi * (1.0f - a) * (1.0f + a) / (d * std::sqrt(d));
}

}  // namespace

float evaluate_phase(float g, const Vec3& wo, const Vec3& wi)
{
    // |wo + wi|^2 = 2 (1 - c) and |wo - wi|^2 = 2 (1 + c) for unit vectors, without cancellation.
    g = limited(g);
    return density(g, 0.5f * length_squared(g >= 0.0f ? wo + wi : wo - wi));
}

float sample_phase(float g, const Vec3& wo, const Vec2& u, Vec3& wi)
{
    g = limited(g);
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
    return density(g, g >= 0.0f ? one_minus_c : one_plus_c);
}

}  // namespace dapple
