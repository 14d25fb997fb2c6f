// The scattering of light at one surface point: a small tagged value, made from a material (material.h), with free
// functions. All adjoint factors live here and nowhere else (Veach 1997, chapter 5):
//   radiance    refraction scales f by 1/eta^2 (solid angles contract);
//   importance  no such factor, but shading normals need |wi.ng wo.ns| / |wi.ns wo.ng|, wo being the way back to the
//               light, wi the sampled way on.
// Directions are unit vectors in world space that point away from the surface.
#pragma once

#include "dapple/math/frame.h"
#include "dapple/spectrum/spectrum.h"

#include <cstdint>

namespace dapple {

enum class TransportMode : uint8_t { radiance, importance };

enum class BsdfKind : uint8_t {
    none,       // absorbs everything
    interface,  // no scattering: light passes straight on (a medium boundary); the walk skips it
    diffuse,
    diffuse_transmission,
    dielectric,  // smooth (delta) or rough
    thin_dielectric,
    conductor,
    coated_diffuse,
    coated_conductor,
};

// Microfacet roughness along the two tangent axes (GGX, Trowbridge-Reitz); both under 1e-3 means a delta lobe.
struct Roughness {
    float x = 0.0f;
    float y = 0.0f;
    bool smooth() const { return x < 1e-3f && y < 1e-3f; }
};

struct Bsdf {
    BsdfKind kind = BsdfKind::none;
    bool dispersive = false;       // eta was taken at the path's kept lane: only that lane is valid
    uint8_t layer_max_depth = 10;  // layered kinds: scattering events of the random walk
    uint8_t layer_samples = 1;
    bool pbrt_coat_weights = false;  // layered kinds: f as bright as pbrt's (layered.h); sample_bsdf is the same
    uint32_t layer_seed = 0;         // layered kinds: parts the random walks of different points
    Frame frame;                     // shading frame, n on the outside
    Vec3 n_geometric{0, 0, 1};
    Spectrum a;             // reflectance; conductor: eta (of a coated one: over the coat's index)
    Spectrum b;             // transmittance; conductor: k (likewise)
    Spectrum layer_albedo;  // layered kinds: albedo of the medium between the layers
    float eta = 1.0f;       // dielectric: index inside over index outside
    float layer_thickness = 0.01f;
    float layer_g = 0.0f;
    Roughness roughness;       // of the only layer or of the coat
    Roughness base_roughness;  // of a coated conductor's base

    // Every lobe is a delta: nothing to evaluate, connect to, or store a photon at.
    bool is_delta() const { return kind != BsdfKind::diffuse && has_deltas_alone(); }
    bool is_matte() const { return kind == BsdfKind::diffuse || kind == BsdfKind::diffuse_transmission; }
    bool transmits() const;
    // Whether sample_bsdf looks at u_lobe.
    bool chooses_lobe() const { return kind > BsdfKind::diffuse && kind != BsdfKind::conductor; }

private:
    bool has_deltas_alone() const;
};

struct BsdfSample {
    Vec3 wi{0, 0, 1};
    Spectrum weight;   // f |wi.ns| / density: what the throughput is multiplied by (layered kinds: of one walk)
    float pdf = 0.0f;  // density per solid angle to use in MIS; 0 for a delta lobe
    bool delta = false;
    bool transmission = false;
    float eta = 1.0f;  // index on the side of wi over index on the side of wo (1 for reflection)
};

// f(wo, wi) [1/sr], without cosine, adjoint factors applied. Zero for delta lobes. For the layered kinds it is an
// unbiased estimate (see layered.h): a fixed function of the Bsdf and both directions that is right on average over
// directions and points.
Spectrum evaluate(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi, TransportMode mode);

// Density per solid angle with which sample_bsdf(wo) chooses wi. Zero for delta lobes. For the layered kinds it is an
// estimate (see layered.h), fit for MIS weights, and sample_bsdf reports the same function of (wo, wi).
float pdf(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi, TransportMode mode);

// Both at once, for less than two calls; the density is left 0 where f is black.
struct BsdfValue {
    Spectrum f;
    float pdf = 0.0f;
};
BsdfValue evaluate_with_pdf(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi, TransportMode mode);

// And the density of the way back: what bidirectional methods ask of each pair of directions. All 0 where f is black.
struct BsdfBothWays {
    Spectrum f;
    float pdf = 0.0f;          // of wi given wo
    float pdf_reverse = 0.0f;  // of wo given wi
};
BsdfBothWays evaluate_both_ways(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi, TransportMode mode);

// Samples wi given wo from u_lobe and u in [0,1). False when the light is absorbed.
bool sample_bsdf(const Bsdf& bsdf, const Vec3& wo, float u_lobe, const Vec2& u, TransportMode mode, BsdfSample& sample);

// What turns flux per area that arrives from wi, which counts geometric cosines, into what reflection counts: the
// shading cosine over the geometric one.
inline float shading_per_area(const Bsdf& bsdf, const Vec3& wi)
{
    return abs_dot(wi, bsdf.frame.n) / std::max(abs_dot(wi, bsdf.n_geometric), 1e-4f);
}

// The albedo for guides and denoisers: reflectance of diffuse kinds, normal-incidence colour of the others; in [0, 1].
Spectrum guide_albedo(const Bsdf& bsdf, const Vec3& wo);

}  // namespace dapple
