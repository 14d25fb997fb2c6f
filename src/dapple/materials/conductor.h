// A metal: mirror reflection at Trowbridge-Reitz facets (a delta when smooth), tinted by the Fresnel equations of a
// complex index; the same on both sides. f = F D G / (4 cos cos) (Cook and Torrance 1982, Walter et al. 2007, eq. 20).
#pragma once

#include "dapple/materials/fresnel.h"
#include "dapple/materials/lobes.h"
#include "dapple/materials/microfacet.h"

namespace dapple {

struct ConductorLobe {
    Spectrum eta;
    Spectrum k;
    Roughness roughness;

    bool smooth() const { return roughness.smooth(); }

    Spectrum f(const Vec3& wo, const Vec3& wi) const
    {
        Vec3 m;
        if (smooth() || !half_vector(wo, wi, m)) return Spectrum();
        const TrowbridgeReitz facets(roughness);
        return fresnel_conductor(abs_dot(wo, m), eta, k) *
               (facets.density(m) * facets.masking_shadowing(wo, wi) / std::fabs(4.0f * wo.z * wi.z));
    }

    float pdf(const Vec3& wo, const Vec3& wi, Lobes part) const
    {
        Vec3 m;
        if (part == Lobes::transmission || smooth() || !half_vector(wo, wi, m)) return 0.0f;
        return TrowbridgeReitz(roughness).visible_density(wo, m) / (4.0f * abs_dot(wo, m));
    }

    bool sample(const Vec3& wo, float, const Vec2& u, Lobes part, BsdfSample& sample) const
    {
        if (part == Lobes::transmission) return false;
        if (smooth()) return delta_sample(mirror(wo), fresnel_conductor(std::fabs(wo.z), eta, k), false, 1.0f, sample);
        const TrowbridgeReitz facets(roughness);
        const Vec3 m = facets.sample_visible(wo, u);
        const Vec3 wi = reflect(wo, m);
        if (in_plane(wi) || !same_hemisphere(wo, wi)) return false;
        const float cos_m = abs_dot(wo, m);
        // D, the Jacobian and the cosines cancel in f cos / pdf: what is left is F G2 / G1.
        sample = {.wi = wi,
                  .weight = fresnel_conductor(cos_m, eta, k) * (facets.masking_shadowing(wo, wi) / facets.masking(wo)),
                  .pdf = facets.visible_density(wo, m) / (4.0f * cos_m)};
        return sample.pdf > 0.0f;
    }

private:
    // The facet normal (z > 0) that mirrors wo into wi; false if they lie on different sides.
    static bool half_vector(const Vec3& wo, const Vec3& wi, Vec3& m)
    {
        if (!same_hemisphere(wo, wi)) return false;
        m = normalize(wo + wi);
        if (m.z < 0.0f) m = -m;
        return true;
    }
};

}  // namespace dapple
