// Radiance and irradiance on surfaces from a photon map (Jensen 2001, "Realistic image synthesis using photon mapping";
// kernels.h):
//   L(x, wo) = sum_p f(wi_p) flux_p K(d_p / r) / r^2 / emitted,
// where f is the caller's scattering function (no cosine: a photon's flux per area is irradiance already).
//
// With k nearest photons, r is the distance of the k-th and this photon itself is left out, whatever the kernel: given
// r, the other k - 1 are spread as all photons are, and the mean of (k - 1) / (pi r^2) is the density exactly. Counting
// the farthest too would brighten by K(1) pi / (k - 1) of the value, which is 2 % for k = 50 with the constant kernel
// and 0.3 % with the Gaussian, which does not vanish at its edge. Where max_radius holds fewer than k photons,
// r = max_radius and all count; both cases together have no bias on an evenly lit plane either.
//
// A least radius may be given, too: where the k-th photon is nearer, all within min_radius count. The three cases
// together keep the mean exact: with N photons within the area A of min_radius and A_k that of the k-th,
// E[N/A; A_k < A] + E[(k-1)/A_k; A_k >= A] is the density times P(N >= k-1) + P(N < k-1).
//
// Beside brightly lit patches the k-th photon of a dark place lies in the patch, and so do most of the others: the
// estimate at the distance d from the patch is k / (pi d^2), however dark the place is, which adds up to 2 k
// log(d_max / d_min) photons too many over a floor. So the disc is halved as long as too few photons lie in its inner
// half or quarter for a disc that is lit evenly (2.75 standard deviations). On an evenly lit plane this happens once
// in 400 estimates, and takes 0.07 % of the light (simulated; k = 50, Epanechnikov); fewer than 16 photons are never
// called uneven.
//
// A smaller r than the distance of the k-th photon is as exact: fewer photons lie within it. So estimates get narrower
// from epoch to epoch, while whether light is even is still judged by all k.
//
// What counts is decided by SurfaceRegion (photon_map.h): a flat disc, and photons whose normals agree with the
// query's. A wall, however thin, keeps the light of its other side, unless the caller asks for it (transmission). Not
// mended here, where nothing is known but photons: near the edge of a surface part of the disc is empty and the
// estimate falls, to 1/2 at a straight edge and 1/4 at a right-angled corner; and light on a floor seeps below a wall
// that stands on it, up to r far (integrators/surface_coverage.h mends both). On a sphere the constant kernel is exact
// (a cap of chord r has the area pi r^2) until the disc's height cuts it, at r = 0.2 sphere radii. Cost: one search of
// the tree, about 1.5 us for k = 50 of a million photons and sorted queries.
#pragma once

#include "dapple/density/kernels.h"
#include "dapple/photons/photon_map.h"

#include <utility>

namespace dapple {

// How wide an estimate looks.
struct Bandwidth {
    int nearest = 0;          // 0: all photons within max_radius; else at least 2, at most the k of the NearestPoints
    float max_radius = 0.0f;  // [m]; may be infinite if nearest > 0
    KernelKind kernel = KernelKind::epanechnikov;
    float min_radius = 0.0f;  // [m], if nearest > 0; at most max_radius
    float shrinkage = 1.0f;   // r over the distance of the k-th photon, at most 1; no part where there are fewer than k
};

// A photon of an estimate and its weight [1/m^2].
using WeightedPhoton = std::pair<uint32_t, float>;  // slot, weight

// What an estimate rests on.
struct EstimateSupport {
    int count = 0;         // photons that took part
    float radius = 0.0f;   // r [m]
    float density = 0.0f;  // photons per area [1/m^2]
};

struct RadianceEstimate {
    Spectrum value;  // radiance [W/(m^2 sr)] or irradiance [W/m^2]
    EstimateSupport support;
};

namespace detail {

template <class Visitor>
EstimateSupport visit_within(const PhotonMap& map, const SurfaceRegion& region, KernelKind kernel, float radius,
                             Visitor&& visit)
{
    const float inv_radius = 1.0f / radius;
    const float scale = inv_radius * inv_radius / static_cast<float>(map.emitted());
    int count = 0;
    map.for_each_on_surface(region, radius, [&](uint32_t slot, float distance_squared) {
        ++count;
        visit(slot, kernel_disc(kernel, std::sqrt(distance_squared) * inv_radius) * scale);
    });
    return {count, radius, static_cast<float>(count) * inv_pi * inv_radius * inv_radius};
}

// The squared radius of the largest disc that may be lit evenly as far as its photons tell (see the head): that of the
// k-th photon, which is left out, or less.
inline float even_radius_squared(const NearestPoints& nearest, int left_out)
{
    constexpr int least_photons = 16;
    constexpr float deviations = 2.75f;
    float limit = nearest.distance_squared(left_out);
    auto count = static_cast<float>(nearest.count() - 1);
    const auto too_few = [&](float found, float share) {
        return found < count * share - deviations * std::sqrt(count * share * (1.0f - share));
    };
    while (count >= least_photons) {
        float half = 0.0f, quarter = 0.0f;
        for (int i = 0; i < nearest.count(); ++i) {
            half += nearest.distance_squared(i) < 0.5f * limit ? 1.0f : 0.0f;
            quarter += nearest.distance_squared(i) < 0.25f * limit ? 1.0f : 0.0f;
        }
        if (!too_few(half, 0.5f) && !too_few(quarter, 0.25f)) break;
        limit *= 0.5f;
        count = half;
    }
    return limit;
}

}  // namespace detail

// Calls visit(slot, weight) for each photon that takes part, with weight = K(d / r) / r^2 / emitted [1/m^2]: the
// building block of all estimates below, and of those that split their value by light group or path class
// (map.light_group(slot), map.path_class(slot)). `nearest` is scratch space of the calling thread with k() equal to
// bandwidth.nearest; it is not touched if that is 0. An empty map gives nothing.
template <class Visitor>
EstimateSupport visit_photons(const PhotonMap& map, const SurfaceRegion& region, const Bandwidth& bandwidth,
                              NearestPoints& nearest, Visitor&& visit)
{
    if (map.empty() || map.emitted() == 0 || !(bandwidth.max_radius > 0.0f)) return {};
    if (bandwidth.nearest == 0) return detail::visit_within(map, region, bandwidth.kernel, bandwidth.max_radius, visit);
    DAPPLE_ASSERT(nearest.k() == bandwidth.nearest && bandwidth.nearest >= 2);
    map.find_nearest_on_surface(region, bandwidth.max_radius, nearest);
    float radius_squared = sqr(bandwidth.max_radius);
    int left_out = -1;
    EstimateSupport support;
    if (nearest.count() == nearest.k()) {
        left_out = nearest.farthest();
        const float least =
            std::min(std::max(least_radius(region.position), bandwidth.min_radius), bandwidth.max_radius);
        if (nearest.distance_squared(left_out) < sqr(least))
            return detail::visit_within(map, region, bandwidth.kernel, least, visit);
        radius_squared =
            std::max(detail::even_radius_squared(nearest, left_out) * sqr(bandwidth.shrinkage), sqr(least));
    } else if (!(bandwidth.max_radius < infinity)) {
        // The whole map has fewer photons than asked for, and no radius is given: take what there is.
        if (nearest.count() < 2) return {};
        left_out = nearest.farthest();
        radius_squared = std::max(nearest.distance_squared(left_out), sqr(least_radius(region.position)));
    }
    support.radius = std::sqrt(radius_squared);
    const float inv_radius = 1.0f / support.radius;
    const float scale = inv_radius * inv_radius / static_cast<float>(map.emitted());
    for (int i = 0; i < nearest.count(); ++i) {
        if (i == left_out) continue;
        const float distance_squared = nearest.distance_squared(i);
        if (distance_squared >= radius_squared && left_out >= 0) continue;
        ++support.count;
        visit(nearest.index(i), kernel_disc(bandwidth.kernel, std::sqrt(distance_squared) * inv_radius) * scale);
    }
    support.density = static_cast<float>(support.count) * inv_pi * inv_radius * inv_radius;
    return support;
}

// The same where each photon has a radius of its own, over which it spreads its flux (surface_places.h): no flux
// is made or lost on a plane, whatever the radii.
template <class Visitor>
void visit_reaching(const PhotonMap& map, const PointLimits& radii, const SurfaceRegion& region, KernelKind kernel,
                    Visitor&& visit)
{
    if (map.empty() || map.emitted() == 0) return;
    const float inv_emitted = 1.0f / static_cast<float>(map.emitted());
    map.for_each_reaching(region, radii, [&](uint32_t slot, float distance_squared) {
        const float inv_squared = 1.0f / radii.squared(slot);
        visit(slot, kernel_disc(kernel, std::sqrt(distance_squared * inv_squared)) * inv_squared * inv_emitted);
    });
}

// Reflected (or transmitted) radiance [W/(m^2 sr)]. scattering(wi) is called with the unit direction each photon came
// from and returns a Spectrum, usually the BSDF [1/sr] between wi and the viewer, without a cosine.
template <class Scattering>
RadianceEstimate estimate_radiance(const PhotonMap& map, const SurfaceRegion& region, const Bandwidth& bandwidth,
                                   NearestPoints& nearest, Scattering&& scattering)
{
    RadianceEstimate estimate;
    estimate.support = visit_photons(map, region, bandwidth, nearest, [&](uint32_t slot, float weight) {
        estimate.value += scattering(map.direction(slot)) * map.flux(slot) * weight;
    });
    return estimate;
}

// Irradiance [W/m^2] that arrives on the side(s) of the region.
inline RadianceEstimate estimate_irradiance(const PhotonMap& map, const SurfaceRegion& region,
                                            const Bandwidth& bandwidth, NearestPoints& nearest)
{
    RadianceEstimate estimate;
    estimate.support = visit_photons(map, region, bandwidth, nearest,
                                     [&](uint32_t slot, float weight) { estimate.value += map.flux(slot) * weight; });
    return estimate;
}

}  // namespace dapple
