// The options of `dapple render`, also where `dapple resume` takes them from a checkpoint.
#pragma once

#include "commands.h"
#include "dapple/render/checkpoint.h"
#include "dapple/render/film_settings.h"
#include "dapple/render/progress.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dapple::cli {

struct RenderOptions {
    std::string scene;
    std::vector<std::string> outputs;
    std::string integrator;
    std::vector<std::string> definitions;
    double seconds = 0;  // 0: no limit
    uint32_t passes = 0;
    uint32_t first_pass = 0;
    double error = 0;
    std::optional<uint64_t> seed;
    int threads = 0;
    uint64_t memory = 0;  // [bytes], 0: no ceiling
    std::optional<CropEdges> crop;
    std::optional<Int2> resolution;
    ColorModel color_model = ColorModel::spectral;
    LayerChoice layers;
    std::string checkpoint;       // empty: an automatic one; "none"
    double checkpoint_every = 0;  // [s], 0: by itself
    std::string display_server;
    std::string techniques;  // file for the layers of each technique; empty: none
    bool half = false;
    bool pbrt_coats = false;
    float exposure = 0;
    bool quiet = false;
    ProgressKind progress = ProgressKind::bar;
};

// Adds what `dapple render` takes.
void add_render_options(CLI::App& parser, RenderOptions& options);
// Adds what `dapple resume` may change, too.
void add_stop_options(CLI::App& parser, RenderOptions& options);
void add_look_options(CLI::App& parser, RenderOptions& options);

// The options of an earlier `dapple render`. Throws UserError if this program does not know them.
RenderOptions parse_render_options(const std::vector<std::string>& arguments);

// Paths relative to `folder` become absolute.
void make_absolute(RenderOptions& options, const std::string& folder);

// name=value. Throws UserError.
std::vector<std::pair<std::string, std::string>> split_definitions(const std::vector<std::string>& texts);

// Where a render begins: anew, or with a checkpoint.
struct RenderStart {
    std::string command_line;
    std::vector<std::string> arguments;  // for those who resume
    std::string folder;
    std::string checkpoint;  // empty: anew
    CheckpointHeader header;
};

// Renders; returns the exit status. Throws UserError for bad input.
int render(const RenderOptions& options, const RenderStart& start);

}  // namespace dapple::cli
