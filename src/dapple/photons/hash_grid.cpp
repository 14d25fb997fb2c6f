// Counting sort in two steps, so that threads need no shared counters: chunks of points are scattered stably into up
// to 256 parts of the table, then each part is counted and filled by one task.
#include "dapple/photons/hash_grid.h"

#include "dapple/base/assert.h"
#include "dapple/base/error.h"
#include "dapple/base/parallel.h"

#include <array>
#include <bit>
#include <memory>
#include <utility>

namespace dapple {
namespace {

constexpr size_t chunk_size = size_t{1} << 15;
constexpr int part_bits = 8;

struct Item {
    Vec3 position;
    uint32_t index;
    uint32_t entry;
};

}  // namespace

HashGrid::HashGrid(std::span<const Vec3> points, float radius) : radius_(radius)
{
    DAPPLE_ASSERT(radius > 0.0f);
    const size_t count = points.size();
    if (count >= 0xfffffff0u) throw UserError("a hash grid holds fewer than 2^32 points");
    cells_per_unit_ = 0.5 / (1.000001 * static_cast<double>(radius));
    // About one entry per two to four points: cells of interest hold many, and a small table stays in the caches.
    const uint32_t row_size = std::bit_ceil(std::max(4u, static_cast<uint32_t>(count / 16)));
    row_mask_ = row_size - 1;
    const uint32_t entries = 4 * row_size;
    const int shift = std::max(0, std::countr_zero(entries) - part_bits);
    const size_t parts = entries >> shift;
    const size_t chunks = (count + chunk_size - 1) / chunk_size;

    // Points per chunk and part, then turned into the place of the first one.
    std::vector<std::array<uint32_t, 1 << part_bits>> places(chunks);
    const auto entry_of_point = std::make_unique_for_overwrite<uint32_t[]>(count);
    const auto for_each_chunk = [&](const auto& body) {
        parallel_for_ranges(static_cast<int64_t>(count), static_cast<int64_t>(chunk_size), [&](int64_t b, int64_t e) {
            body(static_cast<size_t>(b) / chunk_size, static_cast<size_t>(b), static_cast<size_t>(e));
        });
    };
    for_each_chunk([&](size_t chunk, size_t begin, size_t end) {
        places[chunk].fill(0);
        for (size_t i = begin; i < end; ++i) {
            entry_of_point[i] = entry_of(points[i]);
            ++places[chunk][entry_of_point[i] >> shift];
        }
    });
    std::vector<uint32_t> part_begin(parts + 1, 0);
    uint32_t total = 0;
    for (size_t part = 0; part < parts; ++part) {
        part_begin[part] = total;
        for (auto& chunk : places) total += std::exchange(chunk[part], total);
    }
    part_begin[parts] = total;

    const auto items = std::make_unique_for_overwrite<Item[]>(count);
    for_each_chunk([&](size_t chunk, size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const uint32_t entry = entry_of_point[i];
            items[places[chunk][entry >> shift]++] = {points[i], static_cast<uint32_t>(i), entry};
        }
    });

    begin_.resize(size_t{entries} + 1);
    size_ = static_cast<uint32_t>(count);
    index_.resize(count + Float8::size);
    for (auto* axis : {&x_, &y_, &z_}) axis->resize(count + Float8::size);
    begin_[entries] = static_cast<uint32_t>(count);
    parallel_for(static_cast<int64_t>(parts), 1, [&](int64_t part) {
        const uint32_t first = part_begin[static_cast<size_t>(part)];
        const uint32_t last = part_begin[static_cast<size_t>(part) + 1];
        const uint32_t first_entry = static_cast<uint32_t>(part) << shift;
        uint32_t* entry_begin = begin_.data() + first_entry;
        const uint32_t part_entries = 1u << shift;
        std::vector<uint32_t> next(part_entries, 0);
        for (uint32_t i = first; i < last; ++i) ++next[items[i].entry - first_entry];
        uint32_t place = first;
        for (uint32_t e = 0; e < part_entries; ++e) {
            entry_begin[e] = place;
            place += std::exchange(next[e], place);
        }
        for (uint32_t i = first; i < last; ++i) {
            const uint32_t to = next[items[i].entry - first_entry]++;
            x_[to] = items[i].position.x;
            y_[to] = items[i].position.y;
            z_[to] = items[i].position.z;
            index_[to] = items[i].index;
        }
    });
}

}  // namespace dapple
