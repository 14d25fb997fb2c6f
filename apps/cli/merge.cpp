// `dapple merge`: one render out of parts with disjoint passes, to the same bits.
#include "commands.h"
#include "dapple/base/log.h"
#include "dapple/base/words.h"
#include "dapple/render/checkpoint.h"
#include "dapple/render/output.h"
#include "values.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <vector>

namespace dapple::cli {
namespace {

constexpr const char* examples =
    R"(The parts come from dapple render -o PART.dapple (or --checkpoint) of the same scene with the same settings and
seed, each with its own --first-pass. The result is bit by bit that of one render of all passes. One part alone
becomes an image. Parts of another render, or with passes that would count twice, are refused.

Examples:
  dapple render scene.pbrt -o a.dapple --first-pass 0 --passes 32     on one machine
  dapple render scene.pbrt -o b.dapple --first-pass 32 --passes 32    on another
  dapple merge a.dapple b.dapple -o out.exr -o out.png
  dapple merge a.dapple b.dapple -o both.dapple                       to be merged or resumed again)";

struct Options {
    std::vector<std::string> parts, outputs;
    bool half = false;
    float exposure = 0;
    bool quiet = false;
};

RenderResult result_of(const Checkpoint& checkpoint)
{
    const RenderCounters& counters = checkpoint.header.counters;
    RenderResult result;
    result.image = checkpoint.film->layers(result.channels);
    result.first_pass = checkpoint.header.film.first_pass;
    result.passes = checkpoint.film->passes();
    result.seconds = counters.seconds;
    result.error = checkpoint.film->error();
    result.reason = "merged";
    result.film_whole = true;
    result.eye_paths = counters.eye_paths;
    result.light_paths = counters.light_paths;
    result.photons = counters.photons;
    result.rays = counters.rays;
    return result;
}

int merge(const Options& options)
{
    check_output_paths(options.outputs);
    if (options.quiet) set_log_level(LogLevel::silent);
    Checkpoint whole = read_checkpoint(options.parts.front());
    for (size_t i = 1; i < options.parts.size(); ++i)
        merge_checkpoint(whole, read_checkpoint(options.parts[i]), options.parts[i]);

    OutputOptions output;
    output.paths = options.outputs;
    output.half = options.half;
    output.exposure = options.exposure;
    output.crop_min = whole.header.film.crop_min;
    output.full_size = whole.header.film.resolution;
    output.write_state = [&](const std::string& path) { write_checkpoint(path, whole.header, *whole.film); };
    const auto progress = make_progress(options.quiet ? ProgressKind::none : ProgressKind::bar);
    progress->note(fmt::format("{} ({})", counted(whole.header.passes(), "pass"), ranges_text(whole.header.ranges)));
    const std::string error = write_outputs(result_of(whole), whole.header.record, output, *progress);
    if (!error.empty()) throw Failure(error);
    return 0;
}

}  // namespace

Command add_merge(CLI::App& app)
{
    const auto options = std::make_shared<Options>();
    CLI::App* parser = app.add_subcommand("merge", "one image out of renders of different passes");
    parser->footer(examples);
    parser->add_option("parts", options->parts, ".dapple files")->required();
    parser->add_option("-o,--output", options->outputs, "file (.exr, .png, .pfm, .hdr, .dapple); -o again for another")
        ->required()
        ->allow_extra_args(false);
    parser->add_flag("--half", options->half, "16-bit floats in .exr files");
    add_number(*parser, "--exposure", options->exposure, "-100 to 100", "stops added in .png files");
    parser->add_flag("-q,--quiet", options->quiet, "print errors only");
    return {parser, [options] { return merge(*options); }};
}

}  // namespace dapple::cli
