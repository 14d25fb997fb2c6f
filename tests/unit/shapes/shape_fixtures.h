// Primitives of every kind in awkward poses, and deterministic random numbers, shared by the tests of this room.
#pragma once

#include "dapple/math/hash.h"
#include "dapple/shapes/primitive.h"

#include <string>
#include <vector>

namespace dapple {

inline float random_float(uint64_t i, uint64_t dimension) { return to_unit_float(hash_words(23, i, dimension)); }
inline Vec2 random_2d(uint64_t i, uint64_t dimension)
{
    return {random_float(i, dimension), random_float(i, dimension + 1000)};
}
inline Vec3 random_in_cube(uint64_t i, uint64_t dimension)
{
    return {2 * random_float(i, dimension) - 1, 2 * random_float(i, dimension + 1000) - 1,
            2 * random_float(i, dimension + 2000) - 1};
}
inline Vec3 random_direction(uint64_t i, uint64_t dimension)
{
    const float z = 2 * random_float(i, dimension) - 1;
    return spherical_direction(safe_sqrt(1 - z * z), z, 2 * pi * random_float(i, dimension + 1000));
}

struct NamedPrimitive {
    std::string name;
    Primitive primitive;
};

inline std::vector<NamedPrimitive> all_primitives()
{
    using Kind = Primitive::Kind;
    std::vector<NamedPrimitive> list;
    const Matrix4 turn = translation({0.3f, -0.2f, 0.5f}) * rotation(50.0f, {1.0f, 0.4f, -0.3f});
    const Matrix4 even = turn * scaling(Vec3(0.7f));
    const Matrix4 uneven = turn * scaling({0.5f, 1.3f, 0.8f});
    const Matrix4 mirrored = turn * scaling({-0.9f, 0.9f, 0.9f});

    const auto quadric = [&](const std::string& name, Kind kind, const Matrix4& matrix, float phi_max = 2.0f * pi,
                             float z_min = -1.0f, float z_max = 1.0f, float inner = 0.0f) {
        Primitive p;
        p.kind = kind;
        p.world_from_object = Transform(matrix);
        p.flip = p.world_from_object.swaps_handedness();
        p.radius = 1.2f;
        p.z_min = kind == Kind::sphere ? 1.2f * z_min : z_min;
        p.z_max = kind == Kind::sphere ? 1.2f * z_max : z_max;
        p.phi_max = phi_max;
        p.inner_radius = inner;
        p.height = kind == Kind::disk ? 0.4f : 0.0f;
        list.push_back({name, p});
    };
    quadric("sphere", Kind::sphere, even);
    quadric("mirrored sphere", Kind::sphere, mirrored);
    quadric("ellipsoid", Kind::sphere, uneven);
    quadric("partial sphere", Kind::sphere, even, 4.0f, -0.5f, 0.8f);
    quadric("partial ellipsoid", Kind::sphere, uneven, 5.0f, -0.9f, 0.3f);
    quadric("cylinder", Kind::cylinder, even);
    quadric("partial cylinder", Kind::cylinder, mirrored, 2.0f, -0.3f, 0.9f);
    quadric("uneven cylinder", Kind::cylinder, uneven, 5.5f, -1.0f, 0.2f);
    quadric("disk", Kind::disk, even);
    quadric("partial ring", Kind::disk, uneven, 4.5f, -1.0f, 1.0f, 0.5f);

    const auto corners = [&](const std::string& name, Kind kind, const std::vector<Vec3>& points) {
        Primitive p;
        p.kind = kind;
        for (size_t i = 0; i < points.size(); ++i) p.p[i] = Transform(turn).point(points[i]);
        list.push_back({name, p});
    };
    corners("triangle", Kind::triangle, {{-1, -0.5f, 0.2f}, {1.1f, -0.3f, 0.1f}, {0.2f, 0.9f, -0.3f}});
    corners("rectangle", Kind::bilinear, {{-1, -0.5f, 0}, {1, -0.5f, 0}, {-1, 0.5f, 0}, {1, 0.5f, 0}});
    corners("flat quad", Kind::bilinear, {{-1, -0.5f, 0}, {0.8f, -0.7f, 0}, {-0.6f, 0.5f, 0}, {1.4f, 1.2f, 0}});
    corners("twisted patch", Kind::bilinear,
            {{-1, -0.8f, 0.4f}, {1, -0.9f, -0.5f}, {-0.7f, 0.8f, -0.4f}, {1.1f, 0.9f, 0.6f}});
    return list;
}

// Barycentrics for triangles, the parameter itself for the others.
inline PrimitiveHit hit_at(const Primitive& primitive, const Vec2& uv)
{
    PrimitiveHit hit;
    hit.uv = primitive.kind == Primitive::Kind::triangle ? Vec2(uv.x * (1 - uv.y), uv.x * uv.y) : uv;
    return hit;
}

}  // namespace dapple
