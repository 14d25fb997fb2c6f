// Lights. `scale` and `power` mean what they mean in pbrt-v4: without `power`, spectra are scaled so that their
// luminance (or luminous intensity) is `scale`; with it, the emitted luminous power is `power` [lm] times `scale`.
#pragma once

#include "dapple/scene/values.h"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace dapple::scene {

// Point, spot and distant lights look along +z of their own space; `from` and `to` are in that space too.
struct PointLight {
    SpectrumSource intensity{White{}};
    Vec3 from{0, 0, 0};
};
struct SpotLight {
    SpectrumSource intensity{White{}};
    Vec3 from{0, 0, 0}, to{0, 0, 1};
    float cone_angle = 30.0f;       // [degrees] half angle of the cone
    float cone_delta_angle = 5.0f;  // [degrees] the falloff starts this much inside
};
struct DistantLight {
    SpectrumSource radiance{White{}};
    Vec3 from{0, 0, 0}, to{0, 0, 1};
    std::optional<float> illuminance;  // [lx] on a surface that faces the light
};
struct InfiniteLight {
    std::optional<SpectrumSource> radiance;  // none with an image
    std::filesystem::path file;              // equal-area octahedral map; empty: constant
    std::optional<float> illuminance;        // [lx] on the plane z = 0 of light space, from above
    std::vector<Vec3> portal;                // four corners in light space, or empty
};
struct GoniometricLight {
    SpectrumSource intensity{White{}};
    std::filesystem::path file;  // equal-area octahedral map of relative intensity; empty: isotropic
};
struct ProjectionLight {
    std::filesystem::path file;
    float fov = 90.0f;  // [degrees] along the shorter axis of the image
};

struct Light {
    std::variant<PointLight, SpotLight, DistantLight, InfiniteLight, GoniometricLight, ProjectionLight> kind;
    float scale = 1.0f;
    std::optional<float> power;  // [lm]; point, spot, goniometric and projection lights
    MovingMatrix world_from_light;
    MediumIndex medium;       // around the light
    std::string light_group;  // our extension "string lightgroup"; empty: the group without a name
    ColorSpace color_space = ColorSpace::srgb;
    SourceLocation at;
};

// Makes a shape emit; one of these may be shared by many shapes.
struct AreaLight {
    std::optional<SpectrumSource> radiance;  // none: the image, or the white of the colour space
    std::filesystem::path file;              // radiance over (u, v); empty: none
    float scale = 1.0f;
    std::optional<float> power;  // [lm]
    bool two_sided = false;
    std::string light_group;
    ColorSpace color_space = ColorSpace::srgb;
    SourceLocation at;
};

}  // namespace dapple::scene
