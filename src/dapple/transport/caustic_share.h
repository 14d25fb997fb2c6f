// Which light comes to a surface as a caustic: by photons, and not by a path that finds its way from there to the
// light.
//
// A narrow lobe is hard to hit from a place that it lights, and easy to follow from the light. So light that a path
// scatters at narrow things alone on its way from its source to a wide surface (is_wide) is shared out:
//   photons of the caustic map    the product of s(p_i) over its scatterings,
//   gather rays                   the rest.
// p_i is the density with which scattering samples the way that light takes there; for a delta s = 1, for a wide
// surface s = 0. Both parts are estimates of the same light and s depends on the path alone, so any s is right. This
// one (as in visible_points.h) has no threshold in roughness.
#pragma once

#include "dapple/materials/bsdf.h"

namespace dapple {

// s(p) = t^2 / (t^2 + c^2),  t = max(0, p - 1/pi): 0 where scattering samples no denser than a matte surface at most,
// 1/2 near p = c, 1 in narrow lobes [1/sr].
inline float narrow_share(float pdf, float c)
{
    const float t2 = sqr(pdf > inv_pi ? pdf - inv_pi : 0.0f);
    return t2 / (sqr(c) + t2);
}

// Whether scattering spreads over the hemisphere, so that the few photons of an estimate sample it well.
inline bool is_wide(const Bsdf& bsdf) { return bsdf.is_matte() || bsdf.kind == BsdfKind::coated_diffuse; }

// s of light that a narrow surface scatters, but for its delta lobes. pdf: density of sampling the way that the light
// takes from there, given where it comes from [1/sr].
inline float caustic_share(float pdf)
{
    return narrow_share(pdf, 1.0f);  // even where a lobe is as dense as that of a GGX surface of roughness 0.25
}

}  // namespace dapple
