// Writing what a render returned. image_file.h writes beside the place and renames, so a file is whole or not there.
#include "dapple/render/output.h"

#include "dapple/base/error.h"
#include "dapple/base/log.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <filesystem>
#include <string_view>
#include <thread>

namespace dapple {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view state_ending = ".dapple";

std::string ending_of(const std::string& path)
{
    std::string ending = fs::path(path).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return ending;
}

// What is written, and how.
struct Writer {
    const RenderResult& result;
    const OutputOptions& options;
    WriteOptions image_options;
    Progress& progress;

    // Empty, or why it could not be written.
    std::string write(const std::string& path) const
    {
        try {
            if (is_state_path(path))
                options.write_state(path);
            else
                write_image(path, result.image, image_options);
        } catch (const UserError& error) {
            return error.what();
        }
        progress.written(path);
        return "";
    }

    // Under a name of its own in the first rescue folder that takes it; that name. Empty when none does. Adds to `why`
    // what each folder had against it.
    std::string rescue(std::string_view ending, std::string& why) const
    {
        for (const std::string& folder : options.rescue_folders) {
            std::string path;
            std::error_code ignored;
            int number = 1;
            do {
                path = (fs::path(folder) / ("dapple-rescue-" + std::to_string(number++))).string();
                path += ending;
            } while (fs::exists(path, ignored));
            const std::string error = write(path);
            if (error.empty()) return path;
            why.append("; ").append(error);
        }
        return "";
    }
};

// Waits; false when the user does not want to.
bool wait(double seconds, const StopRequests* requests)
{
    const int asked = requests ? requests->count() : 0;
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (std::chrono::steady_clock::now() < end) {
        if (requests && requests->count() > asked) return false;
        std::this_thread::sleep_for(
            std::min(std::chrono::duration<double>(seconds), std::chrono::duration<double>(0.1)));
    }
    return true;
}

}  // namespace

bool is_state_path(const std::string& path) { return ending_of(path) == state_ending; }

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
        {"dapple:firstPass", static_cast<int>(result.first_pass)},
        {"dapple:passes", static_cast<int>(result.passes)},
        {"dapple:seconds", result.seconds},
        {"dapple:eyePaths", static_cast<double>(result.eye_paths)},
        {"dapple:lightPaths", static_cast<double>(result.light_paths)},
        {"dapple:photons", static_cast<double>(result.photons)},
        {"dapple:end", result.reason},
    };
    if (result.error.batches > 1) {
        metadata.emplace_back("dapple:errorNoise", result.error.noise);
        metadata.emplace_back("dapple:errorBias", result.error.bias);
    }
    if (!result.incomplete.empty()) metadata.emplace_back("dapple:incomplete", result.incomplete);
    return metadata;
}

void check_output_paths(const std::vector<std::string>& paths)
{
    for (const std::string& path : paths) {
        if (!is_state_path(path))
            check_image_ending(path, state_ending, "the render itself, for dapple resume and dapple merge");
        check_output_folder(path);
    }
}

void check_output_folder(const std::string& path)
{
    fs::path folder = fs::path(path).parent_path();
    if (folder.empty()) folder = ".";
    std::error_code error;
    if (!fs::is_directory(folder, error))
        throw UserError("cannot write '" + path + "': there is no folder '" + folder.string() + "'");
    if (fs::is_directory(path, error)) throw UserError("cannot write '" + path + "': it is a folder");
    if (access(folder.c_str(), W_OK) != 0)
        throw UserError("cannot write '" + path + "': folder '" + folder.string() + "' is read-only");
}

std::string write_outputs(const RenderResult& result, const RenderRecord& record, const OutputOptions& options,
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
    Writer rescuer{result, options, write, progress};
    rescuer.image_options.half = false;
    std::string image, state;  // where they were rescued
    for (size_t attempt = 0;; ++attempt) {
        const Writer writer{result, options, write, progress};
        std::string why;
        std::erase_if(left, [&](const std::string& path) {
            const std::string error = writer.write(path);
            if (!error.empty()) why.append(why.empty() ? "" : "; ").append(error);
            return error.empty();
        });
        if (left.empty()) return "";
        const bool with_state = std::any_of(left.begin(), left.end(), is_state_path);
        if (image.empty()) image = rescuer.rescue(".exr", why);
        if (with_state && state.empty()) state = rescuer.rescue(state_ending, why);
        const bool whole = !image.empty() && (!with_state || !state.empty());
        if (!image.empty() || !state.empty())
            why += fmt::format("; the {} was saved as {}{}{}", whole || image.empty() ? "render" : "image", image,
                               image.empty() || state.empty() ? "" : " and ", state);
        if (whole) return why;
        const std::vector<double>& pauses = options.retry_pauses;
        if (pauses.empty() || (attempt >= pauses.size() && !options.requests)) return why;
        const double pause = pauses[std::min(attempt, pauses.size() - 1)];
        log_warning("{}; the render is kept in memory; trying again in {:g} s{}", why, pause,
                    options.requests ? " (Ctrl-C gives it up)" : "");
        if (!wait(pause, options.requests)) return why + "; given up by request";
    }
}

}  // namespace dapple
