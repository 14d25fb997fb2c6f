// How much of the disc of a density estimate lies on the surface that it speaks for. Near an edge or a corner part of
// the disc is empty, and behind a thin wall it belongs to another room: an estimate divided by the whole area falls to
// 1/2 at a straight edge and 1/4 at a corner, however many photons there are. Here the disc is what the query's point
// sees of its surface: points of a spiral are tried by two short rays, one down onto the surface (where the photons
// that count could lie: height and normal as in SurfaceRegion), one along it from the query's point. The estimate is
// divided by the share of the kernel's weight that passes. Where something on the disc is hidden, its photons are
// dropped, each by a ray of its own.
//
// Cost: 32 short rays where the disc is whole, 96 where it is not. Bias: the share has a relative error of about 2 % at
// a straight edge, which the quotient turns into some 1e-3 of brightening there; mirrors and glass that lie in the
// plane of a matte surface count as covered. Objects that move are looked at where they are at one time.
#pragma once

#include "dapple/density/estimate.h"
#include "dapple/materials/bsdf.h"
#include "dapple/world/world.h"

#include <vector>

namespace dapple {

// Where a density estimate for light from a surface towards wo looks.
inline SurfaceRegion surface_region(const Vec3& position, const Bsdf& bsdf, const Vec3& wo)
{
    return {position, face_forward(bsdf.n_geometric, wo), bsdf.transmits() ? PhotonSide::both : PhotonSide::same};
}

struct SurfaceCoverage {
    float share = 1.0f;             // of the kernel's integral over the disc, in (0, 1]
    bool something_hidden = false;  // part of the surface on the disc is not seen from the centre
};

// A pure function of its arguments. Regions of both sides ask for the surface alone: nothing counts as hidden.
// time: in [0, 1] over the shutter, when the world is looked at.
SurfaceCoverage surface_coverage(const World& world, const SurfaceRegion& region, float radius, KernelKind kernel,
                                 float time = 0.5f);

// The photons that take part in an estimate (density/estimate.h), with weights that allow for coverage. Replaces the
// contents of `found`. `nearest` as for visit_photons.
EstimateSupport find_covered_photons(const World& world, const PhotonMap& map, const SurfaceRegion& region,
                                     const Bandwidth& bandwidth, NearestPoints& nearest,
                                     std::vector<WeightedPhoton>& found, float time = 0.5f);

}  // namespace dapple
