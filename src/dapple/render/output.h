// Writing what a render returned, with a header that says how it was made, and not losing it when writing fails.
#pragma once

#include "dapple/image/image_file.h"
#include "dapple/render/progress.h"
#include "dapple/render/render_job.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace dapple {

// How the image was made; see image_metadata for the names in the header.
struct RenderRecord {
    std::string version;
    std::string command;
    std::string scene;
    std::string integrator;
    std::vector<std::string> report;  // what the settings resolved to
    uint64_t seed = 0;
    int threads = 0;
};

// The header: "dapple:version", "dapple:command", "dapple:scene", "dapple:integrator", "dapple:settings",
// "dapple:seed", "dapple:threads", "dapple:firstPass", "dapple:passes", "dapple:seconds", "dapple:eyePaths",
// "dapple:lightPaths", "dapple:photons", "dapple:end" (why the render ended); where they are known "dapple:errorNoise"
// and "dapple:errorBias" (error_sums.h); and, only where it is so, "dapple:incomplete".
ImageMetadata image_metadata(const RenderRecord& record, const RenderResult& result);

struct OutputOptions {
    std::vector<std::string> paths;
    bool half = false;      // .exr with 16-bit floats
    float exposure = 0.0f;  // .png: stops added before the sRGB curve
    Int2 crop_min{0, 0};    // where the image lies in the full image
    Int2 full_size{0, 0};
    // Where the image goes when a path cannot be written, tried in this order.
    std::vector<std::string> rescue_folders;
    std::vector<double> retry_pauses{1, 2, 5, 10, 30};  // [s], when not even a rescue folder takes it
    // With requests, the last pause comes again and again, until it is written or the user gives it up.
    const StopRequests* requests = nullptr;
    // Writes a .dapple file; throws UserError.
    std::function<void(const std::string& path)> write_state;
};

// Whether a file of this name holds a render (checkpoint.h) instead of an image: it ends in .dapple.
bool is_state_path(const std::string& path);

// Before rendering: throws UserError for an ending that cannot be written or a folder that is missing or not writable.
void check_output_paths(const std::vector<std::string>& paths);
// The latter alone.
void check_output_folder(const std::string& path);

// Writes every path. Where one fails, the image with all layers is saved, once for all of them, as dapple-rescue-N.exr
// (and the render as dapple-rescue-N.dapple, if one was to be written) in the first rescue folder that takes it; if
// none does, what is missing is tried again after each pause. Returns nothing, or in one line what could not be
// written, why, and where the render is.
std::string write_outputs(const RenderResult& result, const RenderRecord& record, const OutputOptions& options,
                          Progress& progress);

}  // namespace dapple
