// The one random walk of Dapple, for eye and light subpaths, surfaces and media. The algorithm owns the loop and asks
// for the next vertex:
//
//     Walk walk = ...;                                    // from the camera, or emit() from a light
//     while (const Vertex* vertex = walk.next(world, random)) { ... use the vertex ... }
//
// next() scatters at the current vertex (if there is one), then travels to the next: through vacuum, or through media
// by delta tracking over piecewise majorants (Woodcock et al. 1965). Boundaries without a surface (interface materials)
// are crossed silently.
//
// Spectral tracking follows Wilkie et al. 2014 (hero wavelength) and Miller et al. 2019 ("A null-scattering path
// integral formulation of light transport"): decisions are made for one lane, and `path_pdf` holds for each lane the
// density of the same path had that lane decided, relative to the deciding lane's. A contribution is  throughput /
// mean(path_pdf) (balance heuristic over lanes); `light_pdf` is the same for the path whose last direction light
// sampling chose, per unit of light sampling density, so that MIS is  1 / mean(path_pdf + light_pdf * p_light). In
// vacuum path_pdf stays 1. Where dispersion parts the lanes, the deciding one alone goes on: throughput and densities
// are times four there and zero in the others, so that the same formulas hold.
#pragma once

#include "dapple/base/path_class.h"
#include "dapple/cameras/camera.h"
#include "dapple/materials/material.h"
#include "dapple/sampling/random_stream.h"
#include "dapple/world/world.h"

#include <optional>

namespace dapple {

// Where a walk meets a surface or is scattered by a medium.
struct Vertex {
    bool on_surface = true;
    SurfacePoint at;        // in a medium: only position, error (zero) and time
    Vec3 wo{0, 0, 1};       // unit, back along the walk
    Bsdf bsdf;              // surfaces
    float phase_g = 0.0f;   // media: Henyey-Greenstein mean cosine
    float distance = 0.0f;  // from the previous vertex along the ray; interfaces do not count as vertices [m]
    uint32_t geometry = 0;  // surfaces: index into World::geometries
    LightId emitter;        // surfaces: the area light that is met, if any
    MediumId medium;        // the medium on the side of wo (surfaces), or the one that scatters

    // Nothing can be connected to or stored at this vertex.
    bool is_delta() const { return on_surface && bsdf.is_delta(); }
    // A walk may leave by a delta lobe: the mirror reflection of a smooth coat counts, whatever lies beneath it.
    bool has_delta_lobe() const;
};

// What is chosen once for a path before its first ray.
struct PathStart {
    Wavelengths wavelengths;
    float time = 0.0f;
    int kept_lane = 0;  // the lane that decides
};

// What a subpath brings to a vertex, for connections to it: light on its way from the source, or the eye's share.
struct Carried {
    Spectrum throughput;  // source included: flux [W], or importance
    Spectrum path_pdf{1.0f};
    PathStart start;
};

class Walk {
public:
    Walk() = default;
    // source: what one unit of throughput stands for: emitted flux [W], or 1 for the eye.
    Walk(const Ray& ray, MediumId medium, TransportMode mode, const Wavelengths& wavelengths, int kept_lane,
         const Spectrum& source);

    // The next vertex, or null when the walk was absorbed or has left the scene. Valid until the next call.
    const Vertex* next(const World& world, RandomStream& random)
    {
        return leave(world, random) ? arrive(world, random) : nullptr;
    }
    // The same in two steps, for those whom the new direction tells whether to go on: scatters at the current vertex
    // (if there is one; false: absorbed), and travels to the next.
    bool leave(const World& world, RandomStream& random);
    const Vertex* arrive(const World& world, RandomStream& random);

    // Ends the walk with the probability that its throughput has lost; true: it goes on, with its throughput raised.
    // coming: about what the next scattering will leave, where its loss is to count already: saves the ray to a vertex
    // that would be the end. Any value above 0 is right on average.
    bool survive_roulette(RandomStream& random, const Spectrum& coming = Spectrum(1.0f));

    bool escaped() const { return escaped_; }
    const Ray& ray() const { return ray_; }  // the last ray, from the last vertex
    const Vertex& vertex() const { return vertex_; }

    // Flux (or importance) that arrives at the current vertex, density of the deciding lane divided out.
    Spectrum arriving() const { return source_ * throughput_ * (1.0f / path_pdf_.average()); }
    Spectrum source() const { return source_; }
    Spectrum throughput() const { return throughput_; }
    Spectrum path_pdf() const { return path_pdf_; }
    Spectrum light_pdf() const { return light_pdf_; }

    Carried carried() const { return {source_ * throughput_, path_pdf_, {wavelengths_, ray_.time, kept_lane_}}; }

    // Radiance times throughput that emitting media added on the way to the current vertex (or out of the scene).
    const Spectrum& medium_emission() const { return medium_emission_; }

    // Density per solid angle of the direction of the last ray, for MIS with light sampling; 0 when it left a delta
    // lobe or the camera, where light sampling cannot compete.
    float pdf_direction() const { return pdf_direction_; }

    // The density with which the previous vertex would have sampled its wo, had its light come along the last ray, and
    // the last ray's cosine there to the geometric normal (1 in a medium). Kept from the next vertex on once asked for.
    void keep_reverse_density() { keeps_reverse_ = true; }
    float pdf_reverse() const { return pdf_reverse_; }
    float cosine_out() const { return cosine_out_; }

    // Scattering events so far: those of the vertices left behind; the current vertex is not yet counted.
    const PathEvents& events() const { return events_; }
    int depth() const { return depth_; }  // vertices met so far, the current one included
    const Wavelengths& wavelengths() const { return wavelengths_; }
    int kept_lane() const { return kept_lane_; }
    MediumId medium() const { return medium_; }

    // The last point from which light sampling could have chosen the current ray: position of the previous vertex.
    const Vec3& previous_position() const { return previous_position_; }

    LightGroup light_group{0u};

private:
    bool scatter(const World& world, RandomStream& random);
    bool scatters_in_medium(const World& world, float t_max, RandomStream& random);
    void keep_only_lane();

    Ray ray_;
    Spectrum source_;
    Spectrum throughput_{1.0f};
    Spectrum path_pdf_{1.0f};
    Spectrum light_pdf_{0.0f};
    Spectrum medium_emission_;
    Wavelengths wavelengths_;
    Vertex vertex_;
    Vec3 previous_position_{0, 0, 0};
    PathEvents events_;
    MediumId medium_;
    float pdf_direction_ = 0.0f;
    float pdf_reverse_ = 0.0f;
    float cosine_out_ = 1.0f;
    float eta_scale_ = 1.0f;  // radiance: undoes refraction's 1/eta^2 for roulette
    int kept_lane_ = 0;
    int depth_ = 0;
    bool at_vertex_ = false;
    bool single_lane_ = false;
    bool escaped_ = false;
    bool keeps_reverse_ = false;
    TransportMode mode_ = TransportMode::radiance;
};

// Time, unless it is given, and deciding lane drawn from u.
inline PathStart path_start(const Wavelengths& wavelengths, const Vec2& u, const std::optional<float>& time = {})
{
    return {wavelengths, time.value_or(u.x), std::min(static_cast<int>(u.y * Spectrum::lanes), Spectrum::lanes - 1)};
}

// The walk of an eye path through a raster position; without a start its time and lane are drawn.
Walk start_at_camera(const World& world, const Vec2& raster, const PathStart& start, RandomStream& random);
Walk start_at_camera(const World& world, const Vec2& raster, const Wavelengths& wavelengths, RandomStream& random);

}  // namespace dapple
