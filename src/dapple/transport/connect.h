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

// The density with which the vertex would sample its wo, had it been reached from wi.
float reverse_pdf(const Vertex& vertex, const Vec3& wi, TransportMode mode);

// What a straight line from a vertex lets through, to a point that is already offset from its surface.
Transmittance between(const World& world, const Vertex& from, const Vec3& to, const PathStart& start,
                      RandomStream& random);

// A vertex joined to a point of a light chosen by light sampling.
struct LightConnection {
    LightId light;
    DirectSample sample;
    Scattering scattering;     // towards the light
    float probability = 0.0f;  // of the choice of the light
    Transmittance through;
    Spectrum value;  // all factors; to be divided by the density below
    // Mean over lanes of the density of the path, light sampling included.
    Spectrum density(const Spectrum& path_pdf) const
    {
        return path_pdf * through.light_pdf * (probability * sample.pdf);
    }
};
// False where no light arrives.
bool connect_to_light(const World& world, const Carried& carried, const Vertex& vertex, RandomStream& random,
                      LightConnection& connection);

// Direct light at a vertex, estimated with one light sample.
struct DirectLight {
    Spectrum radiance;  // towards wo [W/(m2 sr nm)], MIS weight against scattering included
    LightGroup group{0u};
    Vec3 wi{0, 0, 1};  // unit, towards the light
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
    CameraConnection camera;
    Scattering scattering;  // towards the camera
    Spectrum contribution;  // to the pixel integral around raster, of this particle (not divided by their number)
};
bool connect_to_camera(const World& world, const Carried& carried, const Vertex& vertex, float margin,
                       RandomStream& random, SeenByCamera& seen);

}  // namespace dapple
