// A test of whether photons lie evenly on a disc, and the radius that it leads to. After Lin et al. 2020, "CPPM:
// chi-squared progressive photon mapping": where photons are spread evenly a wide estimate has no bias, so a radius
// need shrink only where a chi-squared test rejects that. What differs, and why:
//   - The paper tests the photons of a pixel over all passes so far and keeps the radius as the pixel's state. Here a
//     pass is a pure function of its number, so the test looks at photons of the same pass, and lowers the radius of
//     the schedule (schedule.h) for this one estimate. The radius of a pass has bounds, 1/4 and 1 of the schedule's, so
//     what the schedule proves (errors fade) still holds.
//   - A radius chosen by the very photons that are added up afterwards would pick out chance gaps and clusters. Here
//     the photons tested are others than those of the estimate: of the other wavelength sets, or, if there is but one,
//     of the other half of the light paths. So the choice adds no bias.
//   - In place of counts in cells, the statistic is that of a smooth test (Neyman 1937), sum_k S_k^2 / sum_p w_p^2 with
//     S_k = sum_p w_p phi_k(x_p, y_p), for the five polynomials phi of degree 1 and 2 that are orthonormal on the disc
//     together with 1: 2x, 2y, sqrt(6) (x^2 - y^2), sqrt(24) xy, sqrt(3) (2 x^2 + 2 y^2 - 1). With even light it
//     follows the chi-squared distribution of 5 degrees of freedom, as counts in six cells would; but it sees edges
//     (degree 1), lines and spots (degree 2) in any direction and with a few dozen photons, where six cells have too
//     few each. The weights w are the photons' flux, so that many dim photons do not drown an edge in the light of few
//     bright ones.
// Edges of surfaces look uneven too: there a lower radius is not needed (surface_coverage.h), and costs noise.
// Where shapes move, the other sets have other times: the test then looks at other places of a shadow, and serves less.
// Cost: a query of the other maps for each estimate.
#pragma once

#include "dapple/photons/photon_map.h"

#include <span>

namespace dapple {

// The statistic, for points added one by one.
class UniformityTest {
public:
    // Chi-squared distribution of 5 degrees of freedom: exceeded with probability 0.01.
    static constexpr float critical_value = 15.0863f;

    // A photon at a point of the unit disc.
    void add(float x, float y, float weight);
    float statistic() const { return squares_ > 0.0f ? sum_of_squares() / squares_ : 0.0f; }
    bool rejects() const { return statistic() > critical_value; }

private:
    float sum_of_squares() const;

    float sums_[5] = {};
    float squares_ = 0.0f;
};

// The radius, or the largest of its parts by 2^(-1/2), 2^(-1), 2^(-3/2) and 2^(-2) (this one in any case) within which
// the photons of all maps but maps[own] lie evenly in the region. Does not look at maps[own].
float tested_radius(std::span<const PhotonMap> maps, size_t own, const SurfaceRegion& region, float radius);

}  // namespace dapple
