#include "dapple/density/irradiance_map.h"

#include "dapple/base/assert.h"
#include "dapple/base/parallel.h"

namespace dapple {

FindPhotons find_photons_within(const Bandwidth& bandwidth)
{
    return [bandwidth](const PhotonMap& map, const SurfaceRegion& region, NearestPoints& nearest,
                       std::vector<WeightedPhoton>& found) {
        found.clear();
        return visit_photons(map, region, bandwidth, nearest, [&](uint32_t slot, float weight) {
            found.push_back({slot, weight});
        });
    };
}

namespace {

constexpr float reach = 0.35f;  // of a record, in radii of its estimate

}  // namespace

IrradianceMap::IrradianceMap(const PhotonMap& map, const std::vector<SurfacePlace>& places, int nearest_count,
                             const FindPhotons& find)
{
    const auto count = static_cast<uint32_t>(places.size());
    std::vector<Vec3> positions(count);
    std::vector<IrradianceRecord> records(count);
    parallel_for_ranges(count, 1024, [&](int64_t begin, int64_t end) {
        NearestPoints nearest(nearest_count);
        std::vector<WeightedPhoton> found;
        for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
            positions[i] = places[i].position;
            IrradianceRecord& record = records[i];
            const EstimateSupport support = find(map, {places[i].position, places[i].normal}, nearest, found);
            // Beside a wall r is that of the photons on both sides: no measure of how far the record speaks.
            record.reach = support.something_hidden ? 0.0f : reach * support.radius;
            record.before_last = support.before_last;
            record.last = support.last;
            for (const auto& [photon, weight] : found) record.irradiance += map.flux(photon) * weight;
        }
    });
    std::vector<uint32_t> order;
    tree_ = PointTree(positions, order);
    records_.resize(count);
    constexpr uint32_t leaf = PointTree::leaf_size;
    normals_.resize((count + leaf - 1) / leaf * leaf * 3);
    for (uint32_t slot = 0; slot < count; ++slot) {
        records_[slot] = records[order[slot]];
        const Vec3 normal = places[order[slot]].normal;
        for (uint32_t c = 0; c < 3; ++c)
            normals_[slot / leaf * leaf * 3 + c * leaf + slot % leaf] = normal[static_cast<int>(c)];
    }
}

const IrradianceRecord* IrradianceMap::nearest(const Vec3& position, const Vec3& normal, float max_distance) const
{
    thread_local NearestPoints nearest(1);  // scratch space, not a result
    const Float8 x = Float8::all(normal.x), y = Float8::all(normal.y), z = Float8::all(normal.z);
    const auto agrees = [&](uint32_t leaf) {
        const float* n = &normals_[leaf * PointTree::leaf_size * 3];
        return less_mask(Float8::all(0.5f), Float8::load(n) * x + Float8::load(n + 8) * y + Float8::load(n + 16) * z);
    };
    tree_.find_nearest(DiscRegion{position, normal}, max_distance * max_distance, agrees, nearest);
    if (nearest.count() == 0) return nullptr;
    // A record speaks for the disc that its photons came from. Where no light falls, the nearest one may be that of
    // another surface far away, even beyond a wall.
    const IrradianceRecord& record = records_[nearest.index(0)];
    return nearest.distance_squared(0) <= sqr(record.reach) ? &record : nullptr;
}

}  // namespace dapple
