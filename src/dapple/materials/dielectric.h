// A boundary between two clear media. Smooth: delta reflection and refraction, chosen by the Fresnel reflectance.
// Rough: reflection and refraction at Trowbridge-Reitz facets (Walter et al. 2007, eqs. 16, 17, 20, 21; the half vector
// and densities are written for eta_path, the index on the side of wi over that on the side of wo). Equal indices bend
// nothing, whatever the roughness: then light passes straight on. A thin sheet of the same stuff folds all internal
// reflections into one delta pair.
#pragma once

#include "dapple/materials/fresnel.h"
#include "dapple/materials/lobes.h"
#include "dapple/materials/microfacet.h"

namespace dapple {

struct DielectricLobe {
    float eta;  // inside (z < 0) over outside
    Roughness roughness;

    bool smooth() const { return eta == 1.0f || roughness.smooth(); }

    Spectrum f(const Vec3& wo, const Vec3& wi) const
    {
        Facet facet;
        if (smooth() || !find_facet(wo, wi, facet)) return Spectrum();
        const TrowbridgeReitz facets(roughness);
        const float r = fresnel_dielectric(facet.cos_o, eta);
        const float common = facets.density(facet.m) * facets.masking_shadowing(wo, wi) / std::fabs(wo.z * wi.z);
        return Spectrum(facet.reflected ? r * common * 0.25f
                                        : (1.0f - r) * common * std::fabs(facet.cos_o) * facet.jacobian());
    }

    float pdf(const Vec3& wo, const Vec3& wi, Lobes part) const
    {
        Facet facet;
        if (smooth() || !find_facet(wo, wi, facet)) return 0.0f;
        if (part != Lobes::all && facet.reflected != (part == Lobes::reflection)) return 0.0f;
        const float r = fresnel_dielectric(facet.cos_o, eta);
        const float share = facet.reflected ? r : 1.0f - r;
        if (share == 0.0f) return 0.0f;
        return TrowbridgeReitz(roughness).visible_density(wo, facet.m) * facet.jacobian() *
               (part == Lobes::all ? share : 1.0f);
    }

    bool sample(const Vec3& wo, float u_lobe, const Vec2& u, Lobes part, BsdfSample& sample) const
    {
        if (eta == 1.0f) return part != Lobes::reflection && delta_sample(-wo, Spectrum(1.0f), true, 1.0f, sample);
        const bool delta = roughness.smooth();
        const TrowbridgeReitz facets(roughness);
        const Vec3 m = delta ? Vec3(0, 0, 1) : facets.sample_visible(wo, u);
        const float r = fresnel_dielectric(dot(wo, m), eta);
        bool reflected = u_lobe < r;
        float share = 1.0f;   // probability of the side taken
        float weight = 1.0f;  // Fresnel factor over share
        if (part == Lobes::all) {
            share = reflected ? r : 1.0f - r;
        } else {
            reflected = part == Lobes::reflection;
            weight = reflected ? r : 1.0f - r;
            if (weight == 0.0f) return false;
        }
        Vec3 wi;
        float eta_path = 1.0f;
        if (reflected)
            wi = delta ? mirror(wo) : reflect(wo, m);
        else if (!refract(wo, m, eta, wi, eta_path))
            return false;
        if (in_plane(wi) || same_hemisphere(wo, wi) != reflected) return false;
        if (delta) return delta_sample(wi, Spectrum(weight), !reflected, eta_path, sample);

        const Facet facet{m, dot(wo, m), dot(wi, m), eta_path, reflected};
        // As for conductors, f cos / pdf leaves G2 / G1.
        sample = {.wi = wi,
                  .weight = Spectrum(weight * facets.masking_shadowing(wo, wi) / facets.masking(wo)),
                  .pdf = facets.visible_density(wo, m) * facet.jacobian() * share,
                  .transmission = !reflected,
                  .eta = eta_path};
        return sample.pdf > 0.0f && std::isfinite(sample.pdf);
    }

private:
    struct Facet {
        Vec3 m;
        float cos_o, cos_i;  // to m
        float eta_path;
        bool reflected;

        // Solid angle of normals per solid angle of wi.
        float jacobian() const
        {
            if (reflected) return 1.0f / (4.0f * std::fabs(cos_o));
            return std::fabs(cos_i) / sqr(cos_i + cos_o / eta_path);
        }
    };

    // The facet that takes wo to wi, normal with z > 0; false if its back would be seen or if there is none.
    bool find_facet(const Vec3& wo, const Vec3& wi, Facet& facet) const
    {
        const bool reflected = same_hemisphere(wo, wi);
        const float eta_path = reflected ? 1.0f : eta_across(wo.z, eta);
        const Vec3 sum = wi * eta_path + wo;
        const float len2 = length_squared(sum);
        if (!(len2 > 0.0f)) return false;
        const float inv_length = 1.0f / std::sqrt(len2);
        const Vec3 m = sum * (sum.z < 0.0f ? -inv_length : inv_length);
        facet = {m, dot(wo, m), dot(wi, m), eta_path, reflected};
        return facet.cos_o * wo.z > 0.0f && facet.cos_i * wi.z > 0.0f;
    }
};

// A sheet without thickness: reflectance r of one face becomes R = r + t^2 r / (1 - r^2), transmittance 1 - R.
struct ThinDielectricLobe {
    float eta;

    bool smooth() const { return true; }
    bool sample(const Vec3& wo, float u_lobe, BsdfSample& sample) const
    {
        const float r = fresnel_dielectric(std::fabs(wo.z), eta);
        const float sheet = r < 1.0f ? r + sqr(1.0f - r) * r / (1.0f - sqr(r)) : 1.0f;
        if (u_lobe < sheet) return delta_sample(mirror(wo), Spectrum(1.0f), false, 1.0f, sample);
        return delta_sample(-wo, Spectrum(1.0f), true, 1.0f, sample);
    }
};

}  // namespace dapple
