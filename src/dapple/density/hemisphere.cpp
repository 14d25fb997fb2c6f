#include "dapple/density/hemisphere.h"

#include <algorithm>
#include <cmath>

namespace dapple {

HemisphereStrata HemisphereStrata::of(int rays)
{
    HemisphereStrata strata;
    strata.rings = std::max(2, static_cast<int>(std::sqrt(static_cast<float>(rays) * inv_pi)));
    strata.sectors = std::max(6, rays / strata.rings);
    return strata;
}

Vec3 HemisphereStrata::direction(int ring, int sector, const Vec2& u) const
{
    const float sin_squared = (static_cast<float>(ring) + u.x) / static_cast<float>(rings);
    const float phi = 2.0f * pi * (static_cast<float>(sector) + u.y) / static_cast<float>(sectors);
    const float sine = std::sqrt(sin_squared);
    return {sine * std::cos(phi), sine * std::sin(phi), std::sqrt(std::max(1.0f - sin_squared, 1e-12f))};
}

HemisphereIrradiance integrate_hemisphere(const HemisphereStrata& strata, std::span<const Spectrum> radiance,
                                          std::span<const float> distance, std::span<const float> u_ring)
{
    HemisphereIrradiance result;
    const int rings = strata.rings, sectors = strata.sectors;
    const auto at = [&](int ring, int sector) { return static_cast<size_t>(strata.index(ring, sector)); };
    const auto boundary_sin = [&](int ring) { return std::sqrt(static_cast<float>(ring) / static_cast<float>(rings)); };
    // 1 / r of the nearer of two neighbours: it is its edge that moves.
    const auto nearness = [&](size_t a, size_t b) { return 1.0f / std::min(distance[a], distance[b]); };
    for (int k = 0; k < sectors; ++k) {
        const float step = 2.0f * pi / static_cast<float>(sectors);
        const float middle = step * (static_cast<float>(k) + 0.5f), first = step * static_cast<float>(k);
        Spectrum turning, rising, crossing;
        for (int j = 0; j < rings; ++j) {
            const size_t here = at(j, k), before = at(j, (k + sectors - 1) % sectors);
            result.value += radiance[here];
            const float sin_squared = (static_cast<float>(j) + u_ring[here]) / static_cast<float>(rings);
            // The tangent of a ray along the horizon is bounded by that of its stratum's last percent.
            const float limit = 1.0f - 0.01f / static_cast<float>(rings);
            const float bounded = std::min(sin_squared, limit);
            turning += radiance[here] * std::sqrt(bounded / (1.0f - bounded));
            const float lower = boundary_sin(j), upper = boundary_sin(j + 1);
            if (j > 0) {
                const size_t below = at(j - 1, k);
                rising += (radiance[here] - radiance[below]) * (lower * (1.0f - lower * lower) * nearness(here, below));
            }
            crossing += (radiance[here] - radiance[before]) * ((upper - lower) * nearness(here, before));
        }
        const float cos_middle = std::cos(middle), sin_middle = std::sin(middle);
        result.rotation_x += turning * -sin_middle;
        result.rotation_y += turning * cos_middle;
        result.translation_x += rising * (step * cos_middle) + crossing * -std::sin(first);
        result.translation_y += rising * (step * sin_middle) + crossing * std::cos(first);
    }
    const float scale = pi / static_cast<float>(strata.count());
    result.value *= scale;
    result.rotation_x *= scale;
    result.rotation_y *= scale;
    return result;
}

float harmonic_mean(std::span<const float> distance)
{
    float sum = 0.0f;
    for (float d : distance) sum += 1.0f / d;
    return sum > 0.0f ? static_cast<float>(distance.size()) / sum : infinity;
}

}  // namespace dapple
