// Building the tree. A range is split by a histogram of its widest axis (one pass), a stable three-way scatter around
// the bin that holds the median (one pass, into the other of two buffers) and a selection inside that bin. Work is cut
// by sizes alone, and equal coordinates are ordered by index, so that threads cannot change the result.
#include "dapple/photons/point_tree.h"

#include "dapple/base/error.h"
#include "dapple/base/parallel.h"

#include <memory>

namespace dapple {
namespace {

using Float4 = float __attribute__((vector_size(16)));

struct alignas(16) Item {
    float position[3];
    uint32_t index;
};

struct Bounds {
    Float4 low = {infinity, infinity, infinity, infinity};
    Float4 high = {-infinity, -infinity, -infinity, -infinity};

    // The fourth lane carries the index bits and is never read.
    void add(Float4 p)
    {
        low = p < low ? p : low;
        high = p > high ? p : high;
    }
    void add(const Bounds& b)
    {
        low = b.low < low ? b.low : low;
        high = b.high > high ? b.high : high;
    }
    int widest_axis() const
    {
        const Float4 extent = high - low;
        const int first = extent[1] > extent[0] ? 1 : 0;
        return extent[2] > extent[first] ? 2 : first;
    }
};

Bounds serial_bounds(const Item* items, size_t count)
{
    Bounds even, odd;
    size_t i = 0;
    Float4 a, b;
    for (; i + 2 <= count; i += 2) {
        std::memcpy(&a, items + i, sizeof a);
        std::memcpy(&b, items + i + 1, sizeof b);
        even.add(a);
        odd.add(b);
    }
    if (i < count) {
        std::memcpy(&a, items + i, sizeof a);
        even.add(a);
    }
    even.add(odd);
    return even;
}

constexpr size_t chunk_size = size_t{1} << 16;     // work unit of the loops over one large range
constexpr size_t parallel_size = size_t{1} << 14;  // halves of larger ranges are built by separate tasks

template <class Body>
void for_each_chunk(size_t count, const Body& body)
{
    if (count <= chunk_size) {
        body(size_t{0}, size_t{0}, count);
        return;
    }
    parallel_for_ranges(static_cast<int64_t>(count), static_cast<int64_t>(chunk_size), [&](int64_t begin, int64_t end) {
        body(static_cast<size_t>(begin) / chunk_size, static_cast<size_t>(begin), static_cast<size_t>(end));
    });
}

Bounds bounds_of(const Item* items, size_t count)
{
    if (count <= chunk_size) return serial_bounds(items, count);
    std::vector<Bounds> parts((count + chunk_size - 1) / chunk_size);
    for_each_chunk(count, [&](size_t chunk, size_t begin, size_t end) {
        parts[chunk] = serial_bounds(items + begin, end - begin);
    });
    Bounds all;
    for (const Bounds& part : parts) all.add(part);
    return all;
}

// One axis of a range, cut into equal bins; bin_of is monotone in the coordinate.
struct Axis {
    int axis;
    float low;
    float scale;
    int last_bin;

    Axis(const Bounds& bounds, int axis_, int bins) : axis(axis_), low(bounds.low[axis_]), last_bin(bins - 1)
    {
        const float extent = bounds.high[axis] - low;
        const float s = static_cast<float>(bins) / extent;
        scale = extent > 0.0f && s < infinity && extent < infinity ? s : 0.0f;
    }
    int bin_of(const Item& item) const
    {
        return std::min(static_cast<int>((item.position[axis] - low) * scale), last_bin);
    }
};

// Small ranges: every item counts the items before it, all comparisons in vector lanes and none with a branch.
void split_small(const Item* from, Item* to, size_t count, size_t left, const Bounds& bounds, int axis)
{
    constexpr size_t most = 64;
    DAPPLE_ASSERT(count <= most);
    alignas(32) int32_t keys[most];
    alignas(32) int32_t ranks[most] = {};
    const Axis steps(bounds, axis, 1 << 24);
    for (size_t i = 0; i < most; ++i)
        keys[i] = i < count ? steps.bin_of(from[i]) << 6 | static_cast<int32_t>(i) : INT32_MAX;
    const size_t padded = (count + 7) / 8 * 8;
    for (size_t j = 0; j < count; ++j)
        for (size_t i = 0; i < padded; ++i) ranks[i] += keys[j] < keys[i] ? 1 : 0;
    size_t next[2] = {left, 0};
    for (size_t i = 0; i < count; ++i) to[next[ranks[i] < static_cast<int32_t>(left)]++] = from[i];
}

// Large ranges, see the head comment.
void split_large(const Item* from, Item* to, size_t count, size_t left, const Bounds& bounds, int axis_index)
{
    constexpr int most_bins = 1024;
    const int bins = static_cast<int>(std::clamp<size_t>(count / 8, 16, most_bins));
    const Axis axis(bounds, axis_index, bins);
    const size_t chunks = (count + chunk_size - 1) / chunk_size;
    uint32_t small_histogram[most_bins];
    std::vector<uint32_t> many_histograms(chunks > 1 ? chunks * static_cast<size_t>(bins) : 0);
    uint32_t* histograms = chunks > 1 ? many_histograms.data() : small_histogram;
    for_each_chunk(count, [&](size_t chunk, size_t begin, size_t end) {
        uint32_t* histogram = histograms + chunk * static_cast<size_t>(bins);
        std::fill_n(histogram, bins, 0u);
        for (size_t i = begin; i < end; ++i) ++histogram[axis.bin_of(from[i])];
    });

    // The bin of the median, and how many items lie below it and in it, in all and per chunk.
    const auto in_bin = [&](size_t chunk, int bin) {
        return size_t{histograms[chunk * static_cast<size_t>(bins) + static_cast<size_t>(bin)]};
    };
    size_t below = 0;
    size_t inside = 0;
    int target = -1;
    while (below + inside < left) {
        below += inside;
        inside = 0;
        ++target;
        for (size_t chunk = 0; chunk < chunks; ++chunk) inside += in_bin(chunk, target);
    }
    struct Places {
        size_t below, inside, above;
    };
    std::vector<Places> starts;
    Places start{0, below, below + inside};
    if (chunks > 1) {
        for (size_t chunk = 0; chunk < chunks; ++chunk) {
            starts.push_back(start);
            const size_t chunk_items = std::min(count, (chunk + 1) * chunk_size) - chunk * chunk_size;
            size_t chunk_below = 0;
            for (int bin = 0; bin < target; ++bin) chunk_below += in_bin(chunk, bin);
            const size_t chunk_inside = in_bin(chunk, target);
            start.below += chunk_below;
            start.inside += chunk_inside;
            start.above += chunk_items - chunk_below - chunk_inside;
        }
    }
    for_each_chunk(count, [&](size_t chunk, size_t begin, size_t end) {
        Places next = chunks > 1 ? starts[chunk] : start;
        for (size_t i = begin; i < end; ++i) {
            const int bin = axis.bin_of(from[i]);
            if (bin == target) {
                to[next.inside++] = from[i];
                continue;
            }
            const bool is_below = bin < target;
            to[is_below ? next.below : next.above] = from[i];
            next.below += is_below;
            next.above += !is_below;
        }
    });
    std::nth_element(to + below, to + left, to + below + inside, [axis_index](const Item& a, const Item& b) {
        const float x = a.position[axis_index];
        const float y = b.position[axis_index];
        return x < y || (x == y && a.index < b.index);
    });
}

}  // namespace

class PointTreeBuilder {
public:
    PointTreeBuilder(PointTree& tree, std::span<const Vec3> points, std::vector<uint32_t>& order)
        : tree_(tree), order_(order)
    {
        const size_t count = points.size();
        for (auto& items : items_) items = std::make_unique_for_overwrite<Item[]>(count);
        parallel_for(static_cast<int64_t>(count), int64_t{chunk_size}, [&](int64_t i) {
            const Vec3& p = points[static_cast<size_t>(i)];
            items_[0][static_cast<size_t>(i)] = {{p.x, p.y, p.z}, static_cast<uint32_t>(i)};
        });
        split(0, 0, count, tree_.levels_ - 1, 0, children_of(count, tree_.levels_ - 1));
    }

private:
    // Points below one full child of a node on `level`.
    static size_t child_capacity(int level) { return size_t{PointTree::leaf_size} << (3 * level); }
    static uint32_t children_of(size_t count, int level)
    {
        return static_cast<uint32_t>((count + child_capacity(level) - 1) / child_capacity(level));
    }

    // Distributes the points [begin, end), now in buffer `from`, over `children` successive children of a node.
    void split(int from, size_t begin, size_t end, int level, uint32_t first_child, uint32_t children)
    {
        const size_t count = end - begin;
        const Item* items = items_[from].get() + begin;
        const Bounds bounds = bounds_of(items, count);
        while (children == 1) {
            store_box(level, first_child, bounds);
            if (level == 0) return store_leaf(first_child, items, count);
            --level;
            first_child *= 8;
            children = children_of(count, level);
        }
        const uint32_t left_children = (children + 1) / 2;
        const size_t left = left_children * child_capacity(level);
        Item* to = items_[1 - from].get() + begin;
        const int axis = bounds.widest_axis();
        if (count <= 64)
            split_small(items, to, count, left, bounds, axis);
        else
            split_large(items, to, count, left, bounds, axis);
        const auto low = [&] { split(1 - from, begin, begin + left, level, first_child, left_children); };
        const auto high = [&] {
            split(1 - from, begin + left, end, level, first_child + left_children, children - left_children);
        };
        if (count > parallel_size) return parallel_invoke(low, high);
        low();
        high();
    }

    void store_box(int level, uint32_t child, const Bounds& bounds)
    {
        PointTree::Node& node = tree_.nodes_[tree_.level_begin_[static_cast<size_t>(level)] + child / 8];
        for (int axis = 0; axis < 3; ++axis) {
            node.low[axis][child % 8] = bounds.low[axis];
            node.high[axis][child % 8] = bounds.high[axis];
        }
    }

    // Places without a point are infinitely far away.
    void store_leaf(uint32_t leaf, const Item* items, size_t count)
    {
        PointTree::Block& block = tree_.blocks_[leaf];
        for (size_t i = 0; i < PointTree::leaf_size; ++i) {
            const bool used = i < count;
            block.x[i] = used ? items[i].position[0] : infinity;
            block.y[i] = used ? items[i].position[1] : infinity;
            block.z[i] = used ? items[i].position[2] : infinity;
            if (used) order_[size_t{leaf} * PointTree::leaf_size + i] = items[i].index;
        }
    }

    PointTree& tree_;
    std::vector<uint32_t>& order_;
    std::unique_ptr<Item[]> items_[2];
};

PointTree::PointTree(std::span<const Vec3> points, std::vector<uint32_t>& order)
{
    if (points.size() >= 0xfffffff0u) throw UserError("a point tree holds fewer than 2^32 points");
    size_ = static_cast<uint32_t>(points.size());
    order.resize(points.size());
    if (size_ == 0) return;
    uint32_t nodes = (size_ + leaf_size - 1) / leaf_size;
    blocks_.resize(nodes);
    do {
        nodes = (nodes + 7) / 8;
        level_begin_[static_cast<size_t>(levels_) + 1] = level_begin_[static_cast<size_t>(levels_)] + nodes;
        ++levels_;
    } while (nodes > 1);
    Node absent;
    std::fill_n(&absent.low[0][0], 24, infinity);
    std::fill_n(&absent.high[0][0], 24, -infinity);
    nodes_.assign(level_begin_[static_cast<size_t>(levels_)], absent);
    PointTreeBuilder(*this, points, order);
}

PointLimits PointTree::limits(std::vector<float> distances_squared) const
{
    DAPPLE_ASSERT(distances_squared.size() == size_);
    PointLimits limits;
    limits.slots_ = std::move(distances_squared);
    limits.slots_.resize(blocks_.size() * leaf_size, 0.0f);
    limits.nodes_.resize(nodes_.size());
    const auto largest = [](const float* first) { return *std::max_element(first, first + leaf_size); };
    for (int level = 0; level < levels_; ++level) {
        const auto children = static_cast<uint32_t>(level == 0 ? blocks_.size()
                                                               : level_begin_[static_cast<size_t>(level)] -
                                                                     level_begin_[static_cast<size_t>(level) - 1]);
        for (uint32_t child = 0; child < children; ++child)
            limits.nodes_[node_index(level, child / 8)][child % 8] =
                largest(level == 0 ? &limits.slots_[size_t{child} * leaf_size]
                                   : limits.nodes_[node_index(level - 1, child)].data());
    }
    return limits;
}

Box3 PointTree::bounds() const
{
    Box3 box;
    if (size_ == 0) return box;
    const Node& root = node(levels_ - 1, 0);
    for (int child = 0; child < 8; ++child) {
        if (root.low[0][child] > root.high[0][child]) continue;
        box.extendBy({root.low[0][child], root.low[1][child], root.low[2][child]});
        box.extendBy({root.high[0][child], root.high[1][child], root.high[2][child]});
    }
    return box;
}

}  // namespace dapple
