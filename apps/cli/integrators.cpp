// `dapple integrators`: the registry as a table, so that the help can never disagree with the program.
#include "commands.h"
#include "dapple/render/scene_defaults.h"

#include <fmt/format.h>

namespace dapple::cli {
namespace {

constexpr const char* examples = R"(Examples:
  dapple integrators                              all of them
  dapple integrators sppm                         one, with its settings: what -D name=value takes)";

void print_text(const IntegratorEntry& entry)
{
    fmt::print("{}\n    {}\n    scattering media: {}; photon layers: {}\n", entry.name, entry.summary,
               entry.media ? "yes" : "no", entry.photon_layers ? "yes" : "no");
    for (const SettingInfo& info : entry.settings) {
        const std::string unit = info.unit.empty() ? std::string() : fmt::format(" [{}]", info.unit);
        fmt::print("    -D {:<24} {}{}; {}\n", fmt::format("{}={}", info.name, info.fallback), info.text, unit,
                   info.range);
    }
    fmt::print("\n");
}

constexpr const char* markdown_head =
    "# Integrators\n\nPrinted by `dapple integrators --markdown`; a test holds this page to it. Numbers may end in k, "
    "M or "
    "G; where the\ndefault is auto, the scene decides.\n\n";

void print_markdown(const IntegratorEntry& entry)
{
    fmt::print("## {}\n\n{}.\n\n| setting | default | unit | values | meaning |\n|---|---|---|---|---|\n", entry.name,
               entry.summary);
    for (const SettingInfo& info : entry.settings) {
        std::string range;
        for (const char c : info.range) {
            if (c == '|') range += '\\';  // a bar would end the table's cell
            range += c;
        }
        fmt::print("| `{}` | {} | {} | {} | {} |\n", info.name, info.fallback, info.unit, range, info.text);
    }
    fmt::print("\n");
}

}  // namespace

Command add_integrators(CLI::App& app)
{
    struct Options {
        std::string name;
        bool markdown = false;
    };
    const auto options = std::make_shared<Options>();
    CLI::App* parser = app.add_subcommand("integrators", "list the algorithms and their settings");
    parser->footer(examples);
    parser->add_option("name", options->name, "only this one");
    parser->add_flag("--markdown", options->markdown, "as tables for the documentation");
    return {parser, [options] {
                const IntegratorEntry* only = options->name.empty() ? nullptr : &find_integrator(options->name);
                if (options->markdown) fmt::print("{}", markdown_head);
                for (const IntegratorEntry& entry : integrator_registry())
                    if (!only || entry.name == only->name)
                        options->markdown ? print_markdown(entry) : print_text(entry);
                return 0;
            }};
}

}  // namespace dapple::cli
