// Connections of a vertex: to a light (next-event estimation) and to the camera (the t = 1 technique of light tracing).
#pragma once

#include "dapple/transport/medium_crossing.h"
#include "dapple/transport/walk.h"

namespace dapple {

// What the scattering at a vertex does to light from wi: f times the cosine factor of the mode (surfaces), or the phase
// function (media), and the density with which the walk would sample wi.
struct Scattering {
    Spectrum value;
    float pdf = 0.0f;
};
Scattering evaluate_scattering(const Vertex& vertex, const Vec3& wi, TransportMode mode);

// Direct light at a vertex, estimated with one light sample.
struct DirectLight {
    Spectrum radiance;  // towards wo [W/(m2 sr nm)], MIS weight against scattering included
    LightGroup group{0u};
    bool found = false;
};
// weigh: true: weighted by the balance heuristic for use beside emission met by scattering (see emission_weight);
// false: the whole direct light, by light sampling alone.
DirectLight direct_light(const World& world, const Walk& walk, const Vertex& vertex, bool weigh, RandomStream& random);

// The emission an eye walk meets at its current vertex (area light), with the MIS weight that complements direct_light;
// path_pdf divided out. Add to nothing but the throughput-free film: it includes walk.source() and throughput().
Spectrum met_emission(const World& world, const Walk& walk, bool weigh);
// The same for a walk that has escaped: one environment light.
Spectrum met_environment(const World& world, const Walk& walk, LightId light, bool weigh);

// A vertex of a light walk seen by the camera.
struct SeenByCamera {
    Vec2 raster{0, 0};
    Spectrum contribution;  // to the pixel integral around raster, of this particle (not divided by their number)
};
bool connect_to_camera(const World& world, const Walk& walk, const Vertex& vertex, float margin, RandomStream& random,
                       SeenByCamera& seen);

}  // namespace dapple
