// The photons of one emission, packed in the leaf order of a PointTree. Bytes per photon: position 12, tree 3.43,
// geometric normal 2, direction 4, flux 8, light group 1, path class and kind of light 1: 31.43 in all (leaves are
// filled to eight, so small maps take a little more). While it is built, the map needs about 90 bytes per photon
// besides its batches.
#pragma once

#include "dapple/photons/photon.h"
#include "dapple/photons/photon_packing.h"
#include "dapple/photons/point_tree.h"

#include <vector>

namespace dapple {

// Which photons a query on a surface takes, by the side of the surface that they arrived on.
enum class PhotonSide : uint8_t {
    same,      // the side of the query's normal: reflection
    opposite,  // the other side: transmission
    both,
};

// Where a query on a surface looks: a disc of height radius / inverse_flatness to either side of the tangent plane.
// Photons whose own normal differs from the query's by more than the given angle do not count, so that neither the
// other face of a thin wall nor the wall at a corner adds to the surface.
struct SurfaceRegion {
    Vec3 position;
    Vec3 normal;  // unit geometric normal, flipped to the viewer's side
    PhotonSide side = PhotonSide::same;
    float inverse_flatness = 10.0f;
    float min_normal_cosine = 0.5f;

    DiscRegion disc() const { return {position, normal, inverse_flatness}; }
    // Whether a photon of this normal counts.
    bool takes(const Vec3& photon_normal) const
    {
        const float cosine = dot(photon_normal, normal);
        return (side == PhotonSide::same       ? cosine
                : side == PhotonSide::opposite ? -cosine
                                               : std::fabs(cosine)) > min_normal_cosine;
    }
    // A mask of those that count among eight, of the products of their normals with the region's and their lengths.
    uint32_t takes(Float8 products, Float8 lengths) const
    {
        if (side == PhotonSide::opposite) products = Float8::all(0.0f) - products;
        if (side == PhotonSide::both) products = abs(products);
        return less_mask(Float8::all(min_normal_cosine) * lengths, products);
    }
};

// Photons that coincide would make the radius of an estimate 0.
inline float least_radius(const Vec3& p) { return 1e-6f * std::max(max_component(abs(p)), 1e-6f); }

// Whether position and flux are finite (below 1e18 m, 1e30 W), and the normal and direction are some.
bool is_usable(const Photon& photon);

class PhotonMap {
public:
    // An empty map that knows of no emission.
    PhotonMap() = default;
    // Joins the batches in their order and sorts them. `emitted` counts all emitted light paths, also those that left
    // no photon here. Photons that are not usable are left out and counted. Parallel; the result depends on the photons
    // and their order alone.
    PhotonMap(std::vector<std::vector<Photon>>&& batches, uint64_t emitted);

    uint32_t size() const { return tree_.size(); }
    bool empty() const { return size() == 0; }
    uint64_t emitted() const { return emitted_; }
    uint64_t dropped() const { return dropped_; }
    const PointTree& tree() const { return tree_; }
    Box3 bounds() const { return tree_.bounds(); }
    size_t memory_bytes() const;

    // The photon in a slot, 0 to size() - 1. Slots follow the tree, not the order of storing.
    Vec3 position(uint32_t slot) const { return tree_.position(slot); }
    Vec3 direction(uint32_t slot) const
    {
        const Payload& p = payload_[slot];
        return unpack_unit<16>(p.direction[0] | static_cast<uint32_t>(p.direction[1]) << 16);
    }
    Vec3 normal(uint32_t slot) const { return unpack_unit<8>(normal_[slot]); }
    Spectrum flux(uint32_t slot) const { return unpack_flux(payload_[slot].flux); }
    uint8_t light_group(uint32_t slot) const { return payload_[slot].light_group; }
    uint8_t path_class(uint32_t slot) const { return payload_[slot].path_class & ~delta_light_bit; }
    bool from_delta_light(uint32_t slot) const { return (payload_[slot].path_class & delta_light_bit) != 0; }
    Photon photon(uint32_t slot) const
    {
        return {position(slot),    direction(slot),  normal(slot),          flux(slot),
                light_group(slot), path_class(slot), from_delta_light(slot)};
    }

    // Calls visit(slot, distance_squared) for each photon nearer to p than radius.
    template <class Visitor>
    void for_each_within(const Vec3& p, float radius, Visitor&& visit) const
    {
        tree_.for_each_within(BallRegion{p}, radius * radius, AcceptAll{}, visit);
    }
    // The result.k() photons nearest to p and nearer than max_radius.
    void find_nearest(const Vec3& p, float max_radius, NearestPoints& result) const
    {
        tree_.find_nearest(BallRegion{p}, max_radius * max_radius, AcceptAll{}, result);
    }
    // The same two for the photons of a surface; distances are those of DiscRegion.
    template <class Visitor>
    void for_each_on_surface(const SurfaceRegion& region, float radius, Visitor&& visit) const
    {
        tree_.for_each_within(region.disc(), radius * radius, NormalFilter{normal_.data(), region}, visit);
    }
    // Photons whose normal the region takes and whose own disc, round them and in their plane, holds its position.
    template <class Visitor>
    void for_each_reaching(const SurfaceRegion& region, const PointLimits& radii, Visitor&& visit) const
    {
        tree_.for_each_reaching(
            BallRegion{region.position}, radii, NormalFilter{normal_.data(), region},
            [&](uint32_t slot, float to_photon_squared) {
                const float distance_squared =
                    DiscRegion{position(slot), normal(slot), region.inverse_flatness}.distance_squared(
                        region.position, to_photon_squared);
                if (distance_squared < radii.squared(slot)) visit(slot, distance_squared);
            });
    }
    void find_nearest_on_surface(const SurfaceRegion& region, float max_radius, NearestPoints& result) const
    {
        tree_.find_nearest(region.disc(), max_radius * max_radius, NormalFilter{normal_.data(), region}, result);
    }

private:
    static constexpr uint8_t delta_light_bit = 0x80;  // beside the path class
    struct Payload {
        uint16_t direction[2];
        PackedFlux flux;
        uint8_t light_group;
        uint8_t path_class;
    };
    static_assert(sizeof(Payload) == 14);

    // Compares eight packed normals with that of the query, without normalising them.
    struct NormalFilter {
        const uint16_t* normals;
        const SurfaceRegion& region;

        uint32_t operator()(uint32_t leaf) const;
    };

    PointTree tree_;
    std::vector<uint16_t> normal_;  // padded to whole leaves
    std::vector<Payload> payload_;
    uint64_t emitted_ = 0;
    uint64_t dropped_ = 0;
};

inline uint32_t PhotonMap::NormalFilter::operator()(uint32_t leaf) const
{
    const Float8 one = Float8::all(1.0f);
    const Float8 scale = Float8::all(1.0f / octahedral_steps<8>);
    Float8 u, v;
    bytes_to_floats(normals + leaf * PointTree::leaf_size, u, v);
    u = u * scale - one;
    v = v * scale - one;
    const Float8 z = one - abs(u) - abs(v);
    const Float8 x = select_negative(z, copy_sign(one - abs(v), u), u);
    const Float8 y = select_negative(z, copy_sign(one - abs(u), v), v);
    return region.takes(
        x * Float8::all(region.normal.x) + y * Float8::all(region.normal.y) + z * Float8::all(region.normal.z),
        sqrt(x * x + y * y + z * z));
}

}  // namespace dapple
