// Camera, film, filter, sampler, integrator and options: how the picture is taken.
#pragma once

#include "dapple/scene/values.h"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace dapple::scene {

struct Camera {
    enum class Kind : uint8_t { perspective, orthographic, spherical };
    enum class SphericalMapping : uint8_t { equal_area, equirectangular };
    Kind kind = Kind::perspective;
    SphericalMapping mapping = SphericalMapping::equal_area;
    MovingMatrix world_from_camera;  // camera space: x right, y up, z forward (left-handed)
    float fov = 90.0f;               // [degrees] along the shorter axis of the image
    float lens_radius = 0.0f;
    float focal_distance = 1e6f;
    std::optional<float> frame_aspect_ratio;            // none: the film's
    std::optional<std::array<float, 4>> screen_window;  // x min, x max, y min, y max; none: from the aspect ratio
    float shutter_open = 0.0f, shutter_close = 1.0f;    // [s]
    MediumIndex medium;
    SourceLocation at;
};

struct Film {
    enum class Kind : uint8_t { rgb, gbuffer };
    Kind kind = Kind::rgb;
    bool guides_in_camera_space = true;  // gbuffer: normals and positions in camera space, else world space
    Int2 resolution{1280, 720};
    Int2 crop_min{0, 0}, crop_max{1280, 720};  // pixels, half open; inside the resolution, not empty
    std::string filename = "dapple.exr";
    bool half_precision = true;  // "savefp16"
    float diagonal = 35.0f;      // [mm]
    std::string sensor = "cie1931";
    float iso = 100.0f;
    float white_balance = 0.0f;  // [K]; 0: none given
    ColorSpace color_space = ColorSpace::srgb;
    SourceLocation at;

    // pbrt's exposure: (shutter close - shutter open) * iso / 100.
    float imaging_ratio(const Camera& camera) const
    {
        return (camera.shutter_close - camera.shutter_open) * iso / 100.0f;
    }
};

struct Filter {
    enum class Kind : uint8_t { box, triangle, gaussian, mitchell, sinc };
    Kind kind = Kind::gaussian;
    Vec2 radius{1.5f, 1.5f};  // [pixels]
    float sigma = 0.5f;
    float b = 1.0f / 3.0f, c = 1.0f / 3.0f;
    float tau = 3.0f;
    SourceLocation at;
};

struct Sampler {
    std::string name = "zsobol";
    int pixel_samples = 16;
    std::optional<int> seed;
    SourceLocation at;
};

// A parameter of the integrator; its text is a number, "true", "false" or a word.
struct IntegratorParameter {
    std::string name;
    std::string value;
    SourceLocation at;
};
struct Integrator {
    std::string name = "volpath";
    std::vector<IntegratorParameter> parameters;
    SourceLocation at;  // empty when the scene names none
};

struct Options {
    int seed = 0;
    bool disable_pixel_jitter = false;
    bool disable_wavelength_jitter = false;
    bool force_diffuse = false;
    bool pbrt_coat_weights = false;  // rough coats as bright as pbrt-v4's, which are not quite right; no file sets it
};

}  // namespace dapple::scene
