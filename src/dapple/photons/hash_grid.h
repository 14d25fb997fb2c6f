// A uniform grid of cells, hashed into a table and filled by counting sort, for fixed-radius queries: the cheapest
// structure to build when one radius serves all (progressive passes, merging). Cells are two radii wide, so a query
// meets 2 x 2 x 2 of them; cells that follow each other along x are neighbours in the table, so these are four runs of
// points. The parities of a row's y and z select its quarter of the table: the four rows of one query can never fall
// onto each other, and no point is met twice. Points are copied in table order as three arrays (Teschner et al. 2003
// for the hash; the row layout is ours). Cost: 16 bytes per point and 4 bytes per table entry.
#pragma once

#include "dapple/math/hash.h"
#include "dapple/math/vec.h"
#include "dapple/photons/float8.h"

#include <span>
#include <vector>

namespace dapple {

class HashGrid {
public:
    HashGrid() = default;
    // Sorts `points` (coordinates below 1e18 in magnitude, fewer than 2^32 - 16 points) for queries of radius > 0.
    // Parallel; the result does not depend on threads.
    HashGrid(std::span<const Vec3> points, float radius);

    uint32_t size() const { return size_; }
    float radius() const { return radius_; }
    size_t memory_bytes() const
    {
        return (x_.size() + y_.size() + z_.size()) * sizeof(float) + (index_.size() + begin_.size()) * sizeof(uint32_t);
    }

    // Calls visit(index, distance_squared) for each point nearer to p than radius(); index counts in the points given
    // to the constructor.
    template <class Visitor>
    void for_each_within(const Vec3& p, Visitor&& visit) const;

private:
    // Index of a cell along one axis, wrapping around; far cells that fall together only cost time.
    static uint32_t cell_of(double scaled)
    {
        const double whole = std::floor(scaled);
        return std::fabs(whole) < 0x1p62 ? static_cast<uint32_t>(static_cast<int64_t>(whole)) : 0u;
    }
    // First table entry of the row through cells (., y, z), without x.
    uint32_t row_quarter(uint32_t y, uint32_t z) const { return ((y & 1u) | (z & 1u) << 1) * (row_mask_ + 1); }
    static uint32_t row_hash(uint32_t y, uint32_t z) { return y * 73856093u ^ z * 19349663u; }
    uint32_t entry_of(const Vec3& p) const
    {
        const uint32_t x = cell_of(p.x * cells_per_unit_);
        const uint32_t y = cell_of(p.y * cells_per_unit_);
        const uint32_t z = cell_of(p.z * cells_per_unit_);
        return row_quarter(y, z) + ((x + row_hash(y, z)) & row_mask_);
    }
    template <class Visitor>
    void visit_run(uint32_t begin, uint32_t end, const Vec3& p, HitBuffer& hits, Visitor&& visit) const;

    uint32_t size_ = 0;
    float radius_ = 0.0f;
    double cells_per_unit_ = 0.0;   // double: a point at the edge of the ball must not be missed by rounding
    uint32_t row_mask_ = 0;         // entries of a quarter of the table, less one
    std::vector<uint32_t> begin_;   // first point of each table entry, and the number of points
    std::vector<float> x_, y_, z_;  // in table order, padded for reading eight at a time
    std::vector<uint32_t> index_;
};

template <class Visitor>
void HashGrid::visit_run(uint32_t begin, uint32_t end, const Vec3& p, HitBuffer& hits, Visitor&& visit) const
{
    const Float8 limit = Float8::all(radius_ * radius_);
    for (uint32_t i = begin; i < end; i += 8) {
        const Float8 dx = Float8::load(&x_[i]) - Float8::all(p.x);
        const Float8 dy = Float8::load(&y_[i]) - Float8::all(p.y);
        const Float8 dz = Float8::load(&z_[i]) - Float8::all(p.z);
        const Float8 d = dx * dx + dy * dy + dz * dz;
        uint32_t mask = less_mask(d, limit);
        if (end - i < 8) mask &= (1u << (end - i)) - 1u;
        hits.add(d, &index_[i], mask, visit);
    }
}

template <class Visitor>
void HashGrid::for_each_within(const Vec3& p, Visitor&& visit) const
{
    if (size_ == 0) return;
    // The two cells per axis that the ball can meet: its own and the nearer neighbour.
    const auto lower_cell = [&](float at) { return cell_of(at * cells_per_unit_ - 0.5); };
    const uint32_t x = lower_cell(p.x);
    const uint32_t y = lower_cell(p.y);
    const uint32_t z = lower_cell(p.z);
    uint32_t first[4];
    for (uint32_t row = 0; row < 4; ++row) {
        const uint32_t row_y = y + (row & 1);
        const uint32_t row_z = z + (row >> 1);
        first[row] = row_quarter(row_y, row_z);
        const uint32_t column = (x + row_hash(row_y, row_z)) & row_mask_;
        __builtin_prefetch(&begin_[first[row] + column]);
        first[row] += column;
    }
    HitBuffer hits;
    for (int row = 0; row < 4; ++row) {
        const uint32_t entry = first[row];
        // The last column of a row is followed by its first.
        if ((entry & row_mask_) == row_mask_) {
            visit_run(begin_[entry], begin_[entry + 1], p, hits, visit);
            visit_run(begin_[entry - row_mask_], begin_[entry - row_mask_ + 1], p, hits, visit);
        } else {
            visit_run(begin_[entry], begin_[entry + 2], p, hits, visit);
        }
    }
    hits.flush(visit);
}

}  // namespace dapple
