// Writing what a render returned. image_file.h writes beside the place and renames, so a file is whole or not there.
#include "dapple/render/output.h"

#include "dapple/base/error.h"
#include "dapple/base/log.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <filesystem>
#include <string_view>
#include <thread>

namespace dapple {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 4> writable_endings = {".exr", ".png", ".pfm", ".hdr"};

std::string ending_of(const std::string& path)
{
    std::string ending = fs::path(path).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return ending;
}

bool try_write(const std::string& path, const RenderResult& result, const WriteOptions& options, Progress& progress)
{
    try {
        write_image(path, result.image, options);
    } catch (const UserError& error) {
        log_warning("{}", error.what());
        return false;
    }
    progress.written(path);
    return true;
}

// Saves all layers under a name of its own. False when no folder takes it.
bool rescue(const RenderResult& result, WriteOptions write, const OutputOptions& options, Progress& progress)
{
    write.half = false;
    for (const std::string& folder : options.rescue_folders) {
        std::string path;
        std::error_code ignored;
        int number = 1;
        do {
            path = (fs::path(folder) / ("dapple-rescue-" + std::to_string(number++) + ".exr")).string();
        } while (fs::exists(path, ignored));
        if (try_write(path, result, write, progress)) {
            log_warning("the render was saved as {}", path);
            return true;
        }
    }
    return false;
}

}  // namespace

ImageMetadata image_metadata(const RenderRecord& record, const RenderResult& result)
{
    std::string settings;
    for (const std::string& line : record.report) settings += (settings.empty() ? "" : "; ") + line;
    ImageMetadata metadata = {
        {"Software", "Dapple " + record.version},
        {"dapple:version", record.version},
        {"dapple:command", record.command},
        {"dapple:scene", record.scene},
        {"dapple:integrator", record.integrator},
        {"dapple:settings", settings},
        {"dapple:seed", std::to_string(record.seed)},
        {"dapple:threads", record.threads},
        {"dapple:passes", static_cast<int>(result.passes)},
        {"dapple:seconds", result.seconds},
        {"dapple:eyePaths", static_cast<double>(result.eye_paths)},
        {"dapple:lightPaths", static_cast<double>(result.light_paths)},
        {"dapple:photons", static_cast<double>(result.photons)},
        {"dapple:end", result.reason},
    };
    if (result.incomplete)
        metadata.emplace_back("dapple:incomplete",
                              "the first pass was cut short: black pixels were not reached, and "
                              "light from light paths is too dark");
    return metadata;
}

void check_output_paths(const std::vector<std::string>& paths)
{
    for (const std::string& path : paths) {
        const std::string ending = ending_of(path);
        if (std::find(writable_endings.begin(), writable_endings.end(), ending) == writable_endings.end())
            throw UserError("cannot write '" + path + "': an image file ends in .exr, .png, .pfm or .hdr" +
                            did_you_mean(ending, writable_endings));
        fs::path folder = fs::path(path).parent_path();
        if (folder.empty()) folder = ".";
        std::error_code error;
        if (!fs::is_directory(folder, error))
            throw UserError("cannot write '" + path + "': there is no folder '" + folder.string() + "'");
        if (fs::is_directory(path, error)) throw UserError("cannot write '" + path + "': it is a folder");
        if (access(folder.c_str(), W_OK) != 0)
            throw UserError("cannot write '" + path + "': folder '" + folder.string() + "' is read-only");
    }
}

bool write_outputs(const RenderResult& result, const RenderRecord& record, const OutputOptions& options,
                   Progress& progress)
{
    WriteOptions write;
    write.channel_names = result.channels;
    write.metadata = image_metadata(record, result);
    write.half = options.half;
    write.exposure = options.exposure;
    write.data_origin = options.crop_min;
    write.full_size = options.full_size;

    std::vector<std::string> left = options.paths;
    bool rescued = false;
    for (size_t attempt = 0;; ++attempt) {
        std::erase_if(left, [&](const std::string& path) { return try_write(path, result, write, progress); });
        if (left.empty()) return true;
        rescued = rescued || rescue(result, write, options, progress);
        if (rescued || attempt == options.retry_pauses.size()) return false;
        const double pause = options.retry_pauses[attempt];
        log_warning("the render is kept in memory; trying again in {:g} s", pause);
        std::this_thread::sleep_for(std::chrono::duration<double>(pause));
    }
}

}  // namespace dapple
