#include "dapple/density/irradiance_map.h"

#include "dapple/base/assert.h"
#include "dapple/base/parallel.h"

namespace dapple {

IrradianceMap::IrradianceMap(const SurfacePlaces& places, float reach,
                             const std::function<PlaceIrradiance(const SurfacePlace&)>& estimate)
    : records_(places.size())
{
    parallel_for(places.size(), 256, [&](int64_t i) {
        const SurfacePlace place = places.place(static_cast<uint32_t>(i));
        IrradianceRecord& record = records_[static_cast<size_t>(i)];
        const PlaceIrradiance found = estimate(place);
        record.radius = places.radius_at({place.position, place.normal});
        record.irradiance = found.irradiance;
        record.reach = found.something_hidden ? 0.0f : reach * record.radius;
    });
}

const IrradianceRecord* IrradianceMap::nearest(const SurfacePlaces& places, const Vec3& position, const Vec3& normal,
                                               float max_distance) const
{
    DAPPLE_ASSERT(records_.size() == places.size());
    uint32_t slot = 0;
    float distance_squared = 0.0f;
    if (!places.nearest(position, normal, max_distance, slot, distance_squared)) return nullptr;
    const IrradianceRecord& record = records_[slot];
    return distance_squared <= sqr(record.reach) ? &record : nullptr;
}

}  // namespace dapple
