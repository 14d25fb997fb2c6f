// Multiple importance sampling over all ways to build a path from an eye and a light subpath, by two running numbers
// per subpath vertex (Georgiev 2012, "Implementing vertex connection and merging"; van Antwerpen 2011, "Recursive MIS
// computation for streaming BDPT on the GPU"; Georgiev et al. 2012, "Light transport simulation with vertex connection
// and merging", for merging).
//
// A path x_0 (on a light) ... x_k (on the lens) can be made by
//   emission  the eye path meets the light                      s = 0
//   direct    the eye path's last vertex is joined to a sampled light point    s = 1
//   inner     two inner vertices are joined                     s >= 2, t >= 2
//   camera    a light vertex is joined to the lens              t = 1
//   merge     an eye and a light subpath end within a radius r of each other at an inner vertex
// Weights are m(p_i) / sum_j m(p_j), m(p) = p (balance heuristic) or p^2 (power heuristic). For a subpath that ends at
// vertex x_i, with area densities p-> of its own direction and p<- of the other one,
//   d_vcm = m(1 / p->(x_i))  (times the density of light sampling over that of emission at a light's first vertex),
//   d_vc  = m(1 / p->(x_i)) sum over all techniques that take the vertices before x_i from the other side.
// Merging at x adds m(eta), eta = pi r^2 N_light; all densities are per eye path of one pixel, so that the camera
// technique has N_light samples. The quantity d_VM of the report is d_vc / m(eta) and not kept: so the radius may be a
// function of position. Densities leave out transmittance and roulette: they scale all techniques but for the joined
// edge, and any weights that sum to one are unbiased.
#pragma once

#include "dapple/math/vec.h"

namespace dapple {

// Which techniques take part, and how they are weighed. A technique may still be impossible for a path (deltas).
struct MisRules {
    bool emission = true;
    bool direct = true;
    bool inner = true;
    bool camera = true;
    bool power = false;        // power heuristic with exponent 2; else the balance heuristic
    double light_paths = 1.0;  // N_light per pass, each of which may reach any pixel

    double m(double p) const { return power ? p * p : p; }
};

struct SubpathWeights {
    double d_vcm = 0.0;
    double d_vc = 0.0;
};

// How a subpath left its last vertex, or its source.
struct SubpathStep {
    double pdf = 0.0;          // per solid angle, of the new direction; 0: a delta lobe
    double pdf_reverse = 0.0;  // per solid angle, of the way back at that vertex
    double cosine_out = 1.0;   // to the geometric normal at that vertex; 1 in media
    double eta = 0.0;          // of merging at that vertex; 0 where nothing is merged
    bool joins = true;         // whether the technique that joins that vertex to the one before takes part
};

// At the first vertex of an eye path: importance there (camera.h) and the cosine of its arrival.
inline SubpathWeights first_eye_weights(const MisRules& rules, double importance, double cosine_in)
{
    return {rules.m(rules.light_paths / (importance * cosine_in)), 0.0};
}

// At the first vertex of a light path. emission: the area density of the vertex times that of the light's point;
// direct: the same pair's density by light sampling from that vertex, per area of the light (far lights: both with the
// solid angle in place of the light's area); cosine_light: at the light's point, 1 for lights without surface; all
// without the probability of the light, which `probability` is. can_be_met: eye paths can meet the light.
inline SubpathWeights first_light_weights(const MisRules& rules, double direct_over_emission, double met_over_emission,
                                          bool can_be_met)
{
    return {rules.m(direct_over_emission), rules.emission && can_be_met ? rules.m(met_over_emission) : 0.0};
}

// Carries the weights from one vertex over a scattering and the way to the next. distance2: squared distance; 1 with
// cosine_in = 1 for a subpath that has left the scene.
inline SubpathWeights advance(const MisRules& rules, const SubpathWeights& w, const SubpathStep& step, double distance2,
                              double cosine_in)
{
    if (!(step.pdf > 0.0)) return {0.0, w.d_vc * rules.m(step.cosine_out / cosine_in)};
    const double others = w.d_vc * rules.m(step.pdf_reverse) + (step.joins ? w.d_vcm : 0.0) + rules.m(step.eta);
    return {rules.m(distance2 / (step.pdf * cosine_in)), others * rules.m(step.cosine_out / (step.pdf * cosine_in))};
}

// The sum over all techniques on one side of a joined edge, relative to the joining: to_here: area density with which
// the other side would have sampled this vertex; back: density per solid angle of this vertex's way back. eta: of
// merging here; joins: whether joining the edge before takes part.
inline double side_sum(const MisRules& rules, const SubpathWeights& w, double to_here, double back, double eta,
                       bool joins)
{
    return rules.m(to_here) * (rules.m(eta) + (joins ? w.d_vcm : 0.0) + w.d_vc * rules.m(back));
}

// The same for merging at this vertex, relative to merging here.
inline double merged_side_sum(const MisRules& rules, const SubpathWeights& w, double back, double eta, bool joins)
{
    return ((joins ? w.d_vcm : 0.0) + w.d_vc * rules.m(back)) / rules.m(eta);
}

}  // namespace dapple
