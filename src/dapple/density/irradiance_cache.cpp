#include "dapple/density/irradiance_cache.h"

#include <algorithm>
#include <cmath>

namespace dapple {
namespace {

constexpr float normal_tolerance = 1.0f / (1.0f - 0.90630779f);  // 1 / (1 - cos 25 degrees)
constexpr float behind_tolerance = 0.05f;                        // of the radius: surfaces are not quite flat

Vec3 child_center(const Vec3& center, float half, int child)
{
    const float quarter = 0.5f * half;
    return center +
           Vec3(child & 1 ? quarter : -quarter, child & 2 ? quarter : -quarter, child & 4 ? quarter : -quarter);
}

bool overlaps(const Vec3& center, float half, const Vec3& p, float radius)
{
    return max_component(abs(p - center)) < half + radius;
}

}  // namespace

IrradianceCache::IrradianceCache(const Box3& bounds, int sets, float accuracy)
    : center_((bounds.min + bounds.max) * 0.5f),
      half_(std::max(max_component(bounds.max - bounds.min) * 0.5001f, 1e-20f)),
      sets_(sets),
      accuracy_(accuracy)
{
}

void IrradianceCache::settle(Stored& stored) const
{
    const float radius = accuracy_ * stored.record.reach;
    stored.gather = radius < stored.record.min_radius;
    stored.radius = std::clamp(radius, stored.record.min_radius, stored.record.max_radius);
}

void IrradianceCache::add(const CacheRecord& record, const std::vector<HemisphereIrradiance>& values)
{
    Stored added{record, 0.0f, false};
    settle(added);
    visit_near(0, center_, half_, record.position, 2.0f * added.radius, [&](uint32_t other) {
        Stored& neighbor = records_[other];
        const float distance = length(neighbor.record.position - record.position);
        added.record.reach = std::min(added.record.reach, neighbor.record.reach + distance);
        const float most = added.record.reach + distance;
        if (neighbor.record.reach <= most) return;
        neighbor.record.reach = most;
        settle(neighbor);
    });
    settle(added);
    records_.push_back(added);
    values_.insert(values_.end(), values.begin(), values.end());
    insert_below(0, center_, half_, static_cast<uint32_t>(records_.size() - 1), record.position, added.radius);
}

// Into the smallest nodes that are at least as wide as the sphere: it overlaps eight of them at most.
void IrradianceCache::insert_below(uint32_t node, const Vec3& center, float half, uint32_t record, const Vec3& p,
                                   float radius)
{
    if (!overlaps(center, half, p, radius)) return;
    if (half < 2.0f * radius) {
        entries_.push_back({record, nodes_[node].first_entry});
        nodes_[node].first_entry = static_cast<uint32_t>(entries_.size() - 1);
        return;
    }
    for (int child = 0; child < 8; ++child) {
        const Vec3 at = child_center(center, half, child);
        if (!overlaps(at, 0.5f * half, p, radius)) continue;
        const auto slot = static_cast<size_t>(child);
        if (nodes_[node].children[slot] == 0) {
            nodes_.emplace_back();
            nodes_[node].children[slot] = static_cast<uint32_t>(nodes_.size() - 1);
        }
        insert_below(nodes_[node].children[slot], at, 0.5f * half, record, p, radius);
    }
}

template <class Visit>
void IrradianceCache::visit_near(uint32_t node, const Vec3& center, float half, const Vec3& p, float radius,
                                 const Visit& visit)
{
    for (uint32_t e = nodes_[node].first_entry; e != 0; e = entries_[e].next) visit(entries_[e].record);
    for (int child = 0; child < 8; ++child) {
        const uint32_t next = nodes_[node].children[static_cast<size_t>(child)];
        const Vec3 at = child_center(center, half, child);
        if (next != 0 && overlaps(at, 0.5f * half, p, radius)) visit_near(next, at, 0.5f * half, p, radius, visit);
    }
}

float IrradianceCache::weight(size_t record, const Vec3& position, const Vec3& normal) const
{
    const Stored& stored = records_[record];
    const Vec3 offset = position - stored.record.position;
    const float by_distance = length_squared(offset) / (stored.radius * stored.radius);
    if (!(by_distance < 1.0f)) return 0.0f;
    const float by_normal = std::max(0.0f, 1.0f - dot(normal, stored.record.frame.n)) * normal_tolerance;
    const float weight = 1.0f - std::sqrt(std::max(by_distance, by_normal));
    if (!(weight > 0.0f)) return 0.0f;
    // Behind the record is what it may not see.
    if (0.5f * dot(offset, normal + stored.record.frame.n) < -behind_tolerance * stored.radius) return 0.0f;
    return weight;
}

IrradianceCache::Answer IrradianceCache::look_up(const Vec3& position, const Vec3& normal, int set,
                                                 Spectrum& irradiance) const
{
    Spectrum sum;
    float weights = 0.0f;
    bool gather = false;
    uint32_t node = 0;
    Vec3 center = center_;
    float half = half_;
    for (;;) {
        for (uint32_t e = nodes_[node].first_entry; e != 0; e = entries_[e].next) {
            const uint32_t i = entries_[e].record;
            const float w = weight(i, position, normal);
            if (!(w > 0.0f)) continue;
            const Stored& stored = records_[i];
            if (stored.gather) {
                gather = true;
                continue;
            }
            const HemisphereIrradiance& value =
                values_[size_t(i) * static_cast<size_t>(sets_) + static_cast<size_t>(set)];
            const Frame& frame = stored.record.frame;
            const Vec3 moved = position - stored.record.position;
            const Vec3 turned = cross(frame.n, normal);
            const Spectrum here = value.value + value.rotation_x * dot(turned, frame.s) +
                                  value.rotation_y * dot(turned, frame.t) + value.translation_x * dot(moved, frame.s) +
                                  value.translation_y * dot(moved, frame.t);
            sum += here * w;
            weights += w;
        }
        const Vec3 to = position - center;
        const int child = (to.x > 0.0f ? 1 : 0) | (to.y > 0.0f ? 2 : 0) | (to.z > 0.0f ? 4 : 0);
        center = child_center(center, half, child);
        half *= 0.5f;
        node = nodes_[node].children[static_cast<size_t>(child)];
        if (node == 0) break;
    }
    if (!(weights > 0.0f)) return gather ? Answer::gather : Answer::none;
    irradiance = sum * (1.0f / weights);
    for (int lane = 0; lane < Spectrum::lanes; ++lane) irradiance[lane] = std::max(0.0f, irradiance[lane]);
    return Answer::value;
}

size_t IrradianceCache::serving() const
{
    return static_cast<size_t>(
        std::count_if(records_.begin(), records_.end(), [](const Stored& stored) { return !stored.gather; }));
}

size_t IrradianceCache::memory_bytes() const
{
    return records_.size() * sizeof(Stored) + values_.size() * sizeof(HemisphereIrradiance) +
           nodes_.size() * sizeof(Node) + entries_.size() * sizeof(Entry);
}

}  // namespace dapple
