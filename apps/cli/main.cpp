// The program `dapple`: picks the sub-command, turns every error into one line and an exit status.
#include "build_info.h"
#include "commands.h"
#include "dapple/base/error.h"
#include "values.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <exception>
#include <new>
#include <string>

namespace dapple::cli {
namespace {

constexpr const char* examples = R"(Examples:
  dapple render scene.pbrt                        as the scene says, to an .exr in this folder
  dapple render scene.pbrt -o out.exr -o out.png  both files at once
  dapple render scene.pbrt -o quick.png --resolution 320x240 --time 20s
  dapple render scene.pbrt -o c.exr --integrator photonmap -D photons=2M
  dapple resume out.dapple                        goes on after a crash, a kill or Ctrl-C, to the same bits
  dapple merge a.dapple b.dapple -o out.exr       one image of the passes of several machines
  dapple inspect scene.pbrt                       what is in it, and what is not supported
  dapple compare a.exr b.exr --diff diff.png      how much two images differ
  dapple integrators                              all algorithms and their settings
  dapple doctor                                   does everything work here?

`dapple COMMAND --help` tells more of each. Ctrl-C once: the pass is finished and the image written.)";

// One line, whatever the message holds.
int report(const std::string& message, int status)
{
    std::string line = message;
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back()))) line.pop_back();
    std::replace(line.begin(), line.end(), '\n', ' ');
    fmt::print(stderr, "dapple: error: {}\n", line);
    return status;
}

std::string quoted(const std::string& argument)
{
    const bool plain = !argument.empty() && argument.find_first_of(" \t\"'\\$*?<>|&;()") == std::string::npos;
    return plain ? argument : "'" + argument + "'";
}

int run(int argc, char** argv)
{
    Invocation invocation{"dapple", {}};
    for (int i = 1; i < argc; ++i) {
        invocation.command_line += " " + quoted(argv[i]);
        if (i > 1) invocation.arguments.emplace_back(argv[i]);
    }

    CLI::App app("Dapple renders the light that path tracers cannot find: caustics, by photons.", "dapple");
    app.require_subcommand(1);
    app.set_version_flag("--version", version_line());
    app.footer(examples);
    const std::array commands = {add_render(app, invocation),
                                 add_resume(app),
                                 add_merge(app),
                                 add_inspect(app),
                                 add_compare(app),
                                 add_doctor(app),
                                 add_integrators(app)};
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        return app.exit(success);
    } catch (const CLI::ParseError& error) {
        return report(explain(error, app), exit_bad_input);
    }
    for (const Command& command : commands)
        if (command.parser->parsed()) return command.run();
    return exit_bad_input;
}

}  // namespace

std::string version_line()
{
    return fmt::format("dapple {} (commit {}, {})", build_info::version, build_info::commit, build_info::build_type);
}

}  // namespace dapple::cli

int main(int argc, char** argv)
{
    using namespace dapple::cli;
    try {
        if (!processor_suffices())
            return report("this processor lacks AVX2, FMA or BMI2; build with -DDAPPLE_ARCH= for it", exit_failure);
        return run(argc, argv);
    } catch (const dapple::UserError& error) {
        return report(error.what(), exit_bad_input);
    } catch (const Failure& failure) {
        return report(failure.what(), exit_failure);
    } catch (const std::bad_alloc&) {
        return report("out of memory", exit_failure);
    } catch (const std::exception& error) {
        return report(std::string("internal: ") + error.what(), exit_failure);
    }
}
