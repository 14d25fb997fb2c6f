// One eye path of bidirectional.cpp and all that it is joined to, and light vertices seen by the camera, weighed
// against each other by subpath_weights.h.
#pragma once

#include "dapple/density/kernels.h"
#include "dapple/integrators/light_subpaths.h"
#include "dapple/integrators/pixel_loop.h"
#include "dapple/integrators/technique_films.h"
#include "dapple/transport/connect.h"

#include <optional>

namespace dapple {

// What a pass of bidirectional methods does.
struct BidirectionalPlan {
    MisRules rules;
    bool merging = false;
    bool first_vertex_only = false;  // eye paths end with their first vertex that is no delta
    int max_depth = 100;
    KernelKind kernel = KernelKind::epanechnikov;  // of merging
    TechniqueFilms* techniques = nullptr;          // where each technique is recorded by itself, if at all

    // Whether light vertices are needed after their path was traced.
    bool stores() const { return rules.inner || merging; }
};

// Adds a light vertex to the film, as the camera sees it (t = 1).
void splat_light_vertex(const PassContext& context, Film& film, const BidirectionalPlan& plan,
                        const LightSubpaths& subpaths, int64_t path, const LightArrival& light);

class BidirectionalEyePath {
public:
    BidirectionalEyePath(const BidirectionalPlan& plan, const World& world, const LightSubpaths& subpaths,
                         EyeSample& sample);

    // Traces it and adds all it finds to the sample.
    void trace();

private:
    void add(const Spectrum& estimate, double weight, PathClass path_class, LightGroup group,
             const Technique& technique);
    PathEvents events_at_vertex() const;
    SubpathStep step(int depth_before) const;
    bool joins_before() const;
    bool arrive();
    double met_weight(const SubpathWeights& weights, double direct, double emission) const;
    void add_medium_emission();
    void add_emission();
    void add_environment();
    void join_light();
    void join_all();
    void join(const LightSubpaths::Path& path, const LightVertex& light, RandomStream& chances);
    void merge();

    Carried carried_;         // to the current vertex, if it is no delta
    Bsdf diffuse_light_end_;  // scratch
    Walk eye_;
    const BidirectionalPlan& plan_;
    const MisRules& rules_;
    const World& world_;
    const LightSubpaths& subpaths_;
    EyeSample& sample_;
    const int64_t path_;      // the light path it is joined to
    const size_t set_;        // of wavelengths
    double eta_ = 0.0;        // of merging at the current vertex
    SubpathWeights weights_;  // there
    std::optional<TechniqueFilms::Sample> record_;
    float radius_ = 0.0f;  // of merging there; 0 where nothing is merged [m]
    float found_ = 0.0f;   // radiance found so far, largest lane
    const PathStart start_;
};

}  // namespace dapple
