// The film's sums, in one plane per layer. Planes come as zero pages from the system and are only touched by what is
// not zero: a layer nothing contributes to (caustics, volumes, most light groups) takes no memory. A touched plane of
// three channels takes 48 bytes a pixel. The beauty is the exact sum of the path classes where those are kept.
//
// Many threads add at once; tiles of pixels have locks. One lock for all that a splat or an eye sample brings costs
// less than locked additions of its 27 sums and more, and lets the processor wait for their memory at one time.
#pragma once

#include "dapple/film/error_sums.h"
#include "dapple/film/exact_sum.h"
#include "dapple/film/film.h"

#include <array>
#include <mutex>
#include <string>
#include <vector>

namespace dapple {

// One layer: its channels' names in the file and its sums, channels interleaved.
class Plane {
public:
    Plane(std::vector<std::string> channel_names, size_t pixels);

    int channels() const { return static_cast<int>(channel_names_.size()); }
    const std::vector<std::string>& channel_names() const { return channel_names_; }
    size_t size() const { return size_; }
    Fixed128* pixel(size_t index) { return &sums_[index * channel_names_.size()]; }
    const Fixed128* pixel(size_t index) const { return &sums_[index * channel_names_.size()]; }
    Fixed128* data() { return sums_.get(); }
    const Fixed128* data() const { return sums_.get(); }
    std::streamsize bytes() const { return static_cast<std::streamsize>(size_ * sizeof(Fixed128)); }

private:
    std::vector<std::string> channel_names_;
    size_t size_;
    std::unique_ptr<Fixed128[], void (*)(void*)> sums_;
};

struct Film::Sums {
    static constexpr int none = -1;
    static constexpr int tile = 16;  // pixels that share a lock, along an axis

    // The window must have been checked.
    explicit Sums(const FilmSettings& settings);

    Int2 crop_min, crop_size;
    std::vector<Plane> planes;
    int first_radiance = none;  // one plane per path class, or one for all
    int radiance_planes = 0;
    int first_group = none;
    size_t groups = 0;
    int albedo = none, normal = none, depth = none, position = none;
    int photon_density = none, photon_radius = none;

    size_t pixels() const { return size_t(crop_size.x) * crop_size.y; }
    bool contains(Int2 pixel) const
    {
        const Int2 local = pixel - crop_min;
        return local.x >= 0 && local.y >= 0 && local.x < crop_size.x && local.y < crop_size.y;
    }
    // Index of a pixel, which must be inside of the crop window.
    size_t index(Int2 pixel) const { return size_t(pixel.y - crop_min.y) * crop_size.x + (pixel.x - crop_min.x); }
    // Held by whoever adds to a pixel of the tile.
    std::mutex& lock_of_tile(Int2 tile_index) const
    {
        return locks_[(tile_index.y * 13 + tile_index.x) % lock_count].mutex;
    }
    Int2 tile_of(Int2 pixel) const { return {(pixel.x - crop_min.x) / tile, (pixel.y - crop_min.y) / tile}; }

    Plane& radiance(PathClass path_class)
    {
        return planes[radiance_planes == 1 ? first_radiance : first_radiance + static_cast<int>(path_class)];
    }
    // None for a group that the film does not know.
    Plane* group(LightGroup which) { return which.value < groups ? &planes[first_group + which.value] : nullptr; }
    Fixed128 beauty(size_t pixel, int channel) const
    {
        Fixed128 sum = 0;
        for (int i = 0; i < radiance_planes; ++i) sum += planes[first_radiance + i].pixel(pixel)[channel];
        return sum;
    }
    // The luminance of a pixel, for error estimates.
    ErrorSums::Luminance luminance() const
    {
        return
            [this](size_t pixel) { return ErrorSums::luminance(beauty(pixel, 0), beauty(pixel, 1), beauty(pixel, 2)); };
    }

private:
    static constexpr int lock_count = 256;
    struct alignas(64) Lock {  // a cache line each: threads would wait for each other's otherwise
        std::mutex mutex;
    };

    int add_plane(std::vector<std::string> channel_names);

    mutable std::array<Lock, lock_count> locks_;
};

}  // namespace dapple
