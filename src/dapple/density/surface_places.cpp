#include "dapple/density/surface_places.h"

namespace dapple {
namespace {

constexpr uint32_t leaf_size = PointTree::leaf_size;

size_t normal_index(uint32_t slot, uint32_t axis)
{
    return slot / leaf_size * leaf_size * 3 + axis * leaf_size + slot % leaf_size;
}

}  // namespace

// The filter of a region (SurfaceRegion::takes), eight places at a time.
struct SurfacePlaces::OnSurface {
    const float* normals;
    const SurfaceRegion& region;

    uint32_t operator()(uint32_t leaf) const
    {
        const float* n = normals + size_t{leaf} * leaf_size * 3;
        return region.takes(Float8::load(n) * Float8::all(region.normal.x) +
                                Float8::load(n + leaf_size) * Float8::all(region.normal.y) +
                                Float8::load(n + 2 * leaf_size) * Float8::all(region.normal.z),
                            Float8::all(1.0f));
    }
};

SurfacePlaces::SurfacePlaces(const std::vector<SurfacePlace>& places, int places_per_disc, float scale)
    : per_disc_(std::max(places_per_disc, 2)), scale_(scale)
{
    std::vector<Vec3> positions;
    positions.reserve(places.size());
    for (const SurfacePlace& place : places) positions.push_back(place.position);
    std::vector<uint32_t> order;
    tree_ = PointTree(positions, order);
    normals_.resize((order.size() + leaf_size - 1) / leaf_size * leaf_size * 3);
    for (uint32_t slot = 0; slot < size(); ++slot)
        for (uint32_t axis = 0; axis < 3; ++axis)
            normals_[normal_index(slot, axis)] = places[order[slot]].normal[static_cast<int>(axis)];
}

SurfacePlace SurfacePlaces::place(uint32_t slot) const
{
    const auto normal = [&](uint32_t axis) { return normals_[normal_index(slot, axis)]; };
    return {tree_.position(slot), Vec3(normal(0), normal(1), normal(2))};
}

float SurfacePlaces::radius_at(const SurfaceRegion& region, float limit) const
{
    NearestPoints& nearest = thread_nearest_points(per_disc_);
    tree_.find_nearest(region.disc(), sqr(limit / scale_), OnSurface{normals_.data(), region}, nearest);
    // Fewer are a reason to doubt, or those beyond the limit are not there.
    if (limit < infinity ? nearest.count() < per_disc_ : 2 * nearest.count() < per_disc_) return infinity;
    return scale_ * std::max(std::sqrt(nearest.distance_squared(nearest.farthest())), least_radius(region.position));
}

bool SurfacePlaces::nearest(const Vec3& position, const Vec3& normal, float max_distance, uint32_t& slot,
                            float& distance_squared) const
{
    NearestPoints& nearest = thread_nearest_points(1);
    const SurfaceRegion region{position, normal};
    tree_.find_nearest(region.disc(), sqr(max_distance), OnSurface{normals_.data(), region}, nearest);
    if (nearest.count() == 0) return false;
    slot = nearest.index(0);
    distance_squared = nearest.distance_squared(0);
    return true;
}

}  // namespace dapple
