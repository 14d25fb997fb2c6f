// `dapple inspect`: a dry run. Reads and compiles the scene, renders nothing.
#include "dapple/render/inspect.h"
#include "commands.h"
#include "dapple/base/log.h"

#include <fmt/format.h>

namespace dapple::cli {
namespace {

constexpr const char* examples =
    R"(Film, camera, lights and their shares of the photons, memory, what is not supported, and which algorithm suits.

Examples:
  dapple inspect scene.pbrt
  dapple inspect scene.pbrt -i photonmap          with what its photon maps take)";

int inspect_scene(const std::string& path, const std::string& integrator)
{
    set_log_level(LogLevel::silent);  // warnings are listed at the end
    const scene::Description description = read_scene(path);
    const IntegratorChoice choice = choose_integrator(description.integrator, integrator, {});
    CompileReport report;
    const std::unique_ptr<World> world = compile(description, &report);

    const bool suits = knows_media(*choice.entry, *world);
    const std::unique_ptr<Integrator> chosen = suits ? choice.entry->create(*world, choice.settings) : nullptr;
    fmt::print("{}\n", path);
    for (const std::string& line : inspect(description, *world, report, choice, chosen.get())) fmt::print("{}\n", line);
    for (const std::string& note : choice.notes) fmt::print("note          {}\n", note);
    if (!suits)
        fmt::print("not supported integrator '{}' does not know media that scatter or emit, which this scene has\n",
                   choice.entry->name);
    std::vector<std::string> warnings = description.warnings;
    const std::vector<std::string> logged = logged_warnings();
    warnings.insert(warnings.end(), logged.begin(), logged.end());
    if (warnings.empty()) fmt::print("warnings      none\n");
    for (const std::string& warning : warnings) fmt::print("warning       {}\n", warning);
    return 0;
}

}  // namespace

Command add_inspect(CLI::App& app)
{
    struct Options {
        std::string scene;
        std::string integrator;
    };
    const auto options = std::make_shared<Options>();
    CLI::App* parser = app.add_subcommand("inspect", "say what is in a scene, without rendering it");
    parser->footer(examples);
    parser->add_option("scene", options->scene, "a pbrt-v4 scene file")->required();
    parser->add_option("-i,--integrator", options->integrator, "judge the scene for this algorithm");
    return {parser, [options] { return inspect_scene(options->scene, options->integrator); }};
}

}  // namespace dapple::cli
