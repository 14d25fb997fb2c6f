#include "dapple/density/irradiance_map.h"

#include "dapple/base/assert.h"
#include "dapple/base/parallel.h"
#include "dapple/base/path_class.h"

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

// W / K(0) (see the header) for a disc that holds that many records.
float weight_of_own_photon(KernelKind kernel, float records)
{
    constexpr int steps = 256;
    double weighed = 0.0, all = 0.0;
    for (int i = 0; i < steps; ++i) {
        const float t = (static_cast<float>(i) + 0.5f) / steps;
        const auto gap = static_cast<double>(t * std::erfc(0.5f * std::sqrt(records) * t));
        weighed += gap * static_cast<double>(kernel_disc(kernel, t));
        all += gap;
    }
    return static_cast<float>(weighed / all) / kernel_disc(kernel, 0.0f);
}

}  // namespace

IrradianceMap::IrradianceMap(const PhotonMap& map, const Bandwidth& bandwidth, const FindPhotons& find, uint32_t stride)
{
    DAPPLE_ASSERT(bandwidth.nearest >= 2);
    const float own_weight =
        weight_of_own_photon(bandwidth.kernel, static_cast<float>(bandwidth.nearest - 1) / static_cast<float>(stride));
    const uint32_t count = (map.size() + stride - 1) / stride;
    std::vector<Vec3> positions(count);
    std::vector<IrradianceRecord> records(count);
    parallel_for_ranges(count, 1024, [&](int64_t begin, int64_t end) {
        NearestPoints nearest(bandwidth.nearest);
        std::vector<WeightedPhoton> found;
        for (int64_t i = begin; i < end; ++i) {
            const uint32_t slot = static_cast<uint32_t>(i) * stride;
            positions[static_cast<size_t>(i)] = map.position(slot);
            IrradianceRecord& record = records[static_cast<size_t>(i)];
            const EstimateSupport support = find(map, {map.position(slot), map.normal(slot)}, nearest, found);
            // Beside a wall r is that of the photons on both sides: no measure of how far the record speaks.
            record.radius = support.something_hidden ? 0.0f : support.radius;
            record.last = support.last;
            const bool spread_evenly =
                map.from_delta_light(slot) && map.path_class(slot) == static_cast<uint8_t>(PathClass::direct);
            for (const auto& [photon, weight] : found)
                record.irradiance +=
                    map.flux(photon) * (photon == slot && !spread_evenly ? weight * own_weight : weight);
        }
    });
    std::vector<uint32_t> order;
    tree_ = PointTree(positions, order);
    records_.resize(count);
    constexpr uint32_t leaf = PointTree::leaf_size;
    normals_.resize((count + leaf - 1) / leaf * leaf * 3);
    for (uint32_t slot = 0; slot < count; ++slot) {
        records_[slot] = records[order[slot]];
        const Vec3 normal = map.normal(order[slot] * stride);
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
    return nearest.distance_squared(0) <= record.radius * record.radius ? &record : nullptr;
}

}  // namespace dapple
