#include "dapple/photons/photon_map.h"

#include "dapple/base/error.h"
#include "dapple/base/parallel.h"

#include <memory>

namespace dapple {

bool is_usable(const Photon& photon)
{
    float largest_flux = 0.0f;
    for (int i = 0; i < Spectrum::lanes; ++i) largest_flux = std::max(largest_flux, std::fabs(photon.flux[i]));
    return max_component(abs(photon.position)) < 1e18f && largest_flux < 1e30f && is_finite(photon.position) &&
           photon.flux.is_finite() && is_finite(photon.direction) && is_finite(photon.normal) &&
           length_squared(photon.direction) > 0.5f && length_squared(photon.normal) > 0.5f;
}

PhotonMap::PhotonMap(std::vector<std::vector<Photon>>&& batches, uint64_t emitted) : emitted_(emitted)
{
    const auto batch_count = static_cast<int64_t>(batches.size());
    std::vector<size_t> first(batches.size() + 1, 0);
    parallel_for(batch_count, 1, [&](int64_t b) {
        const auto i = static_cast<size_t>(b);
        first[i + 1] = static_cast<size_t>(std::count_if(batches[i].begin(), batches[i].end(), is_usable));
    });
    for (size_t b = 0; b < batches.size(); ++b) {
        dropped_ += batches[b].size() - first[b + 1];
        first[b + 1] += first[b];
    }
    const size_t count = first.back();
    if (count >= 0xfffffff0u) throw UserError("a photon map holds fewer than 2^32 photons");

    // Pack each batch into its place and give its memory back at once.
    struct Packed {
        Payload payload;
        uint16_t normal;
    };
    std::vector<Vec3> positions(count);
    const auto packed = std::make_unique_for_overwrite<Packed[]>(count);
    parallel_for(batch_count, 1, [&](int64_t b) {
        size_t to = first[static_cast<size_t>(b)];
        const std::vector<Photon> batch = std::move(batches[static_cast<size_t>(b)]);
        for (const Photon& photon : batch) {
            if (!is_usable(photon)) continue;
            positions[to] = photon.position;
            const uint32_t direction = pack_unit<16>(photon.direction);
            packed[to] = {{{static_cast<uint16_t>(direction & 0xffffu), static_cast<uint16_t>(direction >> 16)},
                           pack_flux(photon.flux, to),
                           photon.light_group,
                           static_cast<uint8_t>(photon.path_class | (photon.from_delta_light ? delta_light_bit : 0))},
                          static_cast<uint16_t>(pack_unit<8>(photon.normal))};
            ++to;
        }
    });
    batches.clear();

    std::vector<uint32_t> order;
    tree_ = PointTree(positions, order);
    normal_.resize((count + PointTree::leaf_size - 1) / PointTree::leaf_size * PointTree::leaf_size);
    payload_.resize(count);
    parallel_for(static_cast<int64_t>(count), 1 << 14, [&](int64_t i) {
        const auto slot = static_cast<size_t>(i);
        payload_[slot] = packed[order[slot]].payload;
        normal_[slot] = packed[order[slot]].normal;
    });
}

size_t PhotonMap::memory_bytes() const
{
    return tree_.memory_bytes() + normal_.size() * sizeof(uint16_t) + payload_.size() * sizeof(Payload);
}

}  // namespace dapple
