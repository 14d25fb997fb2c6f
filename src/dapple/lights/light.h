// Lights as the compiled world holds them: one small value per emitter (each triangle of an emissive mesh is one), and
// free functions to sample direct light, to start light paths, and to evaluate. Radiometric units: W, sr, m.
//
// Conventions. Point-like and distant lights have a space of their own whose origin is the light and whose z axis is
// where it shines to; only the position and the directions of the axes of world_from_light count, not their lengths.
// Environments do not move (they are taken at shutter open); nor do area lights, whose shape is in world space. An area
// light of alpha 0 cannot be met by rays and yet emits in full (as in pbrt-v4): it is sampled as a delta light.
#pragma once

#include "dapple/base/path_class.h"
#include "dapple/materials/texture.h"
#include "dapple/math/ray.h"
#include "dapple/math/transform.h"
#include "dapple/sampling/piecewise.h"
#include "dapple/shapes/primitive.h"
#include "dapple/spectrum/spectrum_value.h"

#include <cstdint>
#include <vector>

namespace dapple {

struct LightTag {};
using LightId = Id<LightTag>;
struct MediumTag {};
using MediumId = Id<MediumTag>;

struct Light {
    enum class Kind : uint8_t { point, spot, distant, area, environment, environment_image, goniometric, projection };
    Kind kind = Kind::point;
    bool two_sided = false;  // area
    SpectrumValue spectrum;  // L [W/(m2 sr nm)] (area, distant, environment) or I [W/(sr nm)]; scale included
    uint32_t image = Id<int>::none_value;  // radiance or intensity map (index into Lights::images), multiplies spectrum
    AnimatedTransform world_from_light;    // all but area lights
    float cos_total = -1, cos_falloff = -1;  // spot: cosines of cone angle and of the start of the falloff
    float screen_half[2] = {1, 1};  // projection: half extent of the image on the plane z = 1; its top is at +y
    SampledShape shape;             // area: its geometry in world space
    float alpha = 1.0f;             // area: constant alpha of the shape
    FloatTextureId alpha_texture;   // area: its textured alpha, if any; whoever samples the light multiplies it in
    LightGroup group{0u};
    MediumId medium;         // the medium around a point, spot, ... light; area: on its outside
    MediumId medium_inside;  // area: behind it
};

// Whether a ray can meet the light: area lights (but those of alpha 0) and environments.
inline bool can_be_met(const Light& light)
{
    switch (light.kind) {
        case Light::Kind::area: return light.alpha > 0.0f;
        case Light::Kind::environment:
        case Light::Kind::environment_image: return true;
        default: return false;
    }
}

// An image map of a light, with the distribution to sample it; made by make_light.h. Environment and goniometric maps
// use pbrt's equal-area octahedral layout. Pixels are constant over their squares, so that densities are exact.
struct LightImage {
    Image pixels;  // 1 channel: scale; 3 channels: linear sRGB, upsampled without a white
    Distribution2D
        distribution;  // over [0,1]^2 of the image, in proportion to the mean of the channels per solid angle
    float mean_luminance = 0.0f;  // of the pixels, over the sphere, the image of a projector per solid angle, or (u, v)
};

struct Lights {
    std::vector<Light> list;
    std::vector<LightImage> images;
    // Bounding sphere of everything, for far lights.
    Vec3 scene_center{0, 0, 0};
    float scene_radius = 1.0f;
};

// Direct light at a point. wi points to the light.
struct DirectSample {
    Vec3 wi{0, 0, 1};
    float distance = 0.0f;  // to the light's point; infinity for far lights
    Spectrum radiance;      // incident radiance, or for delta lights irradiance normal to wi (I / d^2)
    float pdf = 0.0f;       // per solid angle at the reference point; 1 for delta lights
    bool delta = false;
    Vec3 position{0, 0, 0};  // point on the light (near lights), offset for a shadow ray
    Vec3 error{0, 0, 0};     // its error bound
    Vec3 normal{0, 0, 0};    // area lights: unit normal at position
    Vec2 uv{0, 0};           // area lights: surface parameters there
};

// False when the light cannot reach the point. Does not trace.
bool sample_direct(const Lights& lights, const SpectrumPool& pool, LightId id, const Vec3& reference, float time,
                   const Vec2& u, const Wavelengths& wavelengths, DirectSample& sample);

// The density with which sample_direct picks wi from the reference point, given that a ray met area light `id` at `at`
// (unit normal n), or escaped (environment lights). Per solid angle.
float direct_pdf_area(const Lights& lights, LightId id, const Vec3& reference, const Vec3& wi, const Vec3& at,
                      const Vec3& n);
float direct_pdf_environment(const Lights& lights, LightId id, const Vec3& wi);

// Emitted radiance of an area light at a point of its surface towards w (away from the surface).
Spectrum emitted_area(const Lights& lights, const SpectrumPool& pool, LightId id, const Vec2& uv, const Vec3& n,
                      const Vec3& w, const Wavelengths& wavelengths);
// Radiance of an environment light that arrives along a ray of direction d (away from the scene).
Spectrum emitted_environment(const Lights& lights, const SpectrumPool& pool, LightId id, const Vec3& d,
                             const Wavelengths& wavelengths);

// A particle leaving a light.
struct EmissionSample {
    Ray ray;                       // origin on the light (or on the scene's silhouette disc for far lights)
    Vec3 error{0, 0, 0};           // error bound of the origin (area lights)
    Vec3 normal{0, 0, 0};          // area lights
    Vec2 uv{0, 0};                 // area lights
    Spectrum flux;                 // Le cos / (pdf_position pdf_direction) [W], for this light chosen with certainty
    float pdf_position = 0.0f;     // per area; 1 for point-like lights
    float pdf_direction = 0.0f;    // per solid angle; 1 for distant lights
    bool delta_position = false;   // point-like lights
    bool delta_direction = false;  // distant lights
};
bool sample_emission(const Lights& lights, const SpectrumPool& pool, LightId id, const Vec2& u_position,
                     const Vec2& u_direction, float time, const Wavelengths& wavelengths, EmissionSample& sample);

// The densities with which sample_emission lets a particle leave light `id` towards w (unit, away from the light), at
// `position` with unit normal n (area lights only). Far lights: position is the density on the silhouette disc. For
// the delta parts of a light (see EmissionSample) the density is 1, as in its samples.
struct EmissionDensity {
    float position = 0.0f;   // per area
    float direction = 0.0f;  // per solid angle
};
EmissionDensity emission_density(const Lights& lights, LightId id, float time, const Vec3& position, const Vec3& n,
                                 const Vec3& w);

// Total emitted power over all wavelengths as luminance-like scalar (Y-weighted W), to distribute samples and photons.
float power(const Lights& lights, const SpectrumPool& pool, LightId id);

}  // namespace dapple
