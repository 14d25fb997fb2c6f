#include "values.h"

#include "dapple/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace dapple::cli {
namespace {

// "--passes" of "-p,--passes,--spp".
std::string long_name(const std::string& names)
{
    const size_t begin = names.find("--");
    return begin == std::string::npos ? names : names.substr(begin, names.find(',', begin) - begin);
}

std::vector<std::string> command_names(const CLI::App& app)
{
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(command->get_name());
    return names;
}

std::string near(const std::string& word, const std::vector<std::string>& known)
{
    return did_you_mean(word, std::vector<std::string_view>(known.begin(), known.end()));
}

// What `command` has no place for.
std::string explain_extra(const std::string& command, const CLI::App& parser, const std::vector<std::string>& extra)
{
    const auto option =
        std::find_if(extra.begin(), extra.end(), [](const auto& word) { return word.starts_with('-'); });
    if (option == extra.end()) return fmt::format("'{}' is one argument too many for {}", extra.front(), command);
    const std::string name = option->substr(0, option->find('='));
    std::vector<std::string> known;
    for (const CLI::Option* candidate : parser.get_options())
        for (const std::string& word : candidate->get_lnames()) known.push_back("--" + word);
    return fmt::format("{} has no option '{}'{}", command, name, near(name, known));
}

// What the options of `command` lack; empty where it is something else.
std::string explain_option(const std::string& command, const CLI::App& parser, const std::string& message)
{
    for (const CLI::Option* option : parser.get_options()) {
        const std::string name = option->get_name(), help = option->get_description();
        if (message == name + " is required") return fmt::format("{} needs {}: {}", command, name, help);
        if (message.starts_with(name + ":"))
            return message.ends_with("missing") ? fmt::format("{} takes a value: {}", name, help)
                                                : fmt::format("{} is given more than once", name);
        if (message.starts_with("Could not convert: " + name + " =")) return name + " takes no value";
    }
    return "";
}

}  // namespace

void add_value(CLI::App& parser, const std::string& names, const std::string& kind, const std::string& help, Take take)
{
    const auto read = [take = std::move(take), name = long_name(names)](const CLI::results_t& values) {
        take(name, values.back());
        return true;
    };
    parser.add_option(names, CLI::callback_t(read), help)->type_name(kind);
}

std::string explain(const CLI::ParseError& error, const CLI::App& app)
{
    const std::vector<CLI::App*> chosen = app.get_subcommands();
    const CLI::App& parser = chosen.empty() ? app : *chosen.front();
    const std::string command = chosen.empty() ? "dapple" : "dapple " + parser.get_name();
    const std::vector<std::string> extra = parser.remaining();
    std::string text = error.what();
    if (chosen.empty() && !extra.empty() && !extra.front().starts_with('-')) {
        const std::vector<std::string> known = command_names(app);
        const std::string& word = extra.front();
        if (word.ends_with(".pbrt")) return fmt::format("a command is missing: dapple render {}", word);
        const std::string meant = near(word, known);
        text = fmt::format("unknown command '{}'{}", word,
                           meant.empty() ? fmt::format("; there are {}", fmt::join(known, ", ")) : meant);
    } else if (!extra.empty()) {
        text = explain_extra(command, parser, extra);
    } else if (chosen.empty()) {
        text = fmt::format("a command is missing: {}", fmt::join(command_names(app), ", "));
    } else if (const std::string lack = explain_option(command, parser, text); !lack.empty()) {
        text = lack;
    }
    return fmt::format("{} ({} --help shows how)", text, command);
}

}  // namespace dapple::cli
