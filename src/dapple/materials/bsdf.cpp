// One place for what all families share: the change to the shading frame, the choice of the family, and the adjoint
// factors (Veach 1997, sections 5.2 and 5.3). Whether light is reflected or transmitted is decided in the shading
// frame, as in pbrt-v4; where the shading normal puts a direction on the wrong side of the surface, energy is neither
// invented nor a pole left behind: a direction in the shading plane scatters nothing, one in the geometric plane has no
// importance.

#include "dapple/materials/bsdf.h"

#include "dapple/materials/layered.h"

namespace dapple {

namespace {

DiffuseLobe diffuse(const Bsdf& b) { return {b.a}; }
DiffuseTransmissionLobe diffuse_transmission(const Bsdf& b) { return {b.a, b.b}; }
DielectricLobe dielectric(const Bsdf& b) { return {b.eta, b.roughness}; }
ThinDielectricLobe thin_dielectric(const Bsdf& b) { return {b.eta}; }
ConductorLobe conductor(const Bsdf& b) { return {b.a, b.b, b.roughness}; }

template <class Base>
LayeredLobe<Base> layered(const Bsdf& b, const Base& base)
{
    return {.coat = {b.eta, b.roughness},
            .base = base,
            .albedo = b.layer_albedo,
            .thickness = std::max(b.layer_thickness, 1e-30f),
            .g = b.layer_g,
            .max_depth = b.layer_max_depth,
            .samples = std::max<int>(b.layer_samples, 1),
            .seed = b.layer_seed,
            .pbrt_weights = b.pbrt_coat_weights};
}
auto coated_diffuse(const Bsdf& b) { return layered(b, DiffuseLobe{b.a}); }
auto coated_conductor(const Bsdf& b) { return layered(b, ConductorLobe{b.a, b.b, b.base_roughness}); }

// What the families' f and weights are multiplied by. wo_z, wi_z: cosines to the shading normal; eta_path: index on the
// side of wi over that on the side of wo for refraction, else 1.
float adjoint_factor(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi, float wo_z, float wi_z, float eta_path,
                     TransportMode mode)
{
    if (mode == TransportMode::radiance) return 1.0f / sqr(eta_path);
    if (bsdf.frame.n == bsdf.n_geometric) return 1.0f;
    const float pole = std::fabs(dot(wo, bsdf.n_geometric) * wi_z);
    return pole > 0.0f ? std::fabs(wo_z * dot(wi, bsdf.n_geometric)) / pole : 0.0f;
}

float refraction_eta(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi)
{
    return bsdf.kind == BsdfKind::dielectric && !same_hemisphere(wo, wi) ? eta_across(wo.z, bsdf.eta) : 1.0f;
}

bool sample_lobe(const Bsdf& bsdf, const Vec3& wo, float u_lobe, const Vec2& u, BsdfSample& sample)
{
    switch (bsdf.kind) {
        case BsdfKind::none: return false;
        case BsdfKind::interface: return delta_sample(-wo, Spectrum(1.0f), true, 1.0f, sample);
        case BsdfKind::diffuse: return diffuse(bsdf).sample(wo, u_lobe, u, Lobes::all, sample);
        case BsdfKind::diffuse_transmission:
            return diffuse_transmission(bsdf).sample(wo, u_lobe, u, Lobes::all, sample);
        case BsdfKind::dielectric: return dielectric(bsdf).sample(wo, u_lobe, u, Lobes::all, sample);
        case BsdfKind::thin_dielectric: return thin_dielectric(bsdf).sample(wo, u_lobe, sample);
        case BsdfKind::conductor: return conductor(bsdf).sample(wo, u_lobe, u, Lobes::all, sample);
        case BsdfKind::coated_diffuse: return coated_diffuse(bsdf).sample(wo, u_lobe, u, sample);
        case BsdfKind::coated_conductor: return coated_conductor(bsdf).sample(wo, u_lobe, u, sample);
    }
    return false;
}

bool is_layered(BsdfKind kind) { return kind == BsdfKind::coated_diffuse || kind == BsdfKind::coated_conductor; }

}  // namespace

bool Bsdf::has_deltas_alone() const
{
    switch (kind) {
        case BsdfKind::none:
        case BsdfKind::interface:
        case BsdfKind::thin_dielectric: return true;
        case BsdfKind::diffuse:
        case BsdfKind::diffuse_transmission:
        case BsdfKind::coated_diffuse: return false;
        case BsdfKind::dielectric: return dielectric(*this).smooth();
        case BsdfKind::conductor: return roughness.smooth();
        case BsdfKind::coated_conductor: return coated_conductor(*this).smooth();
    }
    return true;
}

bool Bsdf::transmits() const
{
    switch (kind) {
        case BsdfKind::interface:
        case BsdfKind::dielectric:
        case BsdfKind::thin_dielectric: return true;
        case BsdfKind::diffuse_transmission: return !b.is_black();
        default: return false;
    }
}

Spectrum evaluate(const Bsdf& bsdf, const Vec3& wo_world, const Vec3& wi_world, TransportMode mode)
{
    const Vec3 wo = bsdf.frame.to_local(wo_world);
    const Vec3 wi = bsdf.frame.to_local(wi_world);
    if (in_plane(wo) || in_plane(wi)) return Spectrum();
    Spectrum f;
    switch (bsdf.kind) {
        case BsdfKind::none:
        case BsdfKind::interface:
        case BsdfKind::thin_dielectric: return Spectrum();
        case BsdfKind::diffuse: f = diffuse(bsdf).f(wo, wi); break;
        case BsdfKind::diffuse_transmission: f = diffuse_transmission(bsdf).f(wo, wi); break;
        case BsdfKind::dielectric: f = dielectric(bsdf).f(wo, wi); break;
        case BsdfKind::conductor: f = conductor(bsdf).f(wo, wi); break;
        case BsdfKind::coated_diffuse: f = coated_diffuse(bsdf).f(wo, wi); break;
        case BsdfKind::coated_conductor: f = coated_conductor(bsdf).f(wo, wi); break;
    }
    return f * adjoint_factor(bsdf, wo_world, wi_world, wo.z, wi.z, refraction_eta(bsdf, wo, wi), mode);
}

float pdf(const Bsdf& bsdf, const Vec3& wo_world, const Vec3& wi_world, TransportMode)
{
    if (bsdf.kind == BsdfKind::diffuse) {
        // The commonest family needs the two heights alone.
        const Vec3 wo(0.0f, 0.0f, dot(wo_world, bsdf.frame.n));
        const Vec3 wi(0.0f, 0.0f, dot(wi_world, bsdf.frame.n));
        return in_plane(wo) || in_plane(wi) ? 0.0f : diffuse(bsdf).pdf(wo, wi, Lobes::all);
    }
    const Vec3 wo = bsdf.frame.to_local(wo_world);
    const Vec3 wi = bsdf.frame.to_local(wi_world);
    if (in_plane(wo) || in_plane(wi)) return 0.0f;
    switch (bsdf.kind) {
        case BsdfKind::none:
        case BsdfKind::interface:
        case BsdfKind::thin_dielectric: return 0.0f;
        case BsdfKind::diffuse: return diffuse(bsdf).pdf(wo, wi, Lobes::all);
        case BsdfKind::diffuse_transmission: return diffuse_transmission(bsdf).pdf(wo, wi, Lobes::all);
        case BsdfKind::dielectric: return dielectric(bsdf).pdf(wo, wi, Lobes::all);
        case BsdfKind::conductor: return conductor(bsdf).pdf(wo, wi, Lobes::all);
        case BsdfKind::coated_diffuse: return coated_diffuse(bsdf).pdf(wo, wi);
        case BsdfKind::coated_conductor: return coated_conductor(bsdf).pdf(wo, wi);
    }
    return 0.0f;
}

BsdfValue evaluate_with_pdf(const Bsdf& bsdf, const Vec3& wo_world, const Vec3& wi_world, TransportMode mode)
{
    if (bsdf.kind != BsdfKind::diffuse) {
        const Spectrum f = evaluate(bsdf, wo_world, wi_world, mode);
        if (f.is_black()) return {};
        return {f, pdf(bsdf, wo_world, wi_world, mode)};
    }
    const Vec3 wo(0.0f, 0.0f, dot(wo_world, bsdf.frame.n));
    const Vec3 wi(0.0f, 0.0f, dot(wi_world, bsdf.frame.n));
    if (in_plane(wo) || in_plane(wi) || !same_hemisphere(wo, wi)) return {};
    const Spectrum f = diffuse(bsdf).f(wo, wi) * adjoint_factor(bsdf, wo_world, wi_world, wo.z, wi.z, 1.0f, mode);
    if (f.is_black()) return {};
    return {f, diffuse(bsdf).pdf(wo, wi, Lobes::all)};
}

BsdfBothWays evaluate_both_ways(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi, TransportMode mode)
{
    const BsdfValue value = evaluate_with_pdf(bsdf, wo, wi, mode);
    if (value.f.is_black()) return {};
    if (bsdf.kind == BsdfKind::diffuse) return {value.f, value.pdf, pdf_cosine_hemisphere(abs_dot(wo, bsdf.frame.n))};
    return {value.f, value.pdf, pdf(bsdf, wi, wo, mode)};
}

namespace {

// The commonest family: as below, without what it has no use for.
bool sample_diffuse(const Bsdf& bsdf, const Vec3& wo_world, const Vec2& u, TransportMode mode, BsdfSample& sample)
{
    const Vec3 wo(0.0f, 0.0f, dot(wo_world, bsdf.frame.n));
    Vec3 wi = sample_cosine_hemisphere(u);
    if (in_plane(wo) || in_plane(wi)) return false;
    sample.pdf = pdf_cosine_hemisphere(wi.z);
    if (wo.z < 0.0f) wi.z = -wi.z;
    sample.wi = normalize(bsdf.frame.to_world(wi));
    sample.weight = bsdf.a * adjoint_factor(bsdf, wo_world, sample.wi, wo.z, wi.z, 1.0f, mode);
    sample.delta = sample.transmission = false;
    sample.eta = 1.0f;
    return !sample.weight.is_black() && sample.pdf > 0.0f;
}

}  // namespace

bool sample_bsdf(const Bsdf& bsdf, const Vec3& wo_world, float u_lobe, const Vec2& u, TransportMode mode,
                 BsdfSample& sample)
{
    if (bsdf.kind == BsdfKind::diffuse) return sample_diffuse(bsdf, wo_world, u, mode, sample);
    const Vec3 wo = bsdf.frame.to_local(wo_world);
    if (in_plane(wo) || !sample_lobe(bsdf, wo, u_lobe, u, sample)) return false;
    const float wi_z = sample.wi.z;
    sample.wi = normalize(bsdf.frame.to_world(sample.wi));
    sample.weight *= adjoint_factor(bsdf, wo_world, sample.wi, wo.z, wi_z, sample.eta, mode);
    // The caller's wi, not the walk's: the estimate is a function of the direction's bits.
    if (is_layered(bsdf.kind) && !sample.delta) sample.pdf = pdf(bsdf, wo_world, sample.wi, mode);
    return !sample.weight.is_black() && (sample.delta || sample.pdf > 0.0f);
}

Spectrum guide_albedo(const Bsdf& bsdf, const Vec3&)
{
    const auto limited = [](Spectrum s) {
        for (float& lane : s.v) lane = clamp01(lane);
        return s;
    };
    switch (bsdf.kind) {
        case BsdfKind::none: return Spectrum();
        case BsdfKind::interface:
        case BsdfKind::dielectric:
        case BsdfKind::thin_dielectric: return Spectrum(1.0f);
        case BsdfKind::diffuse: return limited(bsdf.a);
        case BsdfKind::diffuse_transmission: return limited(bsdf.a + bsdf.b);
        case BsdfKind::conductor: return fresnel_conductor(1.0f, bsdf.a, bsdf.b);
        case BsdfKind::coated_diffuse:
        case BsdfKind::coated_conductor: {
            const float coat = fresnel_dielectric(1.0f, bsdf.eta);
            const Spectrum base =
                bsdf.kind == BsdfKind::coated_diffuse ? bsdf.a : fresnel_conductor(1.0f, bsdf.a, bsdf.b);
            return limited(Spectrum(coat) + base * (1.0f - coat));
        }
    }
    return Spectrum();
}

}  // namespace dapple
