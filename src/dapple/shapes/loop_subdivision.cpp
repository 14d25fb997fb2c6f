// Loop 1987, "Smooth subdivision surfaces based on triangles", with Warren's vertex weights (3/16 for three neighbours,
// 3/(8 n) else, as pbrt has them) and the boundary rules of Hoppe et al. 1994, "Piecewise smooth surface
// reconstruction": the boundary is a cubic B-spline curve of its own vertices. Limit positions: the weight
// 1 / (n + 3 / (8 beta)) per neighbour inside, and (1/6, 2/3, 1/6) on the boundary, which is the limit of this B-spline
// (pbrt uses 1/5, 3/5, 1/5, which moves between levels). Limit tangents by the masks of the same paper.
//
// Edges are found by sorting, so the result depends on nothing but the input. O(t log t) time for t final triangles.
#include "dapple/shapes/loop_subdivision.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace dapple {
namespace {

constexpr uint32_t none = 0xffffffffu;

struct Edge {
    uint32_t ends[2];      // ascending
    uint32_t opposite[2];  // the third vertices of its triangles; the second is none on the boundary
    bool boundary() const { return opposite[1] == none; }
};

struct EdgeTable {
    std::vector<Edge> edges;
    std::vector<uint32_t> of_corner;  // edge from corner c of a triangle to the next corner, by index position
};

uint32_t next_corner(uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

// The edges of an oriented manifold.
EdgeTable find_edges(const std::vector<uint32_t>& indices)
{
    struct HalfEdge {
        uint32_t low, high, corner;
    };
    std::vector<HalfEdge> half_edges(indices.size());
    for (uint32_t corner = 0; corner < indices.size(); ++corner) {
        const uint32_t a = indices[corner];
        const uint32_t b = indices[next_corner(corner)];
        half_edges[corner] = {std::min(a, b), std::max(a, b), corner};
    }
    std::sort(half_edges.begin(), half_edges.end(), [](const HalfEdge& x, const HalfEdge& y) {
        return std::array{x.low, x.high, x.corner} < std::array{y.low, y.high, y.corner};
    });
    EdgeTable table;
    table.of_corner.resize(indices.size());
    for (const HalfEdge& half : half_edges) {
        const uint32_t opposite = indices[next_corner(next_corner(half.corner))];
        const bool seen =
            !table.edges.empty() && table.edges.back().ends[0] == half.low && table.edges.back().ends[1] == half.high;
        if (seen)
            table.edges.back().opposite[1] = opposite;
        else
            table.edges.push_back({{half.low, half.high}, {opposite, none}});
        table.of_corner[half.corner] = static_cast<uint32_t>(table.edges.size() - 1);
    }
    return table;
}

float neighbour_weight(uint32_t valence)
{
    return valence == 3 ? 3.0f / 16.0f : 3.0f / (8.0f * static_cast<float>(valence));
}

// What a vertex sees of its neighbours, gathered over edges.
struct Neighbourhood {
    Vec3 sum{0, 0, 0};           // all neighbours
    Vec3 boundary_sum{0, 0, 0};  // the neighbours along the boundary
    uint32_t valence = 0;
    bool boundary = false;
};

std::vector<Neighbourhood> gather(const std::vector<Vec3>& positions, const EdgeTable& table)
{
    std::vector<Neighbourhood> result(positions.size());
    for (const Edge& edge : table.edges) {
        for (int end = 0; end < 2; ++end) {
            Neighbourhood& here = result[edge.ends[end]];
            const Vec3& other = positions[edge.ends[1 - end]];
            here.sum += other;
            ++here.valence;
            if (!edge.boundary()) continue;
            here.boundary = true;
            here.boundary_sum += other;
        }
    }
    return result;
}

void refine(std::vector<Vec3>& positions, std::vector<uint32_t>& indices)
{
    const EdgeTable table = find_edges(indices);
    const std::vector<Neighbourhood> around = gather(positions, table);
    const uint32_t first_new = static_cast<uint32_t>(positions.size());
    std::vector<Vec3> refined = positions;
    for (size_t i = 0; i < positions.size(); ++i) {
        const Neighbourhood& here = around[i];
        if (here.valence == 0) continue;
        if (here.boundary) {
            refined[i] = positions[i] * 0.75f + here.boundary_sum * 0.125f;
        } else {
            const float beta = neighbour_weight(here.valence);
            refined[i] = positions[i] * (1.0f - static_cast<float>(here.valence) * beta) + here.sum * beta;
        }
    }
    refined.reserve(positions.size() + table.edges.size());
    for (const Edge& edge : table.edges) {
        const Vec3 ends = positions[edge.ends[0]] + positions[edge.ends[1]];
        if (edge.boundary())
            refined.push_back(ends * 0.5f);
        else
            refined.push_back(ends * 0.375f + (positions[edge.opposite[0]] + positions[edge.opposite[1]]) * 0.125f);
    }
    std::vector<uint32_t> split;
    split.reserve(indices.size() * 4);
    for (uint32_t corner = 0; corner < indices.size(); corner += 3) {
        const uint32_t a = indices[corner], b = indices[corner + 1], c = indices[corner + 2];
        const uint32_t ab = first_new + table.of_corner[corner];
        const uint32_t bc = first_new + table.of_corner[corner + 1];
        const uint32_t ca = first_new + table.of_corner[corner + 2];
        split.insert(split.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
    }
    positions = std::move(refined);
    indices = std::move(split);
}

// The neighbours of every vertex in counterclockwise order. As a chain of "from -> to" steps, one per triangle at the
// vertex, it closes inside the surface and runs from one boundary neighbour to the other on the boundary.
class Rings {
public:
    Rings(size_t vertex_count, const std::vector<uint32_t>& indices) : first_(vertex_count + 1, 0)
    {
        for (uint32_t index : indices) ++first_[index + 1];
        for (size_t i = 0; i < vertex_count; ++i) first_[i + 1] += first_[i];
        steps_.resize(indices.size());
        std::vector<uint32_t> filled(first_.begin(), first_.end() - 1);
        for (uint32_t corner = 0; corner < indices.size(); ++corner) {
            const uint32_t next = next_corner(corner);
            steps_[filled[indices[corner]]++] = {indices[next], indices[next_corner(next)]};
        }
    }

    // Fills `ring` and tells whether it closes. False in `manifold` when the triangles form no single chain.
    bool ordered(uint32_t vertex, std::vector<uint32_t>& ring, bool& manifold) const
    {
        const std::span<const Step> steps(steps_.data() + first_[vertex], first_[vertex + 1] - first_[vertex]);
        ring.clear();
        manifold = true;
        if (steps.empty()) return false;
        // A boundary chain starts at the neighbour that no step leads to; there may be one at most.
        uint32_t start = none;
        for (const Step& step : steps) {
            for (const Step& other : steps)
                if (&other != &step && (other.from == step.from || other.to == step.to)) manifold = false;
            const bool reached =
                std::any_of(steps.begin(), steps.end(), [&](const Step& other) { return other.to == step.from; });
            if (reached) continue;
            if (start != none) manifold = false;
            start = step.from;
        }
        const bool closed = start == none;
        if (closed) start = steps[0].from;
        uint32_t current = start;
        for (size_t i = 0; i < steps.size(); ++i) {
            ring.push_back(current);
            const auto step =
                std::find_if(steps.begin(), steps.end(), [&](const Step& other) { return other.from == current; });
            if (step == steps.end()) {
                manifold = false;
                return closed;
            }
            current = step->to;
            if (closed && current == start && i + 1 < steps.size()) manifold = false;
        }
        if (!closed) ring.push_back(current);
        return closed;
    }

private:
    struct Step {
        uint32_t from, to;
    };
    std::vector<uint32_t> first_;
    std::vector<Step> steps_;
};

// The limit normal (not normalised): the cross product of two limit tangents, the first and second harmonics of the
// ring inside; along and across the boundary on it.
Vec3 limit_normal(const std::vector<Vec3>& positions, uint32_t vertex, const std::vector<uint32_t>& ring, bool closed)
{
    const Vec3& p = positions[vertex];
    Vec3 s(0, 0, 0), t(0, 0, 0);
    const size_t n = ring.size();
    if (closed) {
        for (size_t i = 0; i < n; ++i) {
            const float angle = 2.0f * pi * static_cast<float>(i) / static_cast<float>(n);
            s += positions[ring[i]] * std::cos(angle);
            t += positions[ring[i]] * std::sin(angle);
        }
        return cross(s, t);
    }
    const Vec3& first = positions[ring.front()];
    const Vec3& last = positions[ring.back()];
    s = first - last;
    if (n == 2) {
        t = first + last - p * 2.0f;
    } else if (n == 3) {
        t = positions[ring[1]] - p;
    } else if (n == 4) {
        t = (positions[ring[1]] + positions[ring[2]]) * 2.0f - first - last - p * 2.0f;
    } else {
        const float angle = pi / static_cast<float>(n - 1);
        t = (first + last) * -std::sin(angle);
        for (size_t i = 1; i + 1 < n; ++i)
            t += positions[ring[i]] * ((2.0f - 2.0f * std::cos(angle)) * std::sin(static_cast<float>(i) * angle));
    }
    return cross(s, t);
}

void check_mesh(size_t vertex_count, const std::vector<uint32_t>& indices, int levels, const SourceLocation& where)
{
    if (indices.empty() || indices.size() % 3 != 0)
        throw UserError(
            where, fmt::format("loop subdivision needs three indices per triangle, but there are {}", indices.size()));
    constexpr double most_triangles = 268435456.0;
    if (levels < 0 || std::ldexp(static_cast<double>(indices.size() / 3), 2 * std::min(levels, 100)) > most_triangles)
        throw UserError(where, fmt::format("loop subdivision of {} triangles by {} levels is out of range",
                                           indices.size() / 3, levels));
    for (size_t i = 0; i < indices.size(); ++i)
        if (indices[i] >= vertex_count)
            throw UserError(where,
                            fmt::format("loop subdivision: vertex {} of triangle {} does not exist (there are {})",
                                        indices[i], i / 3, vertex_count));
    for (size_t i = 0; i < indices.size(); i += 3)
        if (indices[i] == indices[i + 1] || indices[i + 1] == indices[i + 2] || indices[i + 2] == indices[i])
            throw UserError(where, fmt::format("loop subdivision: triangle {} uses a vertex twice", i / 3));
    const Rings rings(vertex_count, indices);
    std::vector<uint32_t> ring;
    for (uint32_t vertex = 0; vertex < vertex_count; ++vertex) {
        bool manifold;
        rings.ordered(vertex, ring, manifold);
        if (!manifold)
            throw UserError(where,
                            fmt::format("loop subdivision: the triangles at vertex {} do not form a surface: an edge "
                                        "has more than two, they are ordered differently, or they touch in a "
                                        "point only",
                                        vertex));
    }
}

}  // namespace

SubdividedMesh loop_subdivide(std::span<const Vec3> positions, std::span<const uint32_t> indices, int levels,
                              const SourceLocation& where)
{
    SubdividedMesh mesh;
    mesh.positions.assign(positions.begin(), positions.end());
    mesh.indices.assign(indices.begin(), indices.end());
    check_mesh(mesh.positions.size(), mesh.indices, levels, where);
    for (int level = 0; level < levels; ++level) refine(mesh.positions, mesh.indices);

    const std::vector<Neighbourhood> around = gather(mesh.positions, find_edges(mesh.indices));
    const Rings rings(mesh.positions.size(), mesh.indices);
    std::vector<Vec3> limit = mesh.positions;
    mesh.normals.assign(mesh.positions.size(), Vec3(0.0f, 0.0f, 1.0f));
    std::vector<uint32_t> ring;
    for (uint32_t i = 0; i < mesh.positions.size(); ++i) {
        const Neighbourhood& here = around[i];
        if (here.valence == 0) continue;
        if (here.boundary) {
            limit[i] = mesh.positions[i] * (2.0f / 3.0f) + here.boundary_sum * (1.0f / 6.0f);
        } else {
            const float n = static_cast<float>(here.valence);
            const float weight = 1.0f / (n + 3.0f / (8.0f * neighbour_weight(here.valence)));
            limit[i] = mesh.positions[i] * (1.0f - n * weight) + here.sum * weight;
        }
        bool manifold;
        const bool closed = rings.ordered(i, ring, manifold);
        const Vec3 normal = limit_normal(mesh.positions, i, ring, closed);
        const float len = length(normal);
        if (len > 0.0f) mesh.normals[i] = normal / len;
    }
    mesh.positions = std::move(limit);
    return mesh;
}

}  // namespace dapple
