// Running weights against weights from the explicit densities of all techniques, on random paths of all shapes: 1 to 7
// scatterings, deltas and media among them, every kind of light, both heuristics, all sets of techniques.

#include "dapple/transport/subpath_weights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace dapple {
namespace {

enum class LightKind { area, point, distant, environment };

// A path x_0 (light) ... x_k (lens) with all that its densities are made of.
struct PathVertex {
    bool delta = false;
    bool medium = false;        // no cosines, no merging
    double to_light = 1.0;      // density per solid angle of the way to the vertex before, coming from the one after
    double to_eye = 1.0;        // the reverse
    double cosine_light = 1.0;  // of the edge to the vertex before
    double cosine_eye = 1.0;    // of the edge to the vertex after
    double eta = 0.0;
};

struct RandomPath {
    MisRules rules;
    LightKind light = LightKind::area;
    bool can_be_met = true;
    int edges = 2;
    std::vector<PathVertex> x;      // 1 to edges - 1 are used
    std::vector<double> distance2;  // of edge i: x_i to x_(i + 1)
    double probability = 1.0, position = 1.0, direction = 1.0, direct = 1.0;
    double cosine_at_light = 1.0;
    double importance = 1.0;

    bool is_near() const { return light == LightKind::area || light == LightKind::point; }
    // The density of light sampling, in the measure of the light's point where it is near.
    double direct_density() const
    {
        if (light == LightKind::area) return direct * cosine_at_light / distance2[0];
        return direct;
    }

    // Density of the first s vertices when they are made from the light.
    double from_light(int s) const
    {
        if (s == 0) return 1.0;
        if (s == 1) return probability * direct_density();
        double p = probability * position * direction * x[1].cosine_light;
        if (is_near()) p /= distance2[0];
        for (int i = 2; i < s; ++i)
            p *= (x[i - 1].delta ? 1.0 : x[i - 1].to_eye) * x[i].cosine_light / distance2[i - 1];
        return p;
    }
    // Density of the last t vertices when they are made from the lens.
    double from_eye(int t) const
    {
        double p = 1.0;
        for (int n = 2; n <= t; ++n) {
            const int i = edges + 1 - n;
            if (n == 2 && i > 0)
                p *= importance * x[i].cosine_eye;
            else if (i > 0)
                p *= (x[i + 1].delta ? 1.0 : x[i + 1].to_light) * x[i].cosine_eye / distance2[i];
            else
                p *= (x[1].delta ? 1.0 : x[1].to_light) *
                     (light == LightKind::area ? cosine_at_light / distance2[0] : 1.0);
        }
        return p;
    }
    bool joinable(int i) const { return i == 0 || i == edges || !x[i].delta; }

    // Densities of the techniques s = 0 ... edges (edges: the camera's), then of merging at 1 ... edges - 1.
    std::vector<double> densities() const
    {
        std::vector<double> p;
        for (int s = 0; s <= edges; ++s) {
            const bool used = s == 0       ? rules.emission && can_be_met
                              : s == edges ? rules.camera
                              : s == 1     ? rules.direct
                                           : rules.inner;
            const bool possible = used && (s == 0 || (joinable(s - 1) && joinable(s)));
            const double samples = s == edges ? rules.light_paths : 1.0;
            p.push_back(possible ? samples * from_light(s) * from_eye(edges + 1 - s) : 0.0);
        }
        for (int i = 1; i < edges; ++i)
            p.push_back(x[i].delta ? 0.0 : from_light(i + 1) * from_eye(edges + 1 - i) * x[i].eta);
        return p;
    }
};

class Random {
public:
    explicit Random(unsigned seed) : engine_(seed) {}
    double between(double low, double high) { return std::uniform_real_distribution<>(low, high)(engine_); }
    double magnitude(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }
    bool chance(double p) { return between(0, 1) < p; }
    int index(int n) { return std::uniform_int_distribution<>(0, n - 1)(engine_); }

private:
    std::mt19937 engine_;
};

RandomPath random_path(Random& random, int edges)
{
    RandomPath path;
    path.edges = edges;
    path.rules.power = random.chance(0.5);
    path.rules.light_paths = random.magnitude(10, 1e5);
    const bool merging = random.chance(0.6);
    if (random.chance(0.3)) {
        path.rules.direct = path.rules.inner = random.chance(0.5);
        path.rules.camera = random.chance(0.5);
        path.rules.emission = random.chance(0.7);
    }
    path.light = static_cast<LightKind>(random.index(4));
    path.can_be_met = path.light == LightKind::area || path.light == LightKind::environment;
    path.probability = random.between(0.05, 1);
    path.position = path.light == LightKind::point ? 1.0 : random.magnitude(0.01, 100);
    path.direction = path.light == LightKind::distant ? 1.0 : random.magnitude(0.01, 10);
    path.direct = path.can_be_met ? random.magnitude(0.01, 100) : 1.0;
    path.cosine_at_light = path.light == LightKind::area ? random.between(0.05, 1) : 1.0;
    path.importance = random.magnitude(10, 1e5);
    path.x.resize(static_cast<size_t>(edges) + 1);
    path.distance2.resize(static_cast<size_t>(edges));
    for (double& d : path.distance2) d = random.magnitude(0.01, 100);
    for (int i = 1; i < edges; ++i) {
        PathVertex& v = path.x[static_cast<size_t>(i)];
        v.delta = random.chance(0.25);
        v.medium = !v.delta && random.chance(0.15);
        v.to_light = random.magnitude(0.01, 100);
        v.to_eye = random.magnitude(0.01, 100);
        v.cosine_light = v.medium ? 1.0 : random.between(0.05, 1);
        v.cosine_eye = v.medium ? 1.0 : random.between(0.05, 1);
        v.eta = merging && !v.delta && !v.medium ? random.magnitude(1e-4, 10) : 0.0;
    }
    return path;
}

// What the walks of an eye path know at x_i, coming from the lens.
SubpathWeights eye_weights(const RandomPath& path, int i)
{
    const MisRules& rules = path.rules;
    SubpathWeights w = first_eye_weights(rules, path.importance, path.x[path.edges - 1].cosine_eye);
    for (int k = path.edges - 2; k >= i; --k) {
        const PathVertex& from = path.x[k + 1];
        const SubpathStep step{from.delta ? 0.0 : from.to_light, from.to_eye, from.cosine_light, from.eta,
                               k + 1 == path.edges - 1 ? rules.camera : rules.inner};
        const bool at_far_light = k == 0 && !path.is_near();
        w = advance(rules, w, step, at_far_light ? 1.0 : path.distance2[k],
                    k == 0 ? path.cosine_at_light : path.x[k].cosine_eye);
    }
    return w;
}

// The same of a light path.
SubpathWeights light_weights(const RandomPath& path, int i)
{
    const MisRules& rules = path.rules;
    double emission = path.position * path.direction * path.x[1].cosine_light;
    if (path.is_near()) emission /= path.distance2[0];
    const double met =
        path.cosine_at_light / (path.probability * path.position * path.direction * path.x[1].cosine_light);
    SubpathWeights w = first_light_weights(rules, path.direct_density() / emission, met, path.can_be_met);
    for (int k = 2; k <= i; ++k) {
        const PathVertex& from = path.x[k - 1];
        const SubpathStep step{from.delta ? 0.0 : from.to_eye, from.to_light, from.cosine_eye, from.eta,
                               k == 2 ? rules.direct : rules.inner};
        w = advance(rules, w, step, path.distance2[k - 1], path.x[k].cosine_light);
    }
    return w;
}

// Running weight of technique s.
double joined_weight(const RandomPath& path, int s)
{
    const MisRules& rules = path.rules;
    const int edges = path.edges;
    const auto eye_joins = [&](int i) { return i == edges - 1 ? rules.camera : rules.inner; };
    const auto light_joins = [&](int i) { return i == 1 ? rules.direct : rules.inner; };
    double others = 0.0;
    if (s == 0) {
        const SubpathWeights w = eye_weights(path, 0);
        double emission = path.probability * path.position * path.direction;
        others = (rules.direct ? rules.m(path.probability * path.direct_density()) * w.d_vcm : 0.0) +
                 rules.m(emission) * w.d_vc;
    } else {
        const PathVertex& z = path.x[s];      // the eye's end, unless s == edges
        const PathVertex& y = path.x[s - 1];  // the light's end, unless s == 1
        if (s == 1) {
            double emission = path.position * path.direction * z.cosine_light;
            if (path.is_near()) emission /= path.distance2[0];
            if (rules.emission && path.can_be_met) others += rules.m(z.to_light / (path.probability * path.direct));
            others +=
                side_sum(rules, eye_weights(path, 1), emission / path.direct_density(), z.to_eye, z.eta, eye_joins(1));
        } else if (s == edges) {
            others += side_sum(rules, light_weights(path, s - 1), path.importance * y.cosine_eye / rules.light_paths,
                               y.to_light, y.eta, light_joins(s - 1));
        } else {
            const double d2 = path.distance2[s - 1];
            others += side_sum(rules, light_weights(path, s - 1), z.to_light * y.cosine_eye / d2, y.to_light, y.eta,
                               light_joins(s - 1));
            others +=
                side_sum(rules, eye_weights(path, s), y.to_eye * z.cosine_light / d2, z.to_eye, z.eta, eye_joins(s));
        }
    }
    return 1.0 / (1.0 + others);
}

double merged_weight(const RandomPath& path, int i)
{
    const MisRules& rules = path.rules;
    const PathVertex& v = path.x[i];
    const double others =
        merged_side_sum(rules, light_weights(path, i), v.to_light, v.eta, i == 1 ? rules.direct : rules.inner) +
        merged_side_sum(rules, eye_weights(path, i), v.to_eye, v.eta, i == path.edges - 1 ? rules.camera : rules.inner);
    return 1.0 / (1.0 + others);
}

TEST(SubpathWeights, EqualThoseOfExplicitDensities)
{
    Random random(1);
    int64_t compared = 0, merged = 0, paths = 0;
    double largest = 0.0;
    for (int round = 0; round < 16000; ++round)
        for (int edges = 2; edges <= 8; ++edges) {
            const RandomPath path = random_path(random, edges);
            const std::vector<double> p = path.densities();
            double sum = 0.0;
            for (const double density : p) sum += path.rules.m(density);
            if (!(sum > 0.0)) continue;
            ++paths;
            for (size_t i = 0; i < p.size(); ++i) {
                if (!(p[i] > 0.0)) continue;
                const bool joined = i <= static_cast<size_t>(edges);
                const double expected = path.rules.m(p[i]) / sum;
                const double running = joined ? joined_weight(path, static_cast<int>(i))
                                              : merged_weight(path, static_cast<int>(i) - edges);
                const double error = std::abs(running - expected) / std::max(expected, 1e-12);
                largest = std::max(largest, error);
                ASSERT_LT(error, 1e-5) << "edges " << edges << ", technique " << i << ", light "
                                       << static_cast<int>(path.light) << ": " << running << " for " << expected;
                ++(joined ? compared : merged);
            }
        }
    EXPECT_GE(paths, 100000);
    EXPECT_GT(compared, 300000);
    EXPECT_GT(merged, 50000);
    EXPECT_LT(largest, 1e-9);  // doubles throughout
}

}  // namespace
}  // namespace dapple
