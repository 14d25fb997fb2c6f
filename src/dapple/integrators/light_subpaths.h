// The light subpaths of one pass, stored once: every vertex that is no delta, with what joining and merging need. Path
// j belongs to pixel j of the image (counted row by row, around again where there are fewer paths than pixels), so that
// the eye path of that pixel shares its wavelengths, time and deciding lane.
#pragma once

#include "dapple/integrators/integrator.h"
#include "dapple/integrators/surface_coverage.h"
#include "dapple/transport/subpath_weights.h"
#include "dapple/transport/walk.h"

#include <functional>
#include <span>
#include <vector>

namespace dapple {

// The merging radius, a function of position so that eye and light subpaths agree on it: a number of pixel footprints
// at the straight distance from the camera, or a fixed length.
class MergeRadius {
public:
    MergeRadius() = default;
    static MergeRadius footprints(const Camera& camera, float count);
    static MergeRadius fixed(float radius);
    MergeRadius operator*(float factor) const;

    float at(const Vec3& position) const { return base_ + slope_ * length(position - center_); }

private:
    Vec3 center_{0, 0, 0};
    float base_ = 0.0f;   // [m]
    float slope_ = 0.0f;  // [m per m]
};

struct LightSubpathPlan {
    int64_t paths = 0;
    int wavelength_sets = 0;  // sets that the paths of a pass share; 0: wavelengths of its own for each path
    int max_depth = 100;
    bool stored = true;             // keep the vertices; else only visited once, as they are traced
    bool merging = false;           // prepare for merging ...
    bool merges_everywhere = true;  // ... at any vertex; false: at the last one only (as far as weights know)
    MergeRadius radius;
    MisRules rules;
};

struct LightVertex {
    Vertex vertex;
    Spectrum throughput;  // flux [W], not divided by the number of paths
    Spectrum path_pdf;
    SubpathWeights weights;
    PathEvents events;  // this vertex not counted
    LightGroup light_group;
    uint16_t depth = 1;  // vertices after the light, this one included
};

// A light vertex as merging sees it.
struct MergePhoton {
    Vec3 direction;  // unit, back along the light path
    Vec3 normal;     // geometric, on the side of `direction`
    Spectrum throughput;
    Spectrum path_pdf;
    SubpathWeights weights;
    PathEvents events;
    LightGroup light_group;
    uint16_t depth = 1;
};

class LightSubpaths {
public:
    // visit(*this, path, vertices) is called for each path right after it is traced, on many threads at once.
    using PathVisitor =
        std::function<void(const LightSubpaths& subpaths, int64_t path, std::span<const LightVertex> vertices)>;
    LightSubpaths(const PassContext& context, ColorModel model, Int2 resolution, const LightSubpathPlan& plan,
                  const PathVisitor& visit);

    int64_t paths() const { return plan_.paths; }
    int64_t path_of(Int2 pixel) const { return (int64_t(pixel.y) * resolution_.x + pixel.x) % plan_.paths; }
    // The start that path j shares with the eye path of its pixel.
    PathStart start(int64_t path) const;
    std::span<const LightVertex> vertices(int64_t path) const
    {
        const Chunk& chunk = chunks_[static_cast<size_t>(path / chunk_paths)];
        const auto local = static_cast<size_t>(path % chunk_paths);
        const uint32_t begin = local == 0 ? 0u : chunk.end[local - 1];
        return {chunk.vertices.data() + begin, chunk.end[local] - begin};
    }

    // Expected number of light vertices of the path's wavelengths that meet a disc of radius r, per unit of their
    // density per path: pi r^2 N; 0 where nothing is merged.
    double eta(int64_t path, const Vertex& vertex) const;
    // Of merging [m].
    float radius_at(const Vec3& position) const { return plan_.radius.at(position); }
    // Light paths that share the wavelengths of this one.
    int64_t paths_in_set(int64_t path) const { return maps_.empty() ? 1 : maps_[set_of(path)].paths; }

    // Calls visit(photon, position, distance_squared) for the photons of the path's wavelength set that lie on the same
    // surface within the radius of `at`.
    template <class Visitor>
    void for_each_near(int64_t path, const Vertex& at, float radius, Visitor&& visit) const;

    static constexpr int64_t chunk_paths = 1024;

private:
    struct Chunk {
        std::vector<LightVertex> vertices;
        std::vector<uint32_t> end;  // of each path's vertices
    };
    struct Map {
        PointTree tree;
        std::vector<MergePhoton> photons;  // in the order of the tree
        int64_t paths = 0;
    };

    void trace(const World& world, int64_t path, std::vector<LightVertex>& vertices) const;
    void build_maps();
    size_t set_of(int64_t path) const;

    LightSubpathPlan plan_;
    ColorModel model_;
    Int2 resolution_;
    uint64_t seed_ = 0;
    uint32_t pass_ = 0;
    std::vector<PathStart> set_starts_;
    std::vector<Chunk> chunks_;
    std::vector<Map> maps_;
};

template <class Visitor>
void LightSubpaths::for_each_near(int64_t path, const Vertex& at, float radius, Visitor&& visit) const
{
    const Map& map = maps_[set_of(path)];
    const SurfaceRegion region = surface_region(at.at.position, at.bsdf, at.wo);
    map.tree.for_each_within(region.disc(), radius * radius, AcceptAll{}, [&](uint32_t slot, float distance_squared) {
        const MergePhoton& photon = map.photons[slot];
        if (region.takes(photon.normal)) visit(photon, map.tree.position(slot), distance_squared);
    });
}

// The density of emission over that of light sampling, for a light's point seen from a vertex: both as the densities of
// the pair (light point, vertex). direct_pdf: per solid angle at the vertex (1 for delta lights); cosine_light: at an
// area light's point; cosine_in and distance2: at and to the vertex. Without the probability of the light.
double emission_over_direct(const Light& light, const EmissionDensity& emission, float direct_pdf, float cosine_light,
                            float cosine_in, float distance2);

// The geometric cosine at a vertex; 1 in media.
inline float geometric_cosine(const Vertex& vertex, const Vec3& w)
{
    return vertex.on_surface ? abs_dot(vertex.at.n_geometric, w) : 1.0f;
}

}  // namespace dapple
