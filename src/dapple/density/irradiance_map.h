// Irradiance computed beforehand at some photons of a map, for readers that need it at matte surfaces only.
// Christensen 1999, "Faster photon map global illumination". The photon where an estimate is made takes part in it:
// whoever asks for the record nearest to a point has found a gap around this point, which lacks one photon on average.
// But the photon lies in the middle of the estimate, where the kernel is high, and the gap beside it. Let the records
// be spread independently, a of them in a disc. The gap is a disc round the point, with the record on its edge; on
// average the kernel K over it (over what of it lies within the estimate) is
//   W = integral of K(t) t erfc(sqrt(a) t / 2) over t in [0, 1], divided by the same without K,
// and so much the photon counts, not K(0): else estimates are 0.4 / k too bright with every fourth of k = 50 photons
// and Epanechnikov's kernel. First hits of a light without extent are spread evenly: each has a gap of its own round
// it, and counts in full.
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
    float radius = 0.0f;  // of the estimate [m]; 0 where something stands on its disc
    float last = 0.0f;    // as in EstimateSupport [m]
};

class IrradianceMap {
public:
    IrradianceMap() = default;
    // Estimates at every `stride`-th photon of the map, from the photons that `find` finds with this bandwidth.
    // Parallel; deterministic if `find` is.
    IrradianceMap(const PhotonMap& map, const Bandwidth& bandwidth, const FindPhotons& find, uint32_t stride = 4);

    bool empty() const { return records_.empty(); }
    size_t memory_bytes() const
    {
        return tree_.memory_bytes() + records_.size() * sizeof(IrradianceRecord) + normals_.size() * sizeof(float);
    }

    // The record nearest to a point of a surface whose normal agrees within 60 degrees; null when there is none within
    // max_distance, or when the point lies beyond the radius of that record's estimate, or beside a wall.
    const IrradianceRecord* nearest(const Vec3& position, const Vec3& normal, float max_distance = infinity) const;

private:
    PointTree tree_;
    std::vector<IrradianceRecord> records_;  // in the order of the tree's slots
    std::vector<float> normals_;             // of the lit side: for each leaf eight x, eight y, eight z
};

}  // namespace dapple
