// The scattering families share one shape, so that a wrapper (bsdf.cpp) and the layers (layered.h) can use any of them:
//   f(wo, wi)            [1/sr], no cosine
//   pdf(wo, wi, part)    density of sample(wo, part) per solid angle, 0 for delta lobes
//   sample(wo, u_lobe, u, part, sample)   false when the light is absorbed
//   smooth()             all lobes are deltas
// Directions are in the local frame (normal +z) and never in_plane. Families know nothing of transport modes: f and
// weights are those of importance, without the 1/eta^2 of refracted radiance, which bsdf.cpp applies. Layers ask for a
// part of the lobes; pdf and weight then refer to that part alone.
#pragma once

#include "dapple/materials/bsdf.h"
#include "dapple/sampling/warps.h"

namespace dapple {

enum class Lobes : uint8_t { all, reflection, transmission };

// Whether w is in the tangent plane as far as a unit vector of floats can tell. Nothing is scattered from or to there:
// cosines are divisors.
inline bool in_plane(const Vec3& w) { return std::fabs(w.z) < 1e-7f; }

// Completes a sample of a delta lobe.
inline bool delta_sample(const Vec3& wi, const Spectrum& weight, bool transmission, float eta, BsdfSample& sample)
{
    if (in_plane(wi)) return false;
    sample = {.wi = wi, .weight = weight, .pdf = 0.0f, .delta = true, .transmission = transmission, .eta = eta};
    return true;
}

inline Vec3 mirror(const Vec3& w) { return {-w.x, -w.y, w.z}; }

}  // namespace dapple
