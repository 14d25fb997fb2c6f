// A kd-tree over points for nearest-k and range queries (Bentley 1975; the layout is ours). Points are split at the
// median of the widest axis until eight are left; three binary levels form one node that holds the tight boxes of its
// (up to) eight children side by side, so that one node or one leaf is tested with eight lanes at once. Node i of a
// level covers exactly the children 8 i to 8 i + 7 of the level below: there are no pointers and no split planes.
// Cost: 12 bytes per point for the coordinates, 192 bytes per eight leaves (3.43 bytes per point in all levels).
// Building is O(n log n) in parallel, with the same result on any number of threads.
#pragma once

#include "dapple/base/assert.h"
#include "dapple/photons/nearest_points.h"

#include <array>
#include <span>

namespace dapple {

// All points at Euclidean distance below the radius.
struct BallRegion {
    Vec3 center;

    Float8 distance_squared(Float8 x, Float8 y, Float8 z) const
    {
        const Float8 dx = x - Float8::all(center.x);
        const Float8 dy = y - Float8::all(center.y);
        const Float8 dz = z - Float8::all(center.z);
        return dx * dx + dy * dy + dz * dz;
    }
};

// A flat disc: points below the radius whose height over the plane through `center` is below radius / inverse_flatness.
// Its distance is max(|p - center|, inverse_flatness |dot(p - center, normal)|), so nearest-k works on it as well.
struct DiscRegion {
    Vec3 center;
    Vec3 normal;
    float inverse_flatness = 10.0f;

    Float8 distance_squared(Float8 x, Float8 y, Float8 z) const
    {
        const Float8 dx = x - Float8::all(center.x);
        const Float8 dy = y - Float8::all(center.y);
        const Float8 dz = z - Float8::all(center.z);
        const Float8 height = dx * Float8::all(normal.x * inverse_flatness) +
                              dy * Float8::all(normal.y * inverse_flatness) +
                              dz * Float8::all(normal.z * inverse_flatness);
        return max(dx * dx + dy * dy + dz * dz, height * height);
    }
    // The same for one point, whose distance to the centre is known.
    float distance_squared(const Vec3& p, float to_center_squared) const
    {
        return std::max(to_center_squared, sqr(inverse_flatness * dot(p - center, normal)));
    }
};

// For each point of a tree a distance of its own, which the places that ask for it must not exceed.
class PointLimits {
public:
    PointLimits() = default;
    float squared(uint32_t slot) const { return slots_[slot]; }
    size_t memory_bytes() const { return slots_.size() * sizeof(float) + nodes_.size() * sizeof(nodes_[0]); }

private:
    friend class PointTree;

    Float8 of_children(uint32_t node) const { return Float8::load(nodes_[node].data()); }
    Float8 of_leaf(uint32_t leaf) const { return Float8::load(&slots_[size_t{leaf} * 8]); }

    std::vector<float> slots_;                 // squared, padded to whole leaves
    std::vector<std::array<float, 8>> nodes_;  // the largest below each child
};

// The filter that takes every point.
struct AcceptAll {
    uint32_t operator()(uint32_t) const { return 0xffu; }
};

class PointTree {
public:
    static constexpr uint32_t leaf_size = 8;

    PointTree() = default;
    // Sorts `points` (coordinates below 1e18 in magnitude, fewer than 2^32 - 16 points) into leaves; order[slot]
    // becomes the index of the point that the tree keeps at `slot`. Ties of equal coordinates are broken by index.
    PointTree(std::span<const Vec3> points, std::vector<uint32_t>& order);

    uint32_t size() const { return size_; }
    Vec3 position(uint32_t slot) const
    {
        const Block& b = blocks_[slot / leaf_size];
        return {b.x[slot % leaf_size], b.y[slot % leaf_size], b.z[slot % leaf_size]};
    }
    // Box of all points; empty without points.
    Box3 bounds() const;
    size_t memory_bytes() const { return blocks_.size() * sizeof(Block) + nodes_.size() * sizeof(Node); }

    // Calls visit(slot, distance_squared) for each accepted point with distance below sqrt(radius_squared), in tree
    // order. accept(leaf) returns a mask of eight bits for the slots 8 leaf to 8 leaf + 7.
    template <class Region, class Accept, class Visitor>
    void for_each_within(const Region& region, float radius_squared, const Accept& accept, Visitor&& visit) const;

    // The same for each accepted point whose own limit exceeds its distance.
    template <class Region, class Accept, class Visitor>
    void for_each_reaching(const Region& region, const PointLimits& limits, const Accept& accept,
                           Visitor&& visit) const;
    // Of distances squared, by slot.
    PointLimits limits(std::vector<float> distances_squared) const;

    // Fills `result` with the result.k() nearest accepted points with distance below sqrt(max_distance_squared).
    template <class Region, class Accept>
    void find_nearest(const Region& region, float max_distance_squared, const Accept& accept,
                      NearestPoints& result) const;

private:
    friend class PointTreeBuilder;

    static constexpr int max_levels = 11;

    struct alignas(32) Block {
        float x[leaf_size], y[leaf_size], z[leaf_size];
    };
    struct alignas(64) Node {
        float low[3][8], high[3][8];

        // Squared distances from p to the eight child boxes; infinite for absent children. Rounds as the distances to
        // points do, so that it never exceeds the distance of a point inside.
        Float8 distance_squared(const Vec3& p) const
        {
            Float8 sum = Float8::all(0.0f);
            for (int axis = 0; axis < 3; ++axis) {
                const Float8 at = Float8::all(p[axis]);
                const Float8 outside = max(Float8::load(low[axis]) - at, at - Float8::load(high[axis]));
                const Float8 d = max(outside, Float8::all(0.0f));
                sum = sum + d * d;
            }
            return sum;
        }
    };

    uint32_t node_index(int level, uint32_t i) const { return level_begin_[static_cast<size_t>(level)] + i; }
    const Node& node(int level, uint32_t i) const { return nodes_[node_index(level, i)]; }
    // limit_of_children(node) and limit_of_leaf(leaf) return squared distances.
    template <class Region, class ChildLimit, class LeafLimit, class Accept, class Visitor>
    void visit_below(const Region& region, const ChildLimit& limit_of_children, const LeafLimit& limit_of_leaf,
                     const Accept& accept, Visitor&& visit) const;
    void prefetch_child(int level, uint32_t child) const
    {
        const char* p = level > 0 ? reinterpret_cast<const char*>(&node(level - 1, child))
                                  : reinterpret_cast<const char*>(&blocks_[child]);
        __builtin_prefetch(p);
        __builtin_prefetch(p + 64);
        if (level > 0) __builtin_prefetch(p + 128);
    }

    uint32_t size_ = 0;
    int levels_ = 0;                                      // levels of nodes; level 0 has leaves as children
    std::array<uint32_t, max_levels + 1> level_begin_{};  // first node of each level
    std::vector<Block> blocks_;
    std::vector<Node> nodes_;
};

template <class Region, class Accept, class Visitor>
void PointTree::for_each_within(const Region& region, float radius_squared, const Accept& accept, Visitor&& visit) const
{
    const auto limit = [all = Float8::all(radius_squared)](uint32_t) { return all; };
    visit_below(region, limit, limit, accept, visit);
}

template <class Region, class Accept, class Visitor>
void PointTree::for_each_reaching(const Region& region, const PointLimits& limits, const Accept& accept,
                                  Visitor&& visit) const
{
    visit_below(
        region, [&](uint32_t node) { return limits.of_children(node); },
        [&](uint32_t leaf) { return limits.of_leaf(leaf); }, accept, visit);
}

template <class Region, class ChildLimit, class LeafLimit, class Accept, class Visitor>
void PointTree::visit_below(const Region& region, const ChildLimit& limit_of_children, const LeafLimit& limit_of_leaf,
                            const Accept& accept, Visitor&& visit) const
{
    if (size_ == 0) return;
    struct Open {
        uint32_t first_child;
        uint32_t mask;  // children still to visit
    };
    HitBuffer hits;
    Open stack[max_levels];
    int level = levels_ - 1;
    const auto open = [&](uint32_t i) {
        const uint32_t mask =
            less_mask(node(level, i).distance_squared(region.center), limit_of_children(node_index(level, i)));
        stack[level] = {i * 8, mask};
        for (uint32_t m = mask; m != 0; m &= m - 1)
            prefetch_child(level, i * 8 + static_cast<uint32_t>(std::countr_zero(m)));
    };
    for (open(0); level < levels_;) {
        Open& current = stack[level];
        if (current.mask == 0) {
            ++level;
            continue;
        }
        const uint32_t child = current.first_child + static_cast<uint32_t>(std::countr_zero(current.mask));
        current.mask &= current.mask - 1;
        if (level > 0) {
            --level;
            open(child);
            continue;
        }
        const Block& block = blocks_[child];
        const Float8 d = region.distance_squared(Float8::load(block.x), Float8::load(block.y), Float8::load(block.z));
        uint32_t mask = less_mask(d, limit_of_leaf(child));
        if (mask == 0) continue;
        mask &= accept(child);
        hits.add(d, child * leaf_size, mask, visit);
    }
    hits.flush(visit);
}

template <class Region, class Accept>
void PointTree::find_nearest(const Region& region, float max_distance_squared, const Accept& accept,
                             NearestPoints& result) const
{
    result.begin(max_distance_squared);
    if (size_ == 0) return;
    // A key is the bit pattern of a squared distance (which sorts as the number does) with the child's place in its
    // lowest three bits; masking these rounds the distance down, which is safe for a lower bound.
    struct Open {
        alignas(32) int32_t keys[8];
        uint32_t first_child;
        int next;
    };
    constexpr int32_t place_bits = 7;
    const auto too_far = [&](int32_t key) { return (key & ~place_bits) >= std::bit_cast<int32_t>(result.limit()); };
    Open stack[max_levels];
    int level = levels_ - 1;
    const auto open = [&](uint32_t i) {
        Open& o = stack[level];
        alignas(32) float distances[8];
        node(level, i).distance_squared(region.center).store(distances);
        for (int c = 0; c < 8; ++c) o.keys[c] = (std::bit_cast<int32_t>(distances[c]) & ~place_bits) | c;
        sort8(o.keys);
        o.first_child = i * 8;
        o.next = 0;
        for (int c = 0; c < 8 && !too_far(o.keys[c]); ++c)
            prefetch_child(level, o.first_child + static_cast<uint32_t>(o.keys[c] & place_bits));
    };
    for (open(0); level < levels_;) {
        Open& o = stack[level];
        // The children are sorted: the first one too far ends its node.
        if (o.next == 8 || too_far(o.keys[o.next])) {
            ++level;
            continue;
        }
        const uint32_t child = o.first_child + static_cast<uint32_t>(o.keys[o.next++] & place_bits);
        if (level > 0) {
            --level;
            open(child);
            continue;
        }
        const Block& block = blocks_[child];
        const Float8 d = region.distance_squared(Float8::load(block.x), Float8::load(block.y), Float8::load(block.z));
        uint32_t mask = less_mask(d, Float8::all(result.limit()));
        if (mask == 0) continue;
        mask &= accept(child);
        if (mask != 0) result.add(d, child * leaf_size, mask);
    }
    result.finish();
}

}  // namespace dapple
