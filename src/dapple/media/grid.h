// Looking up dense grids: trilinear between samples at cell centres (n samples over [0,1] at (i + 1/2) / n), zero
// outside, so that values fade out over half a cell beyond the outermost samples. pbrt-v4 reads its grids alike.
// Cost: eight loads per channel.
#pragma once

#include "dapple/media/medium.h"

#include <array>

namespace dapple {

namespace detail {

// The two samples to either side of a coordinate, and the weight of the second. Indices run from -1 to n.
struct GridAxis {
    int index;
    float weight;

    GridAxis(float coordinate, int n)
    {
        // Bounded before it becomes an integer (in this order also for NaN); beyond the bounds every sample is zero.
        const float s = std::min(std::max(-1.0f, coordinate * static_cast<float>(n) - 0.5f), static_cast<float>(n));
        const float below = std::floor(s);
        index = static_cast<int>(below);
        weight = s - below;
    }
};

}  // namespace detail

// The value at p in the unit cube's coordinates; `Channels` must be grid.channels.
template <int Channels>
std::array<float, Channels> lookup_grid(const Grid& grid, const Vec3& p)
{
    const detail::GridAxis x(p.x, grid.nx), y(p.y, grid.ny), z(p.z, grid.nz);
    std::array<float, Channels> sum{};
    for (int corner = 0; corner < 8; ++corner) {
        const int dx = corner & 1, dy = (corner >> 1) & 1, dz = corner >> 2;
        const int ix = x.index + dx, iy = y.index + dy, iz = z.index + dz;
        if (ix < 0 || ix >= grid.nx || iy < 0 || iy >= grid.ny || iz < 0 || iz >= grid.nz) continue;
        const float weight =
            (dx ? x.weight : 1.0f - x.weight) * (dy ? y.weight : 1.0f - y.weight) * (dz ? z.weight : 1.0f - z.weight);
        const size_t at = ((size_t(iz) * grid.ny + iy) * grid.nx + ix) * Channels;
        for (int c = 0; c < Channels; ++c) sum[c] += weight * grid.values[at + c];
    }
    return sum;
}

// A bound of every channel of the grid over a box in the unit cube's coordinates: the largest sample (never below 0)
// whose trilinear support meets the box.
float grid_maximum(const Grid& grid, const Vec3& lower, const Vec3& upper);

}  // namespace dapple
