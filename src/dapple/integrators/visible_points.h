// What progressive photon mapping and photon splatting share: eye paths with the vertices where they ask for photons
// (visible points), and the photons of a pass.
// Hachisuka and Jensen 2009, "Stochastic progressive photon mapping"; Knaus and Zwicker 2011, "Progressive photon
// mapping: a probabilistic approach".
//
// Who brings what. At each vertex y of an eye path that is no delta:
//   direct light          L y      light sampling at y and the ray that leaves y, weighed by MIS, as in path tracing;
//   all other light       LX+ y    photons with weight 1 - s, and the eye path's own continuation with weight s.
// s is a smooth function of the density p with which scattering at y samples the direction of the light: s = t^2 / (t^2
// + c^2), t = max(0, p - 1/pi) (narrow_share, transport/caustic_share.h). Where p is no more than the largest density
// of a matte surface, s = 0 and the eye path ends; in a narrow lobe, which few photons hit, s tends to 1 and the eye
// path goes on (as a Russian roulette of s: its throughput stays). Both parts are estimates of the same light and s
// depends on (wo, wi) alone, so any s is right; this one has no threshold in roughness and takes a coat apart from its
// base, as p is large in the coat's lobe only. c = 1: the two are even where a lobe is as dense as that of a GGX
// surface of alpha 0.25.
//
// Light that comes to y through delta surfaces alone (caustics, LS+ y) is met by the eye path only if it happens to
// hit the lamp: there c = 30, and photons of point-like and distant lights, which no ray meets, have weight 1.
//
// Radii are a number of pixel footprints at the length of the eye path; a pass i has r_i^2 = r_1^2 Gamma(i + a) /
// (Gamma(1 + a) Gamma(i + 1)). So a pass depends on (world, settings, seed, i) alone. Where shapes move, all paths of a
// wavelength set in a pass have one time: photons and visible points see the same still picture, and passes average
// stills. With times of their own, photons would lie along the way of the shape, and few where a visible point is.
#pragma once

#include "dapple/density/kernels.h"
#include "dapple/density/schedule.h"
#include "dapple/integrators/photon_maps.h"
#include "dapple/integrators/pixel_loop.h"
#include "dapple/transport/caustic_share.h"
#include "dapple/transport/connect.h"
#include "dapple/transport/photon_tracing.h"

#include <optional>

namespace dapple {

// Rows for the tables of integrators with visible points.
namespace visible_point_setting {
inline constexpr SettingInfo photons{
    "photons", "light paths", "auto", "> 0",
    "light paths per pass; auto: one per wavelength set and pixel of the full image, at least "
    "25000"};
inline constexpr SettingInfo radius{"radius", "pixels", "3", "> 0",
                                    "radius of the estimates in the first pass, in pixel footprints"};
inline constexpr SettingInfo fixed_radius{"fixedradius", "scene units", "auto", "> 0",
                                          "radius of the estimates in the first pass; auto: from the footprint"};
inline constexpr SettingInfo alpha{"alpha", "", "0.6667", "> 0",
                                   "how slowly radii shrink, up to 1: their squares fall as pass^(alpha - 1)"};
inline constexpr SettingInfo wavelength_sets{"wavelengthsets", "sets", "4", ">= 1",
                                             "sets of four wavelengths per pass (spectral colour model)"};
}  // namespace visible_point_setting

// The share s (narrow_share) of the eye path's own continuation in light from a direction that scattering samples with
// density `pdf` [1/sr], where the light comes through delta surfaces alone; photons have the rest.
inline float eye_share_of_caustic(float pdf) { return narrow_share(pdf, 30.0f); }

// The wavelengths, and perhaps the time, that the eye paths and light paths of one set of a pass have in common.
struct PassSet {
    Wavelengths wavelengths;
    std::optional<float> time;
    PhotonRequest photons;  // of this set
};

class VisiblePointSettings {
public:
    // Throws UserError where a setting makes no sense, or the world has media that scatter or emit; `integrator` is
    // named there.
    VisiblePointSettings(const World& world, const Settings& settings, std::string_view integrator);

    KernelKind kernel() const { return kernel_; }
    int max_depth() const { return max_depth_; }
    // Light paths of a pass, all sets together.
    int64_t paths(Int2 resolution, ColorModel model) const;
    int sets(ColorModel model) const { return model == ColorModel::spectral ? wavelength_sets_ : 1; }
    // r_i^2 / r_1^2 of pass 0, 1, ...
    double shrinkage(uint32_t pass) const { return progressive_shrinkage(int64_t(pass) + 1, alpha_); }
    // Radius at a visible point at the end of an eye path of this length in the first pass [m].
    float first_radius(const Camera& camera, float distance) const
    {
        return fixed_radius_ > 0.0f ? fixed_radius_ : radius_pixels_ * pixel_footprint(camera, distance);
    }
    // The sets of a pass with `paths` light paths.
    std::vector<PassSet> sets_of_pass(const PassContext& context, ColorModel model, int64_t paths) const;

    // Lines for reports.
    std::vector<std::string> describe(const World& world) const;

private:
    int64_t paths_;  // 0: auto
    float radius_pixels_;
    float fixed_radius_;  // [m], 0: auto
    double alpha_;
    KernelKind kernel_;
    int wavelength_sets_;
    int max_depth_;
    bool moving_;  // some shape moves
};

// Light of a photon at a vertex, towards the eye, times `weight` = K(d / r) / r^2 / emitted paths [1/m^2]; the share of
// photons is in it. wi: where the photon came from.
Spectrum photon_radiance(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi, const Spectrum& flux, PathClass path_class,
                         bool from_delta_light, float weight);

// One eye path: records guides, adds emission and direct light, and calls visit(walk, distance) at each visible point;
// distance is the length of the path [m].
template <class Visit>
void trace_visible_points(const World& world, EyeSample& sample, const std::optional<float>& time, int max_depth,
                          const Visit& visit)
{
    RandomStream& random = sample.random;
    const PathStart start = path_start(sample.wavelengths, random.next_2d(), time);
    Walk eye = start_at_camera(world, sample.raster, start, random);
    GuideRecorder guides(world, sample);
    float distance = 0.0f;
    float share = 1.0f;          // s of the last D, which the path has survived
    float caustic_share = 1.0f;  // the s it has for lights met through delta surfaces
    // Emission that is met after delta surfaces is a caustic at the last D: the path came here with probability s.
    const auto part = [&] { return eye.pdf_direction() > 0.0f ? 1.0f : caustic_share / share; };

    while (const Vertex* vertex = eye.next(world, random)) {
        guides.see(*vertex);
        distance += vertex->distance;
        if (vertex->emitter.valid())
            sample.add(met_emission(world, eye, true) * part(), classify(eye.events(), {}),
                       world.lights.list[vertex->emitter.value].group);
        if (eye.depth() > max_depth) return;
        if (eye.pdf_direction() > 0.0f) {  // photons at the last D brought the other part
            share = narrow_share(eye.pdf_direction());
            if (!(random.next() < share)) return;
            caustic_share = eye_share_of_caustic(eye.pdf_direction());
        }
        if (!vertex->is_delta()) {
            const DirectLight direct = direct_light(world, eye, *vertex, true, random);
            PathEvents events = eye.events();
            events.add_surface(false);
            if (direct.found) sample.add(direct.radiance, classify(events, {}), direct.group);
            visit(eye, distance);
        }
        if (eye.depth() > 1 && !eye.survive_roulette(random)) return;
    }
    if (eye.escaped())
        for (LightId light : world.environments)
            sample.add(met_environment(world, eye, light, true) * part(), classify(eye.events(), {}),
                       world.lights.list[light.value].group);
}

}  // namespace dapple
