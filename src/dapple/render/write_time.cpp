#include "dapple/render/write_time.h"

#include "dapple/base/parallel.h"
#include "dapple/base/temp_folder.h"
#include "dapple/image/image_file.h"
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

// `rows` of them, written as a file and scaled to `height`; one row takes what any file takes.
double seconds_to_write(const std::vector<std::string>& paths, const Image& rows, int height, WriteOptions options)
{
    Image row(rows.width, 1, rows.channels);
    std::copy_n(rows.pixels.begin(), row.pixels.size(), row.pixels.begin());
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

}  // namespace

WriteTime time_to_write(const std::vector<std::string>& paths, const FilmSettings& film, bool half)
{
    const int trial_rows = 16 * std::max(2, thread_count());  // a block for each thread, as OpenEXR compresses them
    const Int2 size = film.crop_max - film.crop_min;
    FilmSettings band = film;
    band.crop_max.y = band.crop_min.y + std::min(size.y, trial_rows);
    band.error_layer = false;
    WriteOptions options;
    options.half = half;
    WriteTime time;
    try {
        const Film black(band);
        const auto start = std::chrono::steady_clock::now();
        Image rows = black.layers(options.channel_names);
        const double layers = seconds_since(start) * size.y / rows.height;
        time.black = seconds_to_write(paths, rows, size.y, options);
        std::minstd_rand random;
        for (float& value : rows.pixels) value = static_cast<float>(random()) * 0x1p-31f;
        time.noise = std::max(seconds_to_write(paths, rows, size.y, options), time.black);
        time.black += layers;
        time.noise += layers;
    } catch (const std::exception&) {  // the real files say what is wrong
        return {};
    }
    return time;
}

double detail_of(const Image& rows)
{
    const auto channels = static_cast<size_t>(rows.channels);
    size_t lit = 0, changing = 0;
    for (size_t i = channels; i < rows.pixels.size(); ++i) {
        lit += rows.pixels[i] != 0.0f;
        changing += rows.pixels[i] != rows.pixels[i - channels];
    }
    return 0.5 * static_cast<double>(lit + changing) / static_cast<double>(std::max<size_t>(rows.pixels.size(), 1));
}

}  // namespace dapple
