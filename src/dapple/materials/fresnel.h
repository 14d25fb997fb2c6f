// Reflection and refraction at a smooth boundary: Snell's law and the unpolarised Fresnel equations (Born and Wolf
// 1999, "Principles of Optics", sections 1.5 and 14.2). No approximation. Cost: one square root (dielectric), two per
// lane (conductor).
#pragma once

#include "dapple/math/vec.h"
#include "dapple/spectrum/spectrum.h"

namespace dapple {

// The mirror direction of w about the normal n (both unit, n on either side).
inline Vec3 reflect(const Vec3& w, const Vec3& n) { return n * (2.0f * dot(w, n)) - w; }

// Index of the side that light crosses to over the index of the side with cosine cos_o, for eta = inside / outside.
inline float eta_across(float cos_o, float eta) { return cos_o >= 0.0f ? eta : 1.0f / eta; }

// Refracts w at the unit normal n; eta is the index below n over the index above it, w may lie on either side. Returns
// false on total internal reflection. eta_path: index on the side of `refracted` over the index on the side of w.
inline bool refract(const Vec3& w, const Vec3& n, float eta, Vec3& refracted, float& eta_path)
{
    const float cos_signed = dot(w, n);
    eta_path = eta_across(cos_signed, eta);
    const float cos_o = std::fabs(cos_signed);
    const float sin2_t = std::max(0.0f, 1.0f - sqr(cos_o)) / sqr(eta_path);
    if (sin2_t >= 1.0f) return false;
    const float along_normal = cos_o / eta_path - std::sqrt(1.0f - sin2_t);
    refracted = n * (cos_signed < 0.0f ? -along_normal : along_normal) - w * (1.0f / eta_path);
    return true;
}

// Unpolarised reflectance of a dielectric boundary seen at cosine cos_signed; negative: from inside. eta = index
// inside over outside. 1 on total internal reflection.
inline float fresnel_dielectric(float cos_signed, float eta)
{
    if (eta == 1.0f) return 0.0f;
    const float eta_path = eta_across(cos_signed, eta);
    const float cos_o = std::min(1.0f, std::fabs(cos_signed));
    const float sin2_t = (1.0f - sqr(cos_o)) / sqr(eta_path);
    if (sin2_t >= 1.0f) return 1.0f;
    const float cos_t = std::sqrt(1.0f - sin2_t);
    const float parallel = (eta_path * cos_o - cos_t) / (eta_path * cos_o + cos_t);
    const float perpendicular = (cos_o - eta_path * cos_t) / (cos_o + eta_path * cos_t);
    return 0.5f * (sqr(parallel) + sqr(perpendicular));
}

// Unpolarised reflectance of an absorbing medium of complex index eta + i k (relative to the side of the light), per
// lane, at the cosine cos_i >= 0. The complex cosine of refraction, times the index, is a + i b; only a and a^2 + b^2
// are needed.
inline Spectrum fresnel_conductor(float cos_i, const Spectrum& eta, const Spectrum& k)
{
    const float c = std::clamp(cos_i, 0.0f, 1.0f);
    const float cos2 = sqr(c);
    const float sin2 = 1.0f - cos2;
    Spectrum result;
    for (int lane = 0; lane < Spectrum::lanes; ++lane) {
        const float difference = sqr(eta[lane]) - sqr(k[lane]) - sin2;
        const float norm = std::sqrt(sqr(difference) + sqr(2.0f * eta[lane] * k[lane]));  // a^2 + b^2
        const float two_a_cos = 2.0f * c * std::sqrt(std::max(0.0f, 0.5f * (norm + difference)));
        const float perpendicular = (norm + cos2 - two_a_cos) / std::max(norm + cos2 + two_a_cos, 1e-30f);
        const float s = cos2 * norm + sqr(sin2);
        const float ratio = (s - two_a_cos * sin2) / std::max(s + two_a_cos * sin2, 1e-30f);
        result[lane] = std::clamp(0.5f * perpendicular * (1.0f + ratio), 0.0f, 1.0f);
    }
    return result;
}

}  // namespace dapple
