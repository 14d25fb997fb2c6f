// The light subpaths of one pass, stored once: every vertex that is no delta, with what joining and merging need. Path
// j belongs to pixel j of the image (counted row by row, around again where there are fewer paths than pixels), so that
// the eye path of that pixel shares its wavelengths, time and deciding lane.
#pragma once

#include "dapple/integrators/integrator.h"
#include "dapple/integrators/surface_coverage.h"
#include "dapple/photons/photon_packing.h"
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

// A vertex of a light path as it is traced.
struct LightArrival {
    const Vertex& vertex;
    Carried carried;  // throughput: flux [W], not divided by the number of paths
    SubpathWeights weights;
    double eta = 0.0;   // of merging at the vertex
    PathEvents events;  // this vertex not counted
    LightGroup light_group;
    int depth = 1;  // vertices after the light, this one included
};

// What is stored of it: two cache lines. The Bsdf of a diffuse surface is its normals and its reflectance; others
// are kept beside.
struct alignas(64) LightVertex {
    static constexpr uint32_t diffuse = 0xffffffffu, medium = 0xfffffffeu;

    Spectrum throughput;  // as above
    Spectrum path_pdf;
    Spectrum reflectance;  // diffuse surfaces; media: the phase function's mean cosine, in the first lane
    Vec3 position;
    Vec3 wo;           // unit, back along the light path
    Vec3 n_geometric;  // surfaces
    Vec3 n_shading;    // diffuse surfaces
    float offset;      // of rays from the surface along its normal [m]
    float d_vcm, d_vc;
    float eta;
    uint32_t bsdf;  // diffuse, medium, or an index (bsdf_of)
    LightGroup light_group;
    PathEvents events;
    uint16_t depth;

    bool on_surface() const { return bsdf != medium; }
    SubpathWeights weights() const { return {d_vcm, d_vc}; }
};
static_assert(sizeof(LightVertex) == 128);

// A light vertex as merging sees it: one cache line.
struct alignas(64) MergePhoton {
    Spectrum throughput;
    Spectrum path_pdf;
    Vec3 direction;  // unit, back along the light path
    float d_vcm, d_vc;
    PathEvents events;
    uint16_t depth;
    uint16_t normal;  // geometric, on the side of `direction`, packed
    uint16_t light_group;

    SubpathWeights weights() const { return {d_vcm, d_vc}; }
};
static_assert(sizeof(MergePhoton) == 64);

class LightSubpaths {
public:
    // visit(*this, path, vertex) is called for each vertex that is no delta as it is traced, on many threads at once.
    using Visitor = std::function<void(const LightSubpaths& subpaths, int64_t path, const LightArrival& vertex)>;
    LightSubpaths(const PassContext& context, ColorModel model, Int2 resolution, const LightSubpathPlan& plan,
                  const Visitor& visit);

    int64_t paths() const { return plan_.paths; }
    int64_t path_of(Int2 pixel) const { return (int64_t(pixel.y) * resolution_.x + pixel.x) % plan_.paths; }
    // Of what is kept, and what building the maps took.
    size_t memory_bytes() const;
    // The set of wavelengths of a path.
    size_t set_of(int64_t path) const { return set_of_path_.empty() ? 0 : set_of_path_[static_cast<size_t>(path)]; }
    // The start that path j shares with the eye path of its pixel.
    PathStart start(int64_t path) const;

    struct Path {
        std::span<const LightVertex> vertices;
        const Bsdf* bsdfs = nullptr;
        // Of a vertex whose Bsdf is kept beside.
        const Bsdf& bsdf_of(const LightVertex& vertex) const { return bsdfs[vertex.bsdf]; }
    };
    Path path(int64_t index) const
    {
        const Chunk& chunk = chunks_[static_cast<size_t>(index / chunk_paths)];
        const auto local = static_cast<size_t>(index % chunk_paths);
        const uint32_t begin = local == 0 ? 0u : chunk.end[local - 1];
        return {{chunk.vertices.data() + begin, chunk.end[local] - begin}, chunk.bsdfs.data()};
    }

    // Of merging at a vertex [m]; 0 where nothing is merged.
    float radius_at(const Vertex& vertex) const
    {
        return plan_.merging && vertex.on_surface && !vertex.is_delta() ? plan_.radius.at(vertex.at.position) : 0.0f;
    }
    // Expected number of light vertices of a set's wavelengths that meet a disc of the radius, per unit of their
    // density per path: pi r^2 N; 0 where nothing is merged.
    double eta(size_t set, float radius) const
    {
        return plan_.merges_everywhere ? pi * double(radius) * radius * static_cast<double>(paths_in_set(set)) : 0.0;
    }
    // Light paths that share the set's wavelengths.
    int64_t paths_in_set(size_t set) const { return maps_.empty() ? 1 : maps_[set].paths; }

    // Calls visit(photon, position, distance_squared) for the set's photons that lie on the region's surface within the
    // radius.
    template <class Visit>
    void for_each_near(size_t set, const SurfaceRegion& region, float radius, Visit&& visit) const;

    static constexpr int64_t chunk_paths = 1024;

private:
    struct Chunk {
        std::vector<LightVertex> vertices;
        std::vector<Bsdf> bsdfs;    // of vertices on surfaces that are not diffuse
        std::vector<uint32_t> end;  // of each path's vertices
    };
    struct Map {
        PointTree tree;
        std::vector<MergePhoton> photons;  // in the order of the tree
        int64_t paths = 0;
    };

    template <class Arrive>
    void trace(const World& world, int64_t path, Arrive&& arrive) const;
    static void store(const LightArrival& arrival, Chunk& chunk);
    void build_maps();

    LightSubpathPlan plan_;
    ColorModel model_;
    Int2 resolution_;
    uint64_t seed_ = 0;
    uint32_t pass_ = 0;
    std::vector<PathStart> set_starts_;
    std::vector<uint32_t> set_of_path_;  // empty: they all are of one
    std::vector<Chunk> chunks_;
    std::vector<Map> maps_;
};

template <class Visit>
void LightSubpaths::for_each_near(size_t set, const SurfaceRegion& region, float radius, Visit&& visit) const
{
    // Photons are asked for as they are found and looked at a while later, when memory has brought them.
    constexpr int batch = 32;
    struct Found {
        uint32_t slot;
        float distance_squared;
    };
    Found found[batch];
    int count = 0;
    const Map& map = maps_[set];
    const auto look = [&] {
        for (int i = 0; i < count; ++i) {
            const MergePhoton& photon = map.photons[found[i].slot];
            if (region.takes(unpack_unit<8>(photon.normal)))
                visit(photon, map.tree.position(found[i].slot), found[i].distance_squared);
        }
        count = 0;
    };
    map.tree.for_each_within(region.disc(), radius * radius, AcceptAll{}, [&](uint32_t slot, float distance_squared) {
        __builtin_prefetch(&map.photons[slot]);
        found[count++] = {slot, distance_squared};
        if (count == batch) look();
    });
    look();
}

// The density of emission over that of light sampling, for a light's point seen from a vertex: both as the densities of
// the pair (light point, vertex). direct_pdf: per solid angle at the vertex (1 for delta lights); cosine_light: at an
// area light's point; cosine_in and distance2: at and to the vertex. Without the probability of the light.
double emission_over_direct(const Light& light, const EmissionDensity& emission, float direct_pdf, float cosine_light,
                            float cosine_in, float distance2);

// About what scattering at a vertex leaves, for roulette before it; at least half of what can come where that grows
// towards grazing directions.
inline Spectrum expected_albedo(const Vertex& vertex)
{
    if (!vertex.on_surface) return Spectrum(1.0f);
    Spectrum albedo = guide_albedo(vertex.bsdf, vertex.wo);
    const float least = vertex.bsdf.kind == BsdfKind::diffuse ? 0.0f : 0.5f;
    for (float& lane : albedo.v) lane = std::max(lane, least);
    return albedo;
}

// The geometric cosine at a vertex; 1 in media.
inline float geometric_cosine(const Vertex& vertex, const Vec3& w)
{
    return vertex.on_surface ? abs_dot(vertex.at.n_geometric, w) : 1.0f;
}
inline float geometric_cosine(const LightVertex& vertex, const Vec3& w)
{
    return vertex.on_surface() ? abs_dot(vertex.n_geometric, w) : 1.0f;
}

}  // namespace dapple
