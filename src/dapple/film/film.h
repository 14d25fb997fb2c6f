// The film: exact sums of what passes contribute, per pixel and layer. Order-independent, so that neither thread count
// nor machine count shows (see exact_sum.h). The image is the sums divided by the number of passes.
#pragma once

#include "dapple/base/path_class.h"
#include "dapple/film/filter.h"
#include "dapple/film/sensor.h"
#include "dapple/image/image.h"
#include "dapple/spectrum/wavelengths.h"

#include <array>
#include <atomic>
#include <memory>
#include <string>
#include <vector>

namespace dapple {

// What one eye path brings to its pixel besides radiance; averaged over samples.
struct Guides {
    Vec3 albedo{0, 0, 0};    // linear sRGB
    Vec3 normal{0, 0, 0};    // world space, shading
    Vec3 position{0, 0, 0};  // world space [m]
    float depth = 0.0f;      // distance from the camera along its axis [m]
};

// The contributions of one eye path (or of all of a pixel's paths in a pass), as sensor RGB by class and group.
class PixelSample {
public:
    explicit PixelSample(int light_groups) : group_rgb_(light_groups, Vec3(0)) {}
    void clear();
    void add(const Vec3& sensor_rgb, PathClass path_class, LightGroup group)
    {
        class_rgb_[static_cast<int>(path_class)] += sensor_rgb;
        if (!group_rgb_.empty()) group_rgb_[group.value] += sensor_rgb;
    }
    Guides guides;
    float photon_density = 0.0f;  // photons per area at the first gather point [1/m^2]
    float radius = 0.0f;          // bandwidth at the first gather point [m]

private:
    friend class Film;
    std::array<Vec3, path_class_count> class_rgb_{};
    std::vector<Vec3> group_rgb_;
};

struct FilmSettings {
    Int2 resolution{1280, 720};
    Int2 crop_min{0, 0};           // pixel bounds that are rendered and written, half open
    Int2 crop_max{1280, 720};
    Filter filter;
    Sensor sensor;
    std::vector<std::string> light_groups;  // names; empty: no group layers
    bool class_layers = true;      // direct, caustic, ...
    bool guide_layers = true;      // Albedo, N, Z, P
    bool photon_layers = false;    // photon density, radius
};

// Samples dropped because they were not finite, by cause.
struct Accidents {
    std::atomic<uint64_t> eye_sample{0};
    std::atomic<uint64_t> splat{0};
};

class Film {
public:
    explicit Film(FilmSettings settings);
    ~Film();

    const FilmSettings& settings() const { return settings_; }
    Int2 resolution() const { return settings_.resolution; }

    // Adds the mean of a pixel's eye samples in this pass. Called by one thread per pixel and pass.
    // `sample` holds the sum over `samples` eye paths.
    void add_pixel(Int2 pixel, const PixelSample& sample, int samples);

    // Adds a light path's contribution, already divided by the number of light paths of the pass, at a raster position;
    // spread by the pixel filter. Thread-safe and order-independent.
    void splat(const Vec2& raster, const Vec3& sensor_rgb, PathClass path_class, LightGroup group);

    // Call once after each pass.
    void end_pass();
    uint32_t passes() const { return passes_; }
    const Accidents& accidents() const { return accidents_; }

    // The image of the crop window so far. Layer names: see layer_names().
    Image beauty() const;
    // All layers as one image, with OpenEXR channel names ("R", "Albedo.R", "N.X", "Z", "direct.R", ...).
    Image layers(std::vector<std::string>& channel_names) const;

private:
    struct Sums;
    FilmSettings settings_;
    std::unique_ptr<Sums> sums_;
    Accidents accidents_;
    uint32_t passes_ = 0;
};

}  // namespace dapple
