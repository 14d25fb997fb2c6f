#include "dapple/render/write_time.h"

#include "dapple/base/error.h"
#include "dapple/base/parallel.h"
#include "dapple/image/image_file.h"
#include "dapple/render/output.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <random>

namespace dapple {
namespace {

namespace fs = std::filesystem;

int channels_of(const FilmSettings& film)
{
    return 3 + (film.class_layers ? 3 * path_class_count : 0) + 3 * static_cast<int>(film.light_groups.size()) +
           (film.guide_layers ? 10 : 0) + (film.photon_layers ? 2 : 0) + (film.error_layer ? 2 : 0);
}

double seconds_since(std::chrono::steady_clock::time_point start)
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Of making the image out of the film.
double seconds_of_layers(FilmSettings film, int rows)
{
    const int height = film.crop_max.y - film.crop_min.y;
    film.crop_max.y = film.crop_min.y + rows;
    film.error_layer = false;
    const Film band(film);
    std::vector<std::string> names;
    const auto start = std::chrono::steady_clock::now();
    band.layers(names);
    return seconds_since(start) * height / rows;
}

double seconds_of(const std::string& path, const Image& image, const WriteOptions& options)
{
    const auto start = std::chrono::steady_clock::now();
    write_image(path, image, options);
    return seconds_since(start);
}

// A new folder for trials that nobody else can write into.
class TrialFolder {
public:
    TrialFolder()
    {
        if (!mkdtemp(path_.data())) throw UserError("cannot make a temporary folder");
    }
    TrialFolder(const TrialFolder&) = delete;
    TrialFolder& operator=(const TrialFolder&) = delete;
    ~TrialFolder()
    {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    fs::path path() const { return path_; }

private:
    std::string path_ = (fs::temp_directory_path() / "dapple-XXXXXX").string();
};

// `rows` of them, written as a file and scaled to `height`; one row takes what any file takes.
double seconds_to_write(const std::vector<std::string>& paths, const Image& rows, int height, WriteOptions options)
{
    Image row(rows.width, 1, rows.channels);
    std::copy_n(rows.pixels.begin(), row.pixels.size(), row.pixels.begin());
    double seconds = 0;
    const TrialFolder folder;
    for (const std::string& path : paths) {
        if (is_state_path(path)) continue;
        const std::string trial = (folder.path() / ("trial" + fs::path(path).extension().string())).string();
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
    Image rows(size.x, std::min(size.y, trial_rows), channels_of(film));
    WriteOptions options;
    options.half = half;
    options.channel_names = {"R", "G", "B"};
    while (static_cast<int>(options.channel_names.size()) < rows.channels)
        options.channel_names.push_back(fmt::format("layer.{}", options.channel_names.size()));
    WriteTime time;
    try {
        time.black = seconds_to_write(paths, rows, size.y, options);
        std::minstd_rand random;
        for (float& value : rows.pixels) value = static_cast<float>(random()) * 0x1p-31f;
        time.noise = std::max(seconds_to_write(paths, rows, size.y, options), time.black);
        const double layers = seconds_of_layers(film, rows.height);
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
