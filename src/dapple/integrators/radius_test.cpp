#include "dapple/integrators/radius_test.h"

#include "dapple/math/frame.h"

#include <vector>

namespace dapple {
namespace {

constexpr int most_steps = 4;
constexpr float step = 0.70710678f;

struct DiscPoint {
    float x, y, weight;
};

}  // namespace

void UniformityTest::add(float x, float y, float weight)
{
    const float xx = x * x, yy = y * y;
    sums_[0] += weight * 2.0f * x;
    sums_[1] += weight * 2.0f * y;
    sums_[2] += weight * 2.44948974f * (xx - yy);
    sums_[3] += weight * 4.89897949f * x * y;
    sums_[4] += weight * 1.73205081f * (2.0f * (xx + yy) - 1.0f);
    squares_ += weight * weight;
}

float UniformityTest::sum_of_squares() const
{
    float sum = 0.0f;
    for (const float s : sums_) sum += s * s;
    return sum;
}

float tested_radius(std::span<const PhotonMap> maps, size_t own, const SurfaceRegion& region, float radius)
{
    thread_local std::vector<DiscPoint> points;
    points.clear();
    const Frame frame(region.normal);
    const float inv_radius = 1.0f / radius;
    for (size_t i = 0; i < maps.size(); ++i) {
        if (i == own) continue;
        const PhotonMap& map = maps[i];
        map.for_each_on_surface(region, radius, [&](uint32_t slot, float) {
            const Vec3 offset = (map.position(slot) - region.position) * inv_radius;
            points.push_back({dot(offset, frame.s), dot(offset, frame.t),
                              map.flux(slot).average() / static_cast<float>(map.emitted())});
        });
    }
    float part = 1.0f;
    for (int i = 0; i < most_steps; ++i, part *= step) {
        UniformityTest test;
        for (const DiscPoint& p : points)
            if (sqr(p.x) + sqr(p.y) < sqr(part)) test.add(p.x / part, p.y / part, p.weight);
        if (!test.rejects()) break;
    }
    return radius * part;
}

}  // namespace dapple
