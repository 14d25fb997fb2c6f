// Loop subdivision: counts, limit positions and normals that do not depend on the level, smoothness, boundaries,
// errors.
#include "dapple/shapes/loop_subdivision.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

namespace dapple {
namespace {

struct Control {
    std::vector<Vec3> positions;
    std::vector<uint32_t> indices;
};

Control cube()
{
    Control c;
    for (int i = 0; i < 8; ++i)
        c.positions.push_back({i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f});
    const uint32_t quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& q : quads) c.indices.insert(c.indices.end(), {q[0], q[1], q[2], q[0], q[2], q[3]});
    return c;
}

Control icosahedron()
{
    const float g = 0.5f * (1.0f + std::sqrt(5.0f));
    Control c;
    c.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    c.indices = {0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5, 11, 4,  11, 10, 2,  10, 7, 6, 7, 1, 8,
                 3, 9,  4, 3, 4, 2, 3, 2, 6, 3, 6, 8,  3, 8,  9,  4, 9, 5, 2, 4,  11, 6,  2,  10, 8,  6, 7, 9, 8, 1};
    return c;
}

// A bent n x n grid with boundary.
Control sheet(int n)
{
    Control c;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
            const float x = static_cast<float>(i), y = static_cast<float>(j);
            c.positions.push_back({x, y, 0.3f * std::sin(1.3f * x) * std::cos(0.9f * y)});
        }
    const auto at = [&](int i, int j) { return static_cast<uint32_t>(j * (n + 1) + i); };
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
            c.indices.insert(c.indices.end(),
                             {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    return c;
}

SubdividedMesh subdivide(const Control& c, int levels) { return loop_subdivide(c.positions, c.indices, levels, {}); }

TEST(LoopSubdivision, CountsAndEulerCharacteristic)
{
    const Control c = cube();
    for (int level = 0; level < 4; ++level) {
        const SubdividedMesh mesh = subdivide(c, level);
        const size_t triangles = 12u << (2 * level);
        EXPECT_EQ(mesh.indices.size(), 3 * triangles);
        EXPECT_EQ(mesh.positions.size(), triangles / 2 + 2);  // V - E + F = 2 with E = 3 F / 2
        EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
    }
}

TEST(LoopSubdivision, LimitsOfControlVerticesDoNotDependOnTheLevel)
{
    for (const Control& c : {cube(), icosahedron(), sheet(4)}) {
        const SubdividedMesh coarse = subdivide(c, 0);
        for (int level : {1, 3}) {
            const SubdividedMesh fine = subdivide(c, level);
            for (size_t i = 0; i < c.positions.size(); ++i) {
                EXPECT_LT(length(coarse.positions[i] - fine.positions[i]), 2e-6f * (1.0f + length(c.positions[i])));
                EXPECT_LT(length(coarse.normals[i] - fine.normals[i]), 1e-4f) << i;
            }
        }
    }
}

TEST(LoopSubdivision, NormalsBelongToTheSurface)
{
    for (const Control& c : {cube(), icosahedron(), sheet(4)}) {
        const SubdividedMesh mesh = subdivide(c, 5);
        double worst = 1.0;
        for (size_t t = 0; t < mesh.indices.size(); t += 3) {
            const Vec3 p[3] = {mesh.positions[mesh.indices[t]], mesh.positions[mesh.indices[t + 1]],
                               mesh.positions[mesh.indices[t + 2]]};
            const Vec3 n = normalize(cross(p[1] - p[0], p[2] - p[0]));
            for (int k = 0; k < 3; ++k)
                worst = std::min(worst, static_cast<double>(dot(n, mesh.normals[mesh.indices[t + k]])));
        }
        EXPECT_GT(worst, 0.98);
    }
}

TEST(LoopSubdivision, AnIcosahedronBecomesNearlyASphere)
{
    const SubdividedMesh mesh = subdivide(icosahedron(), 4);
    float smallest = infinity, largest = 0.0f;
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
        const float radius = length(mesh.positions[i]);
        smallest = std::min(smallest, radius);
        largest = std::max(largest, radius);
        EXPECT_GT(dot(mesh.normals[i], mesh.positions[i]) / radius, 0.99f);
    }
    EXPECT_LT(largest / smallest, 1.05f);
    EXPECT_LT(largest, std::sqrt(1.0f + 1.618034f * 1.618034f));  // inside the hull
}

TEST(LoopSubdivision, BoundariesAreCurvesOfTheirOwn)
{
    // Raising the middle of the sheet must not move its rim, and the rim follows the cubic B-spline: a straight line of
    // equally spaced points is kept.
    Control c = sheet(4);
    for (Vec3& p : c.positions) p.z = 0.0f;
    Control raised = c;
    raised.positions[12].z = 1.0f;
    const SubdividedMesh a = subdivide(c, 3), b = subdivide(raised, 3);
    std::map<std::pair<uint32_t, uint32_t>, int> uses;
    for (size_t t = 0; t < a.indices.size(); ++t) {
        const uint32_t i = a.indices[t], j = a.indices[t % 3 == 2 ? t - 2 : t + 1];
        ++uses[{std::min(i, j), std::max(i, j)}];
    }
    int rim = 0;
    for (const auto& [edge, count] : uses) {
        if (count != 1) continue;
        ++rim;
        EXPECT_EQ(a.positions[edge.first], b.positions[edge.first]);
    }
    EXPECT_EQ(rim, 16 * 8);
    EXPECT_LT(length(a.positions[2] - Vec3(2, 0, 0)), 1e-6f);
    for (const Vec3& n : a.normals) EXPECT_LT(length(n - Vec3(0, 0, 1)), 1e-5f);
}

std::string message_of(const Control& c, int levels = 1)
{
    try {
        loop_subdivide(c.positions, c.indices, levels, SourceLocation{"scene.pbrt", 3, 4});
    } catch (const UserError& error) {
        return error.what();
    }
    return "";
}

TEST(LoopSubdivision, BadMeshesAreUserErrors)
{
    EXPECT_EQ(message_of(cube()), "");
    Control c = cube();
    c.indices.pop_back();
    EXPECT_NE(message_of(c).find("scene.pbrt:3:4"), std::string::npos);
    EXPECT_NE(message_of(c).find("three indices"), std::string::npos);
    c = cube();
    c.indices[5] = 8;
    EXPECT_NE(message_of(c).find("does not exist"), std::string::npos);
    c = cube();
    c.indices[1] = c.indices[0];
    EXPECT_NE(message_of(c).find("twice"), std::string::npos);
    c = cube();
    std::swap(c.indices[0], c.indices[1]);  // one triangle the other way round
    EXPECT_NE(message_of(c).find("do not form a surface"), std::string::npos);
    c = cube();
    c.positions.push_back({3, 3, 3});
    c.indices.insert(c.indices.end(), {0, 4, 8});  // a third triangle at an edge
    EXPECT_NE(message_of(c).find("do not form a surface"), std::string::npos);
    c = Control{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {0, 1, 2, 0, 3, 4}};  // touching in a point
    EXPECT_NE(message_of(c).find("do not form a surface"), std::string::npos);
    EXPECT_NE(message_of(cube(), 40).find("out of range"), std::string::npos);
    EXPECT_NE(message_of(cube(), -1).find("out of range"), std::string::npos);
    // An unused vertex is no error.
    c = cube();
    c.positions.push_back({3, 3, 3});
    EXPECT_EQ(message_of(c), "");
}

}  // namespace
}  // namespace dapple
