// Irradiance computed beforehand at places of surfaces, for readers that need it at matte surfaces only.
// Christensen 1999, "Faster photon map global illumination". There the places are some of the photons; here they are
// where other light paths met surfaces, which are spread as photons are but know nothing of these: at a photon of the
// map itself an estimate is too bright, as one photon is there for sure, while whoever asks for the nearest record has
// found a gap that lacks one.
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
    Spectrum irradiance;       // [W/m^2]
    float reach = 0.0f;        // how far it speaks for other places [m]; 0 where something stands on its disc
    float before_last = 0.0f;  // as in EstimateSupport [m]
    float last = 0.0f;
};

struct SurfacePlace {
    Vec3 position;
    Vec3 normal;  // geometric, unit length, to the side whose light is meant
};

class IrradianceMap {
public:
    IrradianceMap() = default;
    // Estimates at places on surfaces from the photons that `find` finds; `nearest` is the k of its bandwidth.
    // Parallel; deterministic if `find` is.
    IrradianceMap(const PhotonMap& map, const std::vector<SurfacePlace>& places, int nearest, const FindPhotons& find);

    bool empty() const { return records_.empty(); }
    size_t memory_bytes() const
    {
        return tree_.memory_bytes() + records_.size() * sizeof(IrradianceRecord) + normals_.size() * sizeof(float);
    }

    // The record nearest to a point of a surface whose normal agrees within 60 degrees; null when there is none within
    // max_distance, or when the point lies beyond its reach. Beside a bright patch whose photons lie dense, the nearest
    // record of a dark place is one of the patch, so that the patch grows by the reach: a third of the estimate's
    // radius, which is too short once in five times where light is even. That the reach hangs on the photons of the
    // estimate makes readers 0.04 +- 0.03 % darker than searches (measured, k = 50).
    const IrradianceRecord* nearest(const Vec3& position, const Vec3& normal, float max_distance = infinity) const;

private:
    PointTree tree_;
    std::vector<IrradianceRecord> records_;  // in the order of the tree's slots
    std::vector<float> normals_;             // of the lit side: for each leaf eight x, eight y, eight z
};

}  // namespace dapple
