// Irradiance computed beforehand at places of surfaces, for readers that need it at matte surfaces only.
// Christensen 1999, "Faster photon map global illumination". There the places are some of the photons; here they are
// where other light paths met surfaces, which are spread as photons are but know nothing of these: at a photon of the
// map itself an estimate is too bright, as one photon is there for sure.
#pragma once

#include "dapple/density/surface_places.h"

#include <functional>
#include <vector>

namespace dapple {

struct IrradianceRecord {
    Spectrum irradiance;  // [W/m^2]
    float radius = 0.0f;  // of the estimate [m]
    float reach = 0.0f;   // how far it speaks for other places [m]
};

// What is estimated at a place.
struct PlaceIrradiance {
    Spectrum irradiance;            // [W/m^2]
    bool something_hidden = false;  // what lies behind something was left out: the record speaks for no other place
};

class IrradianceMap {
public:
    IrradianceMap() = default;
    // reach: how far records speak for other places, in radii of their estimates. Parallel; deterministic if
    // `estimate` is.
    IrradianceMap(const SurfacePlaces& places, float reach,
                  const std::function<PlaceIrradiance(const SurfacePlace&)>& estimate);

    bool empty() const { return records_.empty(); }
    size_t memory_bytes() const { return records_.size() * sizeof(IrradianceRecord); }

    // The record of the place nearest to a point of a surface whose normal agrees within 60 degrees; null when there
    // is none within max_distance, or when the point lies beyond its reach. (Where no light falls, the nearest place
    // may be that of another surface far away, even beyond a wall.) Places lie denser where there is more light, so
    // that readers get light from their brighter side: too much, by a share that goes as (reach radius / way over
    // which light changes)^2. `places` are those that the map was made of.
    const IrradianceRecord* nearest(const SurfacePlaces& places, const Vec3& position, const Vec3& normal,
                                    float max_distance = infinity) const;

private:
    std::vector<IrradianceRecord> records_;  // by slot of the places
};

}  // namespace dapple
