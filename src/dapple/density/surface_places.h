// How wide estimates from a photon map are to be, told by other light paths than those that made it.
//
// The usual estimate takes the k photons nearest to the place that asks, and divides by the disc that they fill. Beside
// a bright patch the disc of a dark place reaches into the patch: it counts k / (pi d^2) at the distance d, however
// dark the place is, which adds up to 2 k log(d_max / d_min) photons too many over a floor. Here each photon has a
// radius of its own instead, that of the disc that would hold k photons round *it*, and spreads its flux over that
// (the sample point estimator: Breiman, Meisel and Purcell 1977, "Variable kernel estimates of multivariate
// densities"; Silverman 1986, section 5.3). No flux is made or lost, and photons of a bright patch keep to it.
//
// A radius found among the photons themselves would go with their noise: narrow where they happen to lie dense. So it
// is found among the places where a few further light paths meet surfaces, which are spread as photons are, but know
// nothing of these. What asks whether estimates are narrow enough may decide by yet other places, without favouring
// bright estimates or dark ones. (By the same ones, it would find itself where photons' discs are wide.)
#pragma once

#include "dapple/photons/photon_map.h"

#include <vector>

namespace dapple {

struct SurfacePlace {
    Vec3 position;
    Vec3 normal;  // geometric, unit length, to the side that light arrived on
};

class SurfacePlaces {
public:
    SurfacePlaces() = default;
    // places_per_disc: how many fill the disc of an estimate; at least 2, as the nearest one may lie as near as it
    // likes, and what is divided by its squared distance has no variance. scale: of all radii.
    SurfacePlaces(const std::vector<SurfacePlace>& places, int places_per_disc, float scale = 1.0f);

    uint32_t size() const { return tree_.size(); }
    size_t memory_bytes() const { return tree_.memory_bytes() + normals_.size() * sizeof(float); }
    // The place in a slot, 0 to size() - 1, with the normal as it was given.
    SurfacePlace place(uint32_t slot) const;

    // The radius of an estimate there [m], above 0: that of the disc that just holds places_per_disc places of the
    // surface, or all there are, times the scale. Infinite where there are not half as many (with a limit: not all), or
    // where it is not below the limit. At one of the places it counts itself.
    float radius_at(const SurfaceRegion& region, float limit = infinity) const;

    // Slot and squared distance of the place nearest to a point, on the side of the normal; false: there is none
    // nearer than max_distance.
    bool nearest(const Vec3& position, const Vec3& normal, float max_distance, uint32_t& slot,
                 float& distance_squared) const;

private:
    struct OnSurface;

    PointTree tree_;
    std::vector<float> normals_;  // for each leaf eight x, eight y, eight z
    int per_disc_ = 2;
    float scale_ = 1.0f;
};

}  // namespace dapple
