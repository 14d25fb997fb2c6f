// How much of the disc of a density estimate lies on the surface that it speaks for. Near an edge or a corner part of
// the disc is empty, and behind a thin wall it belongs to another room: an estimate divided by the whole area falls to
// 1/2 at a straight edge and 1/4 at a corner, however many photons there are. Here the disc is what the query's point
// sees of its surface: points of a spiral are tried by two short rays, one down onto the surface (where the photons
// that count could lie: height and normal as in SurfaceRegion), one along it from the query's point. The estimate is
// divided by the share of the kernel's weight that passes. On curved things each point stands for the area above it,
// with the kernel's weight of a photon there: without, a ball lost 7 to 22 % of its light where its height cuts the
// disc. Where something on the disc is hidden, its photons are dropped, each by a ray of its own.
//
// Cost: 32 short rays where the disc is whole, 96 where it is not, or is bent. Bias: the share has a relative error of
// about 2 % at a straight edge, which the quotient turns into some 1e-3 of brightening there; mirrors that lie in the
// plane of a matte surface count as covered; smooth glass neither covers nor hides. A share is held at 1/16: what is
// narrower than a tenth of the disc (wires and blades where photons are few) comes out too dark. Objects that move are
// looked at where they are at one time.
//
// For estimates of which there are many (visible points of a pass, photons of a map), the same by chance, for four rays
// where the disc is whole. Points of the disc are drawn with the density of the kernel until one lies on the surface;
// their number N has the mean 1 / share, whatever the photons are, so that N times the estimate has the right mean (the
// reciprocal of a probability by repeated trials: Booth 2007, "Unbiased Monte Carlo estimation of the reciprocal of an
// integral"; in photon gathering Qin et al. 2015, "Unbiased photon gathering for light transport simulation"). Where
// the surface is curved, a point of the disc stands for more or less surface than on a plane: it ends the trials with
// that chance. Three rays along the disc tell whether something stands on it; only then photons and trials are asked
// whether they are seen. Noise: N has the variance (1 - share) / share^2. Bias: something that all three rays miss
// (beyond 0.5 of the radius at the nearest, seldom before 0.7) hides nothing in that pass: light of the other side
// comes through with what weight the kernel has out there; and surface beyond a plane's area on curved things is not
// counted (under 2 % for radii up to 0.4 of a ball's). Both vanish with the radius, faster than the blur. Weights are
// never negative.
#pragma once

#include "dapple/density/estimate.h"
#include "dapple/materials/bsdf.h"
#include "dapple/sampling/random_stream.h"
#include "dapple/world/world.h"

#include <vector>

namespace dapple {

// Where a density estimate for light from a surface towards wo looks.
inline SurfaceRegion surface_region(const Vec3& position, const Bsdf& bsdf, const Vec3& wo)
{
    return {position, face_forward(bsdf.n_geometric, wo), bsdf.transmits() ? PhotonSide::both : PhotonSide::same};
}

struct SurfaceCoverage {
    float share = 1.0f;             // of the kernel's integral over the disc: at least 1/16, and 1 on a plane
    bool something_hidden = false;  // part of the surface on the disc is not seen from the centre
};

// A pure function of its arguments. Regions of both sides ask for the surface alone: nothing counts as hidden.
// time: in [0, 1] over the shutter, when the world is looked at.
SurfaceCoverage surface_coverage(const World& world, const SurfaceRegion& region, float radius, KernelKind kernel,
                                 float time = 0.5f);

// How an estimate is to allow for what of its disc is empty or hidden, by chance.
struct SampledCoverage {
    // At least 1, with the mean 1 / share; at most 32, which is too low on average where the share is below 1/10.
    float inverse = 1.0f;
    // Photons count only if sees_along_surface().
    bool obstructed = false;
};
// Whole where the disc is too small or too large for rays.
SampledCoverage sample_coverage(const World& world, const SurfaceRegion& region, float radius, KernelKind kernel,
                                float time, RandomStream& random);
// Whether the query's point sees a photon on the disc along the surface.
bool sees_along_surface(const World& world, const SurfaceRegion& region, float radius, const Vec3& photon, float time);

// The random numbers of the trials at a vertex of a path, apart from those that the path itself uses: so the path does
// not depend on the trials.
inline RandomStream stream_of_trials(RandomStream random, int depth)
{
    random.skip(static_cast<uint32_t>(depth) << 16);
    return random;
}

// The photons that take part in an estimate (density/estimate.h), with weights that allow for coverage. Replaces the
// contents of `found`. `nearest` as for visit_photons. caustics_alone: only photons of that class.
EstimateSupport find_covered_photons(const World& world, const PhotonMap& map, const SurfaceRegion& region,
                                     const Bandwidth& bandwidth, NearestPoints& nearest,
                                     std::vector<WeightedPhoton>& found, float time = 0.5f,
                                     bool caustics_alone = false);

}  // namespace dapple
