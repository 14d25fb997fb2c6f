// `dapple resume`: goes on with a render where its checkpoint ends. Whatever makes the image comes from the checkpoint.
#include "commands.h"
#include "dapple/base/error.h"
#include "dapple/base/log.h"
#include "render_options.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

namespace dapple::cli {
namespace {

constexpr const char* examples =
    R"(The image is bit by bit that of a render that was never interrupted. Scene, output and all options are those of
the first command; --passes, --time and --error count from its beginning.

Examples:
  dapple resume out.dapple                        goes on to where the first command would have ended
  dapple resume out.dapple --passes 1000          and beyond
  dapple resume out.dapple --scene new/scene.pbrt -o new/out.exr)";

// A merged file has the command of its first part, which wrote that part.
void check_other_states(const RenderOptions& options, const std::string& checkpoint)
{
    for (const std::string& path : options.outputs)
        if (is_state_path(path) && std::filesystem::exists(path) && !std::filesystem::equivalent(path, checkpoint))
            throw UserError(
                fmt::format("this would overwrite '{}', which the first command wrote: say where to with -o, "
                            "for example -o {}",
                            path, checkpoint));
}

int resume(const std::string& file, const RenderOptions& changes)
{
    RenderStart start;
    start.checkpoint = std::filesystem::absolute(file).lexically_normal().string();
    start.header = read_checkpoint_header(file);
    const CheckpointHeader& header = start.header;
    if (header.ranges.size() != 1)
        throw UserError(fmt::format("'{}' holds passes with others missing between them: merge those first", file));
    start.command_line = header.record.command;
    start.arguments = header.arguments;
    start.folder = header.folder;

    RenderOptions options = parse_render_options(header.arguments);
    make_absolute(options, header.folder);
    RenderOptions asked = changes;
    make_absolute(asked, std::filesystem::current_path().string());
    if (!asked.scene.empty()) options.scene = asked.scene;
    if (!asked.outputs.empty())
        options.outputs = asked.outputs;
    else
        check_other_states(options, start.checkpoint);
    if (asked.passes > 0 || asked.seconds > 0 || asked.error > 0) {
        options.passes = asked.passes;
        options.seconds = asked.seconds;
        options.error = asked.error;
    }
    options.first_pass = header.ranges.front().first;
    options.threads = asked.threads;
    if (asked.checkpoint_every > 0) options.checkpoint_every = asked.checkpoint_every;
    if (options.checkpoint == "none") options.checkpoint.clear();
    options.display_server = asked.display_server;
    if (!options.techniques.empty()) {
        log_warning("'{}' is not written: the passes of the checkpoint are not in it", options.techniques);
        options.techniques.clear();
    }
    options.quiet = asked.quiet;
    options.progress = asked.progress;
    if (options.error > 0 && !header.film.error_layer)
        throw UserError(fmt::format("'{}' holds no error estimates: render with --error or --layers all,error", file));
    options.layers.error = options.layers.error || header.film.error_layer;
    return render(options, start);
}

}  // namespace

Command add_resume(CLI::App& app)
{
    struct Asked {
        std::string file;
        RenderOptions changes;
    };
    const auto asked = std::make_shared<Asked>();
    CLI::App* parser = app.add_subcommand("resume", "go on with a render from its checkpoint");
    parser->footer(examples);
    parser->add_option("checkpoint", asked->file, "a .dapple file")->required();
    parser->add_option("-o,--output", asked->changes.outputs, "another file; -o again for one more")
        ->allow_extra_args(false);
    parser->add_option("--scene", asked->changes.scene, "where the scene is now, if it was moved");
    add_stop_options(*parser, asked->changes);
    add_look_options(*parser, asked->changes);
    return {parser, [asked] { return resume(asked->file, asked->changes); }};
}

}  // namespace dapple::cli
