// Point sets that are hard for trees and grids in different ways.
#pragma once

#include "dapple/math/hash.h"
#include "dapple/math/vec.h"

#include <string>
#include <vector>

namespace dapple {

inline float uniform_number(uint64_t a, uint64_t b) { return to_unit_float(hash_words(a, b)); }

struct NamedCloud {
    std::string name;
    std::vector<Vec3> points;
};

inline std::vector<NamedCloud> test_clouds()
{
    std::vector<NamedCloud> clouds;
    const auto add = [&clouds](const std::string& name, size_t count, auto&& point) {
        NamedCloud cloud{name, {}};
        for (size_t i = 0; i < count; ++i) cloud.points.push_back(point(static_cast<uint64_t>(i)));
        clouds.push_back(cloud);
    };
    const auto random = [](uint64_t i) {
        return Vec3(uniform_number(i, 1), uniform_number(i, 2), uniform_number(i, 3));
    };
    add("empty", 0, random);
    add("single", 1, random);
    add("seven", 7, random);
    add("eight", 8, random);
    add("nine", 9, random);
    add("sixty-five", 65, random);
    add("random", 6000, random);
    add("negative and far", 2000, [&](uint64_t i) { return random(i) * 40.0f - Vec3(2000.0f, 20.0f, -3000.0f); });
    add("clustered", 4000, [&](uint64_t i) {
        const Vec3 center = random(i % 7 + 1000000);
        const float size = std::pow(10.0f, -static_cast<float>(i % 5));
        return center + (random(i) - Vec3(0.5f)) * size;
    });
    add("one outlier", 3000, [&](uint64_t i) { return i == 5 ? Vec3(1e7f, -1e7f, 3.0f) : random(i); });
    add("duplicates", 3000, [&](uint64_t i) { return random(i % 11); });
    add("all equal", 500, [&](uint64_t) { return Vec3(0.25f, -1.0f, 3.0f); });
    add("collinear", 3000, [&](uint64_t i) { return Vec3(0.5f, uniform_number(i, 4), -2.0f); });
    add("lattice", 3375, [&](uint64_t i) {
        return Vec3(static_cast<float>(i % 15), static_cast<float>(i / 15 % 15), static_cast<float>(i / 225)) * 0.125f;
    });
    add("planes", 5000, [&](uint64_t i) {
        Vec3 p = random(i);
        p[static_cast<int>(i % 3)] = i % 2 == 0 ? 0.0f : 1.0f;
        return p;
    });
    return clouds;
}

// Places to ask from: some of the points themselves, places among them, and places outside.
inline std::vector<Vec3> test_queries(const std::vector<Vec3>& points)
{
    std::vector<Vec3> queries = {{0, 0, 0}, {0.5f, 0.5f, 0.5f}, {-3.0f, 0.2f, 9.0f}};
    for (size_t i = 0; i < 20 && !points.empty(); ++i) {
        const Vec3& a = points[mix64(i) % points.size()];
        const Vec3& b = points[mix64(i + 100) % points.size()];
        queries.push_back(a);
        queries.push_back(lerp(0.01f, a, b));
        queries.push_back(lerp(0.5f, a, b));
    }
    return queries;
}

// The same arithmetic as the trees', so that comparisons may be exact.
inline float distance_squared_between(const Vec3& a, const Vec3& b)
{
    const float dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
    return dx * dx + dy * dy + dz * dz;
}

}  // namespace dapple
