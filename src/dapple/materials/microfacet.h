// The Trowbridge-Reitz (GGX) distribution of microfacet normals, anisotropic, with Smith's height-correlated masking.
// Density and Lambda: Walter et al. 2007, "Microfacet models for refraction through rough surfaces", and Heitz 2014,
// "Understanding the masking-shadowing function in microfacet-based BRDFs". Sampling of visible normals: Dupuy and
// Benyoub 2023, "Sampling visible GGX normals with spherical caps". Directions are in the local frame, normal +z; a
// direction below the surface sees the same distribution mirrored (its normals are still reported with z > 0).
#pragma once

#include "dapple/materials/bsdf.h"

namespace dapple {

class TrowbridgeReitz {
public:
    // One axis may not be perfectly smooth beside a rough one: the density would be infinite on a line.
    explicit TrowbridgeReitz(const Roughness& r) : x_(std::max(r.x, 1e-4f)), y_(std::max(r.y, 1e-4f)) {}

    // D(m) [1/sr]: area of the facets with normal m per surface area and solid angle.
    float density(const Vec3& m) const
    {
        const float e = sqr(m.x / x_) + sqr(m.y / y_) + sqr(m.z);
        return m.z > 0.0f ? 1.0f / (pi * x_ * y_ * sqr(e)) : 0.0f;
    }

    // Smith's Lambda(w): the area hidden from w per area visible to w. Needs w.z != 0.
    float lambda(const Vec3& w) const
    {
        return 0.5f * (std::sqrt(1.0f + (sqr(w.x * x_) + sqr(w.y * y_)) / sqr(w.z)) - 1.0f);
    }

    float masking(const Vec3& w) const { return 1.0f / (1.0f + lambda(w)); }
    float masking_shadowing(const Vec3& wo, const Vec3& wi) const { return 1.0f / (1.0f + lambda(wo) + lambda(wi)); }

    // Density [1/sr] of the normals visible from w, with which sample_visible chooses m.
    float visible_density(const Vec3& w, const Vec3& m) const
    {
        return density(m) * abs_dot(w, m) * masking(w) / std::fabs(w.z);
    }

    // A normal seen from w: stretched to the unit hemisphere, the normals that mirror w into a given direction come
    // from a spherical cap of uniform directions.
    Vec3 sample_visible(const Vec3& w, const Vec2& u) const
    {
        const float side = w.z < 0.0f ? -1.0f : 1.0f;
        const Vec3 stretched = normalize(Vec3(x_ * w.x, y_ * w.y, w.z) * side);
        const float z = (1.0f - u.y) * (1.0f + stretched.z) - stretched.z;
        const Vec3 half = spherical_direction(safe_sqrt(1.0f - sqr(z)), z, 2.0f * pi * u.x) + stretched;
        return normalize(Vec3(x_ * half.x, y_ * half.y, std::max(1e-6f, half.z)));
    }

private:
    float x_, y_;
};

}  // namespace dapple
