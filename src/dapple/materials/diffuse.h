// Lambertian reflection and transmission: f = r / pi on the side of wo, t / pi on the other.
#pragma once

#include "dapple/materials/lobes.h"

namespace dapple {

struct DiffuseLobe {
    Spectrum reflectance;

    bool smooth() const { return false; }
    Spectrum f(const Vec3& wo, const Vec3& wi) const
    {
        return same_hemisphere(wo, wi) ? reflectance * inv_pi : Spectrum();
    }
    float pdf(const Vec3& wo, const Vec3& wi, Lobes part) const
    {
        return part != Lobes::transmission && same_hemisphere(wo, wi) ? pdf_cosine_hemisphere(abs_cos_theta(wi)) : 0.0f;
    }
    bool sample(const Vec3& wo, float, const Vec2& u, Lobes part, BsdfSample& sample) const
    {
        if (part == Lobes::transmission) return false;
        Vec3 wi = sample_cosine_hemisphere(u);
        if (in_plane(wi)) return false;
        const float density = pdf_cosine_hemisphere(wi.z);
        if (wo.z < 0.0f) wi.z = -wi.z;
        sample = {.wi = wi, .weight = reflectance, .pdf = density};
        return true;
    }
};

// The side is chosen in proportion to the largest lane of each.
struct DiffuseTransmissionLobe {
    Spectrum reflectance;
    Spectrum transmittance;

    bool smooth() const { return false; }
    float reflection_probability() const
    {
        const float r = reflectance.max();
        const float sum = r + transmittance.max();
        return sum > 0.0f ? r / sum : 1.0f;
    }
    Spectrum f(const Vec3& wo, const Vec3& wi) const
    {
        return (same_hemisphere(wo, wi) ? reflectance : transmittance) * inv_pi;
    }
    float pdf(const Vec3& wo, const Vec3& wi, Lobes part) const
    {
        const bool reflected = same_hemisphere(wo, wi);
        if (part != Lobes::all) {
            return reflected == (part == Lobes::reflection) ? pdf_cosine_hemisphere(abs_cos_theta(wi)) : 0.0f;
        }
        const float p = reflection_probability();
        return (reflected ? p : 1.0f - p) * pdf_cosine_hemisphere(abs_cos_theta(wi));
    }
    bool sample(const Vec3& wo, float u_lobe, const Vec2& u, Lobes part, BsdfSample& sample) const
    {
        float p = reflection_probability();
        if (part != Lobes::all) p = part == Lobes::reflection ? 1.0f : 0.0f;
        const bool reflected = u_lobe < p;
        const float share = reflected ? p : 1.0f - p;
        Vec3 wi = sample_cosine_hemisphere(u);
        if (in_plane(wi)) return false;
        const float density = share * pdf_cosine_hemisphere(wi.z);
        if ((wo.z < 0.0f) == reflected) wi.z = -wi.z;
        sample = {.wi = wi,
                  .weight = (reflected ? reflectance : transmittance) / share,
                  .pdf = density,
                  .transmission = !reflected};
        return true;
    }
};

}  // namespace dapple
