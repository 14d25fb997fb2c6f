// Irradiance computed beforehand at some photons of a map, for readers that need it at matte surfaces only.
// Christensen 1999, "Faster photon map global illumination". The photon where an estimate is made takes part in it:
// whoever asks for the record nearest to a point has found a gap around this point, which lacks one photon on average;
// leaving the record's own out as well would darken by 2 / k (measured).
#pragma once

#include "dapple/density/estimate.h"

#include <functional>
#include <vector>

namespace dapple {

// Puts the photons of an estimate into `found`. `nearest` is scratch space of the thread.
using FindPhotons = std::function<EstimateSupport(const PhotonMap& map, const SurfaceRegion& region,
                                                  NearestPoints& nearest, std::vector<WeightedPhoton>& found)>;

// visit_photons, as it is.
FindPhotons find_photons_within(const Bandwidth& bandwidth);

struct IrradianceRecord {
    Spectrum irradiance;  // [W/m^2]
    float radius = 0.0f;  // of the estimate [m]
    float last = 0.0f;    // as in EstimateSupport [m]
};

class IrradianceMap {
public:
    IrradianceMap() = default;
    // Estimates at every `stride`-th photon of the map, from the photons that `find` finds with scratch space for
    // `nearest` of them. Parallel; deterministic if `find` is.
    IrradianceMap(const PhotonMap& map, int nearest, const FindPhotons& find, uint32_t stride = 4);

    bool empty() const { return records_.empty(); }
    size_t memory_bytes() const
    {
        return tree_.memory_bytes() + records_.size() * sizeof(IrradianceRecord) + normals_.size() * sizeof(float);
    }

    // The record nearest to a point of a surface whose normal agrees within 60 degrees; null when there is none within
    // max_distance, or when the point lies beyond the radius of that record's estimate.
    const IrradianceRecord* nearest(const Vec3& position, const Vec3& normal, float max_distance = infinity) const;

private:
    PointTree tree_;
    std::vector<IrradianceRecord> records_;  // in the order of the tree's slots
    std::vector<float> normals_;             // of the lit side: for each leaf eight x, eight y, eight z
};

}  // namespace dapple
