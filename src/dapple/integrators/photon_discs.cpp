#include "dapple/integrators/photon_discs.h"

#include "dapple/base/assert.h"
#include "dapple/base/parallel.h"
#include "dapple/math/hash.h"

namespace dapple {
namespace {

constexpr uint8_t obstructed_bit = 0x80;

}  // namespace

PhotonDiscs::PhotonDiscs(const PassContext& context, const PhotonMap& map, const SurfacePlaces& places,
                         KernelKind kernel, float time)
    : coverage_(map.size()), kernel_(kernel), time_(time)
{
    const Box3 bounds = map.bounds();
    const float widest = map.empty() ? 0.0f : std::max(length(bounds.max - bounds.min), 1e-6f);
    std::vector<float> squared(map.size());
    parallel_for(map.size(), 1024, [&](int64_t i) {
        if (context.cancelled()) return;
        const auto slot = static_cast<uint32_t>(i);
        const SurfaceRegion region{map.position(slot), map.normal(slot)};
        const float radius = std::min(places.radius_at(region), widest);
        squared[slot] = sqr(radius);
        // Random numbers that belong to the photon: they know nothing of its neighbours.
        RandomStream random(
            hash_words(float_bits(region.position.x), float_bits(region.position.y), float_bits(region.position.z)), 0,
            slot);
        const SampledCoverage coverage = sample_coverage(context.world, region, radius, kernel, time, random);
        coverage_[slot] = static_cast<uint8_t>(coverage.inverse) | (coverage.obstructed ? obstructed_bit : uint8_t(0));
    });
    radii_ = map.tree().limits(std::move(squared));
}

bool PhotonDiscs::find(const World& world, const PhotonMap& map, const SurfaceRegion& region,
                       std::vector<WeightedPhoton>& found) const
{
    DAPPLE_ASSERT(coverage_.size() == map.size());
    found.clear();
    visit_reaching(map, radii_, region, kernel_, [&](uint32_t slot, float weight) {
        found.push_back({slot, weight * static_cast<float>(coverage_[slot] & ~obstructed_bit)});
    });
    // As the share was found: what a photon does not see of its disc has no part of its flux.
    const size_t hidden = std::erase_if(found, [&](const WeightedPhoton& photon) {
        const uint32_t slot = photon.first;
        return (coverage_[slot] & obstructed_bit) != 0 &&
               !sees_along_surface(world, {map.position(slot), map.normal(slot)}, std::sqrt(radii_.squared(slot)),
                                   region.position, time_);
    });
    return hidden > 0;
}

}  // namespace dapple
