// Irradiance computed beforehand at some photons of a map, for readers that need it at matte surfaces only.
// Christensen 1999, "Faster photon map global illumination".
#pragma once

#include "dapple/density/estimate.h"

#include <vector>

namespace dapple {

struct IrradianceRecord {
    Vec3 normal{0, 0, 1};  // the side that the irradiance arrives on
    Spectrum irradiance;   // [W/m^2]
    float radius = 0.0f;   // of the estimate [m]
};

class IrradianceMap {
public:
    IrradianceMap() = default;
    // Estimates at every `stride`-th photon of the map. Parallel; deterministic.
    IrradianceMap(const PhotonMap& map, const Bandwidth& bandwidth, uint32_t stride = 4);

    bool empty() const { return records_.empty(); }
    size_t memory_bytes() const { return tree_.memory_bytes() + records_.size() * sizeof(IrradianceRecord); }

    // The record nearest to a point of a surface whose normal agrees within 60 degrees; null when there is none within
    // max_distance, or when the point lies beyond the radius of that record's estimate.
    const IrradianceRecord* nearest(const Vec3& position, const Vec3& normal, float max_distance = infinity) const;

private:
    PointTree tree_;
    std::vector<IrradianceRecord> records_;  // in the order of the tree's slots
};

}  // namespace dapple
