// A dielectric coat over an opaque base with a scattering medium between them; both sides of the surface look alike.
// Guo, Hasan, Zhao 2018, "Position-free Monte Carlo simulation for arbitrary layered BSDFs", in the simplified form of
// Pharr, Jakob, Humphreys 2023, "Physically Based Rendering", section 14.3: a random walk in depth between two
// interfaces, the medium of unit extinction (thickness is optical depth) and Henyey-Greenstein phase function. Without
// albedo the medium absorbs: each crossing costs exp(-thickness / cos), as in pbrt.
//
// What is exact and what is estimated:
//   f        the coat's own reflection is exact, the light that enters is an unbiased estimate by `samples` walks, each
//            at most `max_depth` events long (longer paths are lost: a bias of the model). Numbers come from a hash of
//            (seed, wo, wi), so that f is a fixed function.
//            Deviation from pbrt: where a rough coat is left by either of two strategies, each one's weight uses the
//            other's density of the same direction (given wi); pbrt takes the density of wi instead, so that its f does
//            not agree with its sampler (compare pbrt-v4 issue 187) and is 6 to 8 percent bright at alpha = 0.39.
//            With pbrt_weights f is pbrt's; nothing else changes (docs/materials.md has numbers).
//   sample   follows one walk; the weight is that of the walk, right on average over the walks that lead to wi. It is
//            not f |cos| / pdf.
//   pdf      an estimate of the density of wi for MIS weights. It need not be right, only fixed and positive wherever f
//            is: 0.1 uniform over the hemisphere and 0.9 of [coat's reflection] + (1 - F) [entry, base, exit].
//            Deviation from pbrt: the parts carry their probabilities, and a diffuse base counts as diffuse after any
//            number of bounces, which needs no random numbers.
// The lobes' convention (importance, no 1/eta^2 on refraction) makes the walk from wo of either mode: the two
// crossings' factors would cancel. Cost: about ten lobe samples for each f.
#pragma once

#include "dapple/materials/conductor.h"
#include "dapple/materials/dielectric.h"
#include "dapple/materials/diffuse.h"
#include "dapple/math/hash.h"
#include "dapple/sampling/henyey_greenstein.h"

#include <type_traits>

namespace dapple {

namespace detail {

// A counter hashed into numbers (splitmix64).
class HashStream {
public:
    HashStream(uint64_t seed, const Vec3& a, const Vec3& b)
        : state_(hash_words(seed, float_bits(a.x) << 32 | float_bits(a.y), float_bits(a.z) << 32 | float_bits(b.x),
                            float_bits(b.y) << 32 | float_bits(b.z)))
    {
    }
    float next() { return to_unit_float(mix64(state_++)); }
    Vec2 next_2d()
    {
        const float x = next();
        return {x, next()};
    }

private:
    uint64_t state_;
};

inline float power_heuristic(float pdf, float other)
{
    if (!std::isfinite(pdf)) return 1.0f;
    const float sum = sqr(pdf) + sqr(other);
    return sum > 0.0f ? sqr(pdf) / sum : 0.0f;
}

}  // namespace detail

template <class Base>
struct LayeredLobe {
    DielectricLobe coat;
    Base base;
    Spectrum albedo;
    float thickness;  // > 0
    float g;          // in [-1, 1]
    int max_depth;
    int samples;
    uint64_t seed;
    bool pbrt_weights;  // see above

    bool smooth() const { return coat.smooth() && base.smooth() && albedo.is_black(); }

    Spectrum f(Vec3 wo, Vec3 wi) const
    {
        if (!same_hemisphere(wo, wi) || smooth()) return Spectrum();
        if (wo.z < 0.0f) wo = -wo, wi = -wi;
        detail::HashStream random(seed, wo, wi);
        Spectrum sum;
        for (int i = 0; i < samples; ++i) sum += estimate_f(wo, wi, random);
        return coat.f(wo, wi) + sum / static_cast<float>(samples);
    }

    float pdf(Vec3 wo, Vec3 wi) const
    {
        if (!same_hemisphere(wo, wi) || smooth()) return 0.0f;
        if (wo.z < 0.0f) wo = -wo, wi = -wi;
        const float entered = 1.0f - fresnel_dielectric(wo.z, coat.eta);
        const float estimate = coat.pdf(wo, wi, Lobes::all) + entered * estimate_pdf_through_base(wo, wi);
        return 0.1f * pdf_uniform_hemisphere() + 0.9f * estimate;
    }

    // Leaves sample.pdf at 0: it is pdf(wo, wi) unless the sample is a delta.
    bool sample(Vec3 wo, float u_lobe, const Vec2& u, BsdfSample& sample) const
    {
        const bool flipped = wo.z < 0.0f;
        if (flipped) wo = -wo;
        if (!coat.sample(wo, u_lobe, u, Lobes::all, sample)) return false;
        if (sample.transmission && !walk_out(wo, u_lobe, u, sample)) return false;
        if (flipped) sample.wi = -sample.wi;
        sample.pdf = 0.0f;
        sample.eta = 1.0f;
        sample.transmission = false;
        return true;
    }

private:
    // Where a walk is: moving along w from height z, 0 (base) to thickness (coat).
    struct Walk {
        Vec3 w;
        float z;
        Spectrum throughput;
        int depth = 0;
    };

    float transmittance(float distance, const Vec3& w) const { return std::exp(-std::fabs(distance / w.z)); }

    // Russian roulette on the throughput, after a few events.
    static bool survives(Walk& walk, detail::HashStream& random)
    {
        const float brightest = walk.throughput.max();
        if (walk.depth <= 3 || brightest >= 0.25f) return true;
        if (random.next() >= brightest) return false;
        walk.throughput /= brightest;
        return true;
    }

    // Moves the walk to the interface ahead, or to a scattering event before it (returned as true).
    bool advance(Walk& walk, detail::HashStream& random) const
    {
        const float target = walk.w.z > 0.0f ? thickness : 0.0f;
        if (albedo.is_black()) {
            walk.throughput *= transmittance(thickness, walk.w);
        } else {
            const float z = walk.z - std::log1p(-random.next()) * walk.w.z;
            if (z > 0.0f && z < thickness) {
                walk.z = z;
                return true;
            }
        }
        walk.z = target;
        return false;
    }

    // Multiplies a sample of an interface into the walk.
    template <class Lobe>
    static bool scatter(const Lobe& lobe, Lobes part, Walk& walk, detail::HashStream& random, BsdfSample& sample)
    {
        const float u_lobe = random.next();
        if (!lobe.sample(-walk.w, u_lobe, random.next_2d(), part, sample)) return false;
        walk.throughput *= sample.weight;
        walk.w = sample.wi;
        return !walk.throughput.is_black();
    }

    // One walk from wo, joined at each event with wi (both above): along a direction refracted from wi beforehand, and
    // by the value of a rough coat, weighted against each other.
    Spectrum estimate_f(const Vec3& wo, const Vec3& wi, detail::HashStream& random) const
    {
        Walk walk{.w = -wo, .z = thickness, .throughput = Spectrum(1.0f)};
        BsdfSample sample, exit;
        const float u_entry = random.next();
        if (!coat.sample(wo, u_entry, random.next_2d(), Lobes::transmission, sample)) return Spectrum();
        const float u_exit = random.next();
        if (!coat.sample(wi, u_exit, random.next_2d(), Lobes::transmission, exit)) return Spectrum();
        walk.w = sample.wi;
        walk.throughput = sample.weight;
        const Vec3 up = -exit.wi;  // leads to wi
        // f / pdf of that refraction, of the light that goes up: the adjoint, hence 1/eta^2.
        const Spectrum exit_value = exit.weight / (up.z * sqr(exit.eta));
        const bool rough_coat = !coat.smooth();

        Spectrum sum;
        for (; walk.depth < max_depth && survives(walk, random); ++walk.depth) {
            if (advance(walk, random)) {
                const float phase = henyey_greenstein(g, -walk.w, up);
                const float weight = rough_coat ? detail::power_heuristic(exit.pdf, phase) : 1.0f;
                sum += walk.throughput * albedo * exit_value * (phase * weight * transmittance(thickness - walk.z, up));
                Vec3 scattered;
                const float density = sample_henyey_greenstein(g, -walk.w, random.next_2d(), scattered);
                if (in_plane(scattered)) break;
                walk.w = scattered;
                walk.throughput *= albedo;
                if (walk.w.z > 0.0f && rough_coat) sum += through_coat(walk, wi, density);
            } else if (walk.z > 0.0f) {
                if (!scatter(coat, Lobes::reflection, walk, random, sample)) break;
            } else {
                if (!base.smooth()) {
                    const float weight =
                        rough_coat ? detail::power_heuristic(exit.pdf, base.pdf(-walk.w, up, Lobes::all)) : 1.0f;
                    sum += walk.throughput * base.f(-walk.w, up) * exit_value *
                           (up.z * weight * transmittance(thickness, up));
                }
                if (!scatter(base, Lobes::reflection, walk, random, sample)) break;
                if (rough_coat) sum += through_coat(walk, wi, base.smooth() ? infinity : sample.pdf);
            }
        }
        return sum;
    }

    // The light of a walk on its way up that a rough coat refracts to wi; pdf: density of the walk's direction.
    Spectrum through_coat(const Walk& walk, const Vec3& wi, float pdf) const
    {
        const Spectrum value = coat.f(-walk.w, wi);
        if (value.is_black()) return value;
        const float rival =
            pbrt_weights ? coat.pdf(-walk.w, wi, Lobes::transmission) : coat.pdf(wi, -walk.w, Lobes::transmission);
        const float weight = detail::power_heuristic(pdf, rival);
        return walk.throughput * value * (weight * transmittance(thickness - walk.z, walk.w));
    }

    // Density of light that enters, meets the base once and leaves.
    float estimate_pdf_through_base(const Vec3& wo, const Vec3& wi) const
    {
        if constexpr (std::is_same_v<Base, DiffuseLobe>) {
            return pdf_cosine_hemisphere(wi.z);
        } else {
            detail::HashStream random(seed + 1, wi, wo);
            BsdfSample entry, exit, bounce;
            const float u_entry = random.next();
            if (!coat.sample(wo, u_entry, random.next_2d(), Lobes::transmission, entry)) return 0.0f;
            // Through the base to a direction refracted from wi; the ratio is that of the solid angles of refraction.
            float at_base = 0.0f;
            const float u_exit = random.next();
            const bool exits = coat.sample(wi, u_exit, random.next_2d(), Lobes::transmission, exit);
            const float base_density = exits ? base.pdf(-entry.wi, -exit.wi, Lobes::all) : 0.0f;
            if (exits) at_base = base_density * wi.z / (std::fabs(exit.wi.z) * sqr(exit.eta));
            if (coat.smooth()) return at_base;
            // A direction sampled from the base, refracted to wi.
            if (!base.sample(-entry.wi, 0.0f, random.next_2d(), Lobes::all, bounce)) return at_base;
            const float at_coat = coat.pdf(-bounce.wi, wi, Lobes::transmission);
            if (base.smooth()) return at_coat;
            return at_base * (exits ? detail::power_heuristic(exit.pdf, base_density) : 0.0f) +
                   at_coat * detail::power_heuristic(bounce.pdf, at_coat);
        }
    }

    // Follows a walk that has entered (sample) until it leaves through the coat; the sample becomes that of the walk.
    bool walk_out(const Vec3& wo, float u_lobe, const Vec2& u, BsdfSample& sample) const
    {
        detail::HashStream random(seed + 2, wo, Vec3(u_lobe, u.x, u.y));
        Walk walk{.w = sample.wi, .z = thickness, .throughput = sample.weight};
        bool delta = sample.delta;
        for (; walk.depth < max_depth && survives(walk, random); ++walk.depth) {
            if (advance(walk, random)) {
                Vec3 scattered;
                sample_henyey_greenstein(g, -walk.w, random.next_2d(), scattered);
                if (in_plane(scattered)) return false;
                walk.w = scattered;
                walk.throughput *= albedo;
                delta = false;
            } else if (walk.z > 0.0f) {
                if (!scatter(coat, Lobes::all, walk, random, sample)) return false;
                delta &= sample.delta;
                if (sample.transmission) {
                    sample.weight = walk.throughput;
                    sample.delta = delta;
                    return true;
                }
            } else {
                if (!scatter(base, Lobes::all, walk, random, sample)) return false;
                delta &= sample.delta;
            }
        }
        return false;
    }
};

}  // namespace dapple
