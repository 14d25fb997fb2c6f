// Irradiance and its gradients from rays over the hemisphere of a point.
// Ward and Heckbert 1992, "Irradiance gradients"; Krivanek et al. 2005, "Improved radiance gradient computation", whose
// formula for the translation is the same for irradiance: light changes where the boundaries between strata move.
//
// M rings in elevation and N sectors in azimuth, equal in projected solid angle: ring j reaches from
// theta_j = asin(sqrt(j / M)) to theta_(j+1), sector k from 2 pi k / N on. With radiance L_jk and distance r_jk of the
// ray in stratum (j, k), u_k the unit vector of the sector's middle, v_k the one that turns away from its first
// boundary:
//   E          = pi / (M N) sum L_jk
//   rotation   = pi / (M N) sum_k v'_k sum_j tan(theta_jk) L_jk                      v'_k: a right angle beyond u_k
//   translation = sum_k [ u_k 2 pi / N sum_(j > 0) sin(theta_j) cos^2(theta_j) / min(r_jk, r_(j-1)k) (L_jk - L_(j-1)k)
//                       + v_k sum_j (sin(theta_(j+1)) - sin(theta_j)) / min(r_jk, r_j(k-1)) (L_jk - L_j(k-1)) ]
// Both lie in the tangent plane. The rotation is the derivative of the cosine over the cosine; its sign belongs to the
// axis cross(n, n').
#pragma once

#include "dapple/math/vec.h"
#include "dapple/spectrum/spectrum.h"

#include <span>

namespace dapple {

struct HemisphereStrata {
    int rings = 1;
    int sectors = 1;

    // About `rays` strata (at least 2 rings of 6), nearly as wide as high.
    static HemisphereStrata of(int rays);

    int count() const { return rings * sectors; }
    int index(int ring, int sector) const { return ring * sectors + sector; }
    // A cosine-distributed direction of a stratum; local, z is the normal.
    Vec3 direction(int ring, int sector, const Vec2& u) const;
};

// Components x and y of gradients belong to the axes of the frame that directions are local to.
struct HemisphereIrradiance {
    Spectrum value;                         // E [W/m^2]
    Spectrum rotation_x, rotation_y;        // E(n') = E(n) + cross(n, n') . rotation
    Spectrum translation_x, translation_y;  // E(p') = E(p) + (p' - p) . translation [W/m^3]
};

// `radiance` [W/(m^2 sr)] and `distance` [m] (infinity where nothing is met) by HemisphereStrata::index. u_ring(index)
// is the place of the ray within its ring, in [0, 1), as it was given to direction().
HemisphereIrradiance integrate_hemisphere(const HemisphereStrata& strata, std::span<const Spectrum> radiance,
                                          std::span<const float> distance, std::span<const float> u_ring);

// Harmonic mean of distances: how far the surroundings are, near ones counting most; infinity if nothing is met.
float harmonic_mean(std::span<const float> distance);

}  // namespace dapple
