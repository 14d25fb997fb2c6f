// The film: exact sums of what passes contribute, per pixel and layer. Order-independent, so that neither thread count
// nor machine count shows (see exact_sum.h). The image is the sums divided by the number of passes.
#pragma once

#include "dapple/base/path_class.h"
#include "dapple/film/error_sums.h"
#include "dapple/film/filter.h"
#include "dapple/film/sensor.h"
#include "dapple/image/image.h"
#include "dapple/spectrum/wavelengths.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

namespace dapple {

// What one eye path brings to its pixel besides radiance; averaged over samples.
struct Guides {
    Vec3 albedo{0, 0, 0};    // linear sRGB
    Vec3 normal{0, 0, 0};    // shading; world space, or the camera's (FilmSettings::guides_in_camera_space)
    Vec3 position{0, 0, 0};  // in the same space [m]
    float depth = 0.0f;      // distance from the camera along its axis [m]
};

// The contributions of one eye path (or of all of a pixel's paths in a pass), as sensor RGB by class and group.
class PixelSample {
public:
    // light_groups: how many the film has (FilmSettings::light_groups).
    explicit PixelSample(int light_groups) : group_rgb_(light_groups, Vec3(0)) {}
    int light_groups() const { return static_cast<int>(group_rgb_.size()); }
    // Back to nothing, without freeing memory.
    void clear();
    // Adds a contribution; one that is not finite is dropped, and counted when the film gets the sample.
    void add(const Vec3& sensor_rgb, PathClass path_class, LightGroup group)
    {
        if (!is_finite(sensor_rgb)) {
            ++dropped_;
            return;
        }
        class_rgb_[static_cast<int>(path_class)] += sensor_rgb;
        classes_ |= 1u << static_cast<int>(path_class);
        if (group.value < group_rgb_.size()) group_rgb_[group.value] += sensor_rgb;
    }
    Guides guides;
    float photon_density = 0.0f;  // photons per area at the first gather point [1/m^2]
    float radius = 0.0f;          // bandwidth at the first gather point [m]

private:
    friend class Film;
    std::array<Vec3, path_class_count> class_rgb_ = {Vec3(0), Vec3(0), Vec3(0), Vec3(0), Vec3(0)};
    std::vector<Vec3> group_rgb_;
    uint32_t classes_ = 0;  // those that something was added to, as bits
    uint64_t dropped_ = 0;
};

struct FilmSettings {
    Int2 resolution{1280, 720};
    Int2 crop_min{0, 0};  // pixel bounds that are rendered and written, half open
    Int2 crop_max{1280, 720};
    Filter filter;
    Sensor sensor;
    ColorModel color_model = ColorModel::spectral;  // what integrators render in
    bool pixel_centers = false;                     // eye paths start in the middle of their pixel, unfiltered
    // Names of the light groups, by LightGroup::value: the first is that of the lights without a name and may be "".
    // No names: no group layers.
    std::vector<std::string> light_groups;
    bool class_layers = true;  // direct, caustic, ...
    bool guide_layers = true;  // Albedo, N, Z, P
    bool guides_in_camera_space = false;
    bool photon_layers = false;  // photon density, radius

    // Sums for error estimates and the layers "error" (error_sums.h); they need to know which passes there are.
    bool error_layer = false;
    uint32_t first_pass = 0;         // the first pass this film gets
    uint32_t correlated_passes = 1;  // as Integrator's
    bool fading_bias = false;        // whether bias_scale is anything but 0
    std::function<double(uint32_t pass)> bias_scale;
};

// What a light group is called in layers: lights without a name are in the group "default".
inline std::string light_group_label(const std::string& name) { return name.empty() ? "default" : name; }

// Contributions dropped because they were not finite, or too large for the sums (1.8e13), by cause.
struct Accidents {
    std::atomic<uint64_t> eye_sample{0};
    std::atomic<uint64_t> splat{0};
};

class Film {
public:
    // Throws UserError for an empty crop window or one that leaves the raster, or two light groups of one name.
    explicit Film(FilmSettings settings);
    ~Film();
    Film(const Film&) = delete;
    Film& operator=(const Film&) = delete;

    const FilmSettings& settings() const { return settings_; }
    Int2 resolution() const { return settings_.resolution; }

    // Asks for the memory of a pixel of the crop window, long before add_pixel wants it. Changes nothing.
    void prefetch_pixel(Int2 pixel) const;

    // Adds the mean of a pixel's eye samples in this pass. Called by one thread per pixel and pass.
    // `sample` holds the sum over `samples` eye paths. A pixel outside of the crop window is ignored.
    void add_pixel(Int2 pixel, const PixelSample& sample, int samples);

    // Adds a light path's contribution, already divided by the number of light paths of the pass, at a raster position;
    // spread by the pixel filter. Thread-safe and order-independent. Positions outside of the raster by less than the
    // filter's radius count too: without them the border pixels would come out too dark.
    void splat(const Vec2& raster, const Vec3& sensor_rgb, PathClass path_class, LightGroup group);

    // Adds a light path's contribution to one pixel, as it is: for those who know whose eye sample it belongs to.
    // Thread-safe and order-independent. A pixel outside of the crop window is ignored.
    void add_to_pixel(Int2 pixel, const Vec3& sensor_rgb, PathClass path_class, LightGroup group);

    // Adds the sums of a film with the same light groups and classes, and no other layers, times a factor: light that
    // was kept apart while nobody knew what it is to be divided by. Exact for a factor of 1.
    void add_light(const Film& other, double factor);

    // Call once after each pass; passes come in order, from settings().first_pass on.
    void end_pass();
    // Instead of end_pass after a pass that was cut: the pixels that it reached have a sample more than the others, and
    // the image allows for that; if it was the first, other pixels show the nearest that it reached. `before`: layers()
    // without that pass, which the others show; needed after the first pass where not all light comes by add_pixel.
    // From now on the film can only be shown: neither continued, nor written, nor merged. Not for films with the error
    // layer.
    void end_cut_pass(Image before = {});
    bool cut() const { return cut_; }
    // Says that what the running pass has added so far is of no use, not even for the pixels that it reached.
    void give_up_pass() { std::fill(reached_.begin(), reached_.end(), uint8_t{0}); }
    // Part of the pixels that have an eye sample of the running (or cut) pass, in [0, 1].
    double reached_part() const
    {
        const auto count = std::count(reached_.begin(), reached_.end(), uint8_t{1});
        return static_cast<double>(count) / static_cast<double>(reached_.size());
    }
    uint32_t passes() const { return passes_; }
    const Accidents& accidents() const { return accidents_; }

    // The image of the crop window so far, three channels. Call it and layers() between passes only.
    Image beauty() const;
    // All layers as one image, with OpenEXR channel names ("R", "Albedo.R", "N.X", "Z", "direct.R", ...); see
    // layers.md.
    Image layers(std::vector<std::string>& channel_names) const;

    // So many rows from all over layers(), about as they would be shown now: to see how well they compress. May be
    // called while a pass adds to the film, but not while one ends.
    Image sample_rows(int rows) const;

    // How far the image is off; nothing is known (no batches) without FilmSettings::error_layer. Cost: as beauty().
    ErrorEstimate error() const;

    // Adds the passes of a film of the same settings: the result is that of one film that saw all passes, bit by bit.
    // Throws UserError if the layers or the crop windows differ.
    void merge(const Film& other);
    // The exact sums, pass count and accidents as bytes (little endian), for checkpoints and for merging between
    // machines. read_state replaces this film's sums; it throws UserError if the bytes are not a whole state of a film
    // with these layers and this crop window.
    void write_state(std::ostream& out) const;
    void read_state(std::istream& in);

private:
    struct Sums;
    std::string state_header() const;
    // For each pixel, the one whose sums it shows; none where each shows its own.
    std::vector<uint32_t> shown_pixels() const;
    // What a pixel shows instead of sums, if a cut pass did not reach it; else nullptr.
    const float* shown_before(size_t pixel) const
    {
        const bool instead = !before_.pixels.empty() && reached_[pixel] == 0;
        return instead ? &before_.pixels[pixel * static_cast<size_t>(before_.channels)] : nullptr;
    }
    // What the sums of a pixel are multiplied by in the image.
    double image_factor(size_t pixel) const
    {
        const uint32_t samples = passes_ + (cut_ ? reached_[pixel] : 0);
        return 1.0 / std::max<uint32_t>(samples, 1);
    }

    FilmSettings settings_;
    std::unique_ptr<Sums> sums_;
    std::unique_ptr<ErrorSums> errors_;  // none unless asked for
    Accidents accidents_;
    uint32_t passes_ = 0;
    std::vector<uint8_t> reached_;  // by pixel: whether the running pass has brought an eye sample
    bool cut_ = false;              // the last pass was
    Image before_;                  // layers without the cut pass; or empty
};

}  // namespace dapple
