#include "dapple/render/write_time.h"

#include "dapple/base/parallel.h"
#include "dapple/base/temp_folder.h"
#include "dapple/image/image_file.h"
#include "dapple/image/zip_time.h"
#include "dapple/render/output.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <random>

namespace dapple {
namespace {

namespace fs = std::filesystem;

double seconds_since(std::chrono::steady_clock::time_point start)
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double seconds_of(const std::string& path, const Image& image, const WriteOptions& options)
{
    const auto start = std::chrono::steady_clock::now();
    write_image(path, image, options);
    return seconds_since(start);
}

Image first_rows(const Image& image, int count)
{
    Image rows(image.width, std::min(count, image.height), image.channels);
    std::copy_n(image.pixels.begin(), rows.pixels.size(), rows.pixels.begin());
    return rows;
}

double zip_seconds_of_row(const Image& image)
{
    const Image rows = first_rows(image, 16);
    return zip_seconds(rows) / rows.height;
}

// `rows` of them, written as a file and scaled to `height`; one row takes what any file takes.
double seconds_to_write(const std::vector<std::string>& paths, const Image& rows, int height, WriteOptions options)
{
    const Image row = first_rows(rows, 1);
    double seconds = 0;
    const TempFolder folder;
    for (const std::string& path : paths) {
        if (is_state_path(path)) continue;
        const std::string trial = (folder / ("trial" + fs::path(path).extension().string())).string();
        const double once = seconds_of(trial, row, options);
        // The better of two, as something else may have been in the way.
        const double all = std::min(seconds_of(trial, rows, options), seconds_of(trial, rows, options));
        seconds += once + std::max(all - once, 0.0) * height / rows.height;
    }
    return seconds;
}

// Whole images do not fit into caches as these rows do (1.05 to 1.25 times for 28 layers of a megapixel).
constexpr double whole = 1.15;

// Of its pixels, those that are not black in all channels.
double share_that_shows(const Image& image)
{
    const auto channels = static_cast<std::ptrdiff_t>(image.channels);
    int64_t shown = 0;
    for (auto pixel = image.pixels.begin(); pixel != image.pixels.end(); pixel += channels)
        shown += std::any_of(pixel, pixel + channels, [](float value) { return value != 0.0f; });
    return static_cast<double>(shown) / std::max(1.0, double(image.width) * image.height);
}

}  // namespace

WriteTime time_to_write(const std::vector<std::string>& paths, const FilmSettings& film, bool half)
{
    const int trial_rows = 16 * std::max(2, thread_count());  // a block for each thread, as OpenEXR compresses them
    const int black_rows = std::max(trial_rows, std::min(4 * trial_rows, 256));  // they take little
    const Int2 size = film.crop_max - film.crop_min;
    FilmSettings band = film;
    band.crop_max.y = band.crop_min.y + std::min(size.y, black_rows);
    WriteOptions options;
    options.half = half;
    WriteTime time;
    try {
        const Film black(band);
        Image rows = black.layers(options.channel_names);  // the first time is slower
        const auto start = std::chrono::steady_clock::now();
        rows = Image();
        rows = black.layers(options.channel_names);
        time.layers = seconds_since(start) * size.y / rows.height;
        time.zip_black = zip_seconds_of_row(rows);
        time.black = seconds_to_write(paths, rows, size.y, options);
        rows = first_rows(rows, trial_rows);
        std::minstd_rand random;
        for (float& value : rows.pixels) value = static_cast<float>(random()) * 0x1p-31f;
        time.zip_noise = zip_seconds_of_row(rows);
        time.noise = std::max(seconds_to_write(paths, rows, size.y, options), time.black);
        time.black = whole * (time.black + time.layers);
        time.noise = whole * (time.noise + time.layers);
    } catch (const std::exception&) {  // the real files say what is wrong
        return {};
    }
    return time;
}

double WriteTime::seconds(const Image& rows, int to_come) const
{
    if (!(zip_noise > zip_black)) return expected();
    double detail = (zip_seconds(rows) / std::max(rows.height, 1) - zip_black) / (zip_noise - zip_black);
    if (to_come > 0) detail += share_that_shows(rows) * to_come / std::max(rows.channels, 1);
    return black + std::clamp(detail, 0.0, 1.0) * (noise - black);
}

}  // namespace dapple
