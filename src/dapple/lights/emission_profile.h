// What lights look like from afar: their own axes, the falloff of a spot, and lookups in their images. Shared by direct
// sampling (direct.cpp) and by the start of light paths (emission.cpp), so that the two cannot disagree.
#pragma once

#include "dapple/lights/light.h"
#include "dapple/math/frame.h"
#include "dapple/sampling/equal_area.h"
#include "dapple/sampling/warps.h"

namespace dapple::lights_detail {

// Position and orthonormal axes of a light. Axes may be left-handed, where the transform mirrors.
struct LightAxes {
    Vec3 origin;
    Frame axes;

    explicit LightAxes(const Transform& world_from_light) : origin(world_from_light.point(Vec3(0.0f)))
    {
        const Vec3 z = normalize(world_from_light.vector(Vec3(0, 0, 1)));
        axes = Frame::from_normal_tangent(z, world_from_light.vector(Vec3(1, 0, 0)));
        if (world_from_light.swaps_handedness()) axes.t = -axes.t;
    }
    static LightAxes of(const Light& light, float time)
    {
        if (light.world_from_light.moves()) return LightAxes(light.world_from_light.at(time));
        return LightAxes(light.world_from_light.start());
    }
};

inline bool has_image(const Light& light) { return light.image != Id<int>::none_value; }

// Smoothstep from 0 at cos_total to 1 at cos_falloff, as pbrt-v4's spots have it.
inline float spot_falloff(const Light& light, float cosine)
{
    if (cosine >= light.cos_falloff) return 1.0f;
    if (cosine <= light.cos_total) return 0.0f;
    const float t = (cosine - light.cos_total) / (light.cos_falloff - light.cos_total);
    return t * t * (3.0f - 2.0f * t);
}

// Solid angle of a spot's full part, and of its falloff part times the mean falloff there (one half) [sr].
inline float spot_core(const Light& light) { return 2.0f * pi * (1.0f - light.cos_falloff); }
inline float spot_rim(const Light& light) { return pi * (light.cos_falloff - light.cos_total); }

// The pixel that holds a point of [0,1]^2 (v = 0 is the top row), as a spectrum to multiply the light's with.
Spectrum image_spectrum(const LightImage& image, const SpectrumPool& pool, const Vec2& uv,
                        const Wavelengths& wavelengths);

// Where a projector's direction (in its own space) meets its image; false when beside it or behind.
inline bool projection_uv(const Light& light, const Vec3& w, Vec2& uv)
{
    if (!(w.z > 0.0f)) return false;
    uv.x = 0.5f * (1.0f + w.x / (w.z * light.screen_half[0]));
    uv.y = 0.5f * (1.0f - w.y / (w.z * light.screen_half[1]));
    return uv.x >= 0.0f && uv.x <= 1.0f && uv.y >= 0.0f && uv.y <= 1.0f;
}

// What the intensity of a point, spot, goniometric or projection light in direction w (unit, light space) is, relative
// to its spectrum.
Spectrum relative_intensity(const Lights& lights, const SpectrumPool& pool, const Light& light, const Vec3& w,
                            const Wavelengths& wavelengths);

// The radiance of an area light at (u, v) of its surface, on a side that emits.
Spectrum area_radiance(const Lights& lights, const SpectrumPool& pool, const Light& light, const Vec2& uv,
                       const Wavelengths& wavelengths);

}  // namespace dapple::lights_detail
