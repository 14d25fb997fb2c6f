// What all eye passes share: pixels in tiles, a random stream and wavelengths per sample, sums into the film.
#pragma once

#include "dapple/base/parallel.h"
#include "dapple/integrators/integrator.h"
#include "dapple/transport/walk.h"

namespace dapple {

// Random streams are told apart by purpose, so that no two parts of a program share numbers.
enum class StreamPurpose : uint64_t {
    pixel = 1,
    photon = 2,
    wavelength_set = 3,
    splat = 4,
    shutter = 5,
    light_subpath = 6,
    cache_record = 7
};

inline RandomStream pixel_stream(uint64_t seed, Int2 pixel, uint32_t sample)
{
    const uint64_t id = (uint64_t(uint32_t(pixel.y)) << 32) | uint32_t(pixel.x);
    return RandomStream(seed, hash_words(static_cast<uint64_t>(StreamPurpose::pixel), id), sample);
}

inline Wavelengths choose_wavelengths(ColorModel model, float u)
{
    if (model == ColorModel::rgb) return Wavelengths::rgb();
    return Wavelengths::sample_visible(model == ColorModel::fixed_spectral ? 0.5f : u);
}

// With PassContext::coarse_to_fine: the least of a first pass that makes a picture.
uint64_t pixels_of_first_round(const FilmSettings& settings);

// One eye sample of a pixel: everything that its contributions need on their way to the film.
struct EyeSample {
    Int2 pixel;
    Vec2 raster;
    Wavelengths wavelengths;
    Sensor::LaneColors colors;
    float filter_weight;
    PixelSample& sums;
    RandomStream& random;
    bool guides_in_camera_space = false;

    // What the pixel's filter makes of radiance, in sensor RGB.
    Vec3 filtered(const Spectrum& radiance) const { return colors.to_rgb(radiance) * filter_weight; }
    void add(const Spectrum& radiance, PathClass path_class, LightGroup group) const
    {
        sums.add(filtered(radiance), path_class, group);
    }
};

// Where in a block of 4 x 4 the one of a round is (PassContext::coarse_to_fine): ever finer grids, each as even as can
// be.
inline Int2 place_in_round(int round)
{
    const int a = round & 1, b = (round >> 1) & 1, c = (round >> 2) & 1, d = (round >> 3) & 1;
    return {2 * a + c, 2 * (a ^ b) + (c ^ d)};
}

// Calls trace(EyeSample&) once for every pixel of the film's crop window, in parallel; wavelengths(pixel, random)
// chooses the sample's wavelengths.
template <class ChooseWavelengths, class Trace>
void for_each_pixel(const PassContext& context, Film& film, const ChooseWavelengths& wavelengths, const Trace& trace)
{
    constexpr int tile = 16, fine = 4;
    static_assert(tile == PassContext::block && fine * fine == tile, "rounds go over tiles, then over their blocks");
    if (context.without_eye_paths) return;
    const FilmSettings& settings = film.settings();
    const Int2 size = settings.crop_max - settings.crop_min;
    const Int2 tiles((size.x + tile - 1) / tile, (size.y + tile - 1) / tile);
    const int groups = static_cast<int>(settings.light_groups.size());
    const auto trace_tile = [&](int64_t index, Int2 first, int step) {
        PixelSample sums(groups);
        uint64_t traced = 0;
        const Int2 corner = settings.crop_min + Int2(int(index % tiles.x) * tile, int(index / tiles.x) * tile);
        for (int y = corner.y + first.y; y < std::min(corner.y + tile, settings.crop_max.y); y += step)
            for (int x = corner.x + first.x; x < std::min(corner.x + tile, settings.crop_max.x); x += step) {
                if (context.cancelled()) break;
                const Int2 pixel(x, y);
                film.prefetch_pixel(pixel);
                RandomStream random = pixel_stream(context.seed, pixel, context.pass);
                const Vec2 u_offset = random.next_2d();
                const Filter::Sample offset =
                    settings.pixel_centers ? Filter::Sample{Vec2(0), 1.0f} : settings.filter.sample(u_offset);
                sums.clear();
                const Wavelengths chosen = wavelengths(pixel, random);
                EyeSample sample{pixel,         Vec2(x + 0.5f, y + 0.5f) + offset.offset,
                                 chosen,        Sensor::LaneColors(settings.sensor, chosen),
                                 offset.weight, sums,
                                 random,        settings.guides_in_camera_space};
                trace(sample);
                film.add_pixel(pixel, sums, 1);
                ++traced;
            }
        context.statistics.eye_paths += traced;
    };
    const auto trace_round = [&](Int2 first, int step) {
        parallel_for(int64_t(tiles.x) * tiles.y, 1, [&](int64_t index) { trace_tile(index, first, step); });
    };
    if (!context.coarse_to_fine) return trace_round({0, 0}, 1);
    // The corners of all blocks of 4 x 4, those of a tile one by one; then the other pixels of these blocks.
    for (int round = 0; round < fine * fine; ++round) trace_round(place_in_round(round) * fine, tile);
    for (int round = 1; round < fine * fine; ++round) trace_round(place_in_round(round), fine);
}

// Fills albedo, normal, depth and position: geometry at the first vertex, colour and normal at the first that is no
// delta.
class GuideRecorder {
public:
    GuideRecorder(const World& world, EyeSample& sample) : world_(world), sample_(sample) {}
    void see(const Vertex& vertex);

private:
    const World& world_;
    EyeSample& sample_;
    bool has_geometry_ = false;
    bool has_color_ = false;
};

}  // namespace dapple
