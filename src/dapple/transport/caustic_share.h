// Which light comes to a surface as a caustic: by photons, and not by a path that finds its way from there to the
// light.
//
// A narrow lobe is hard to hit from a place that it lights, and easy to follow from the light. So light that a path
// scatters only at deltas and in lobes on its way from its source to a wide surface (is_wide) is shared out:
//   photons of the caustic map    the product of s(p_i) over these scatterings,
//   gather rays                   the rest.
// p_i is the density with which scattering samples the way that light takes there; for a delta s = 1. Both parts are
// estimates of the same light and s depends on the path alone, so any s is right; this one has no threshold in
// roughness, is 0 for matte surfaces, and takes a coat apart from what lies beneath it. Narrow surfaces have use for
// few of the photons that fall on them: they take those that come through deltas alone, which a ray may not find, and
// leave the rest to rays. How the shares of a whole path add up: integrators/caustic_run.h.
#pragma once

#include "dapple/materials/bsdf.h"

namespace dapple {

// s(p) = t^2 / (t^2 + c^2),  t = max(0, p - 1/pi): 0 where scattering samples no denser than a matte surface at most,
// 1/2 at p = c + 1/pi, 1 in narrow lobes [1/sr]. c = 1: even where a lobe is as dense as that of a GGX surface of alpha
// 0.25.
inline float narrow_share(float pdf, float c = 1.0f)
{
    const float t = pdf - inv_pi;
    return t > 0.0f ? 1.0f / (1.0f + sqr(c / t)) : 0.0f;
}

// Whether scattering, apart from a coat, spreads over the hemisphere, so that the few photons of an estimate sample it
// well.
inline bool is_wide(const Bsdf& bsdf) { return bsdf.is_matte() || bsdf.kind == BsdfKind::coated_diffuse; }

}  // namespace dapple
