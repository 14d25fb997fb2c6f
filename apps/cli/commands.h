// The sub-commands of the program. Each adds itself to the parser and returns what runs when it was chosen.
#pragma once

#include "dapple/scene/description.h"

#include <CLI/CLI.hpp>

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace dapple::cli {

// Exit statuses: 0 done; 1 the program failed, or a comparison did not hold; 2 the user's input cannot be used.
inline constexpr int exit_failure = 1;
inline constexpr int exit_bad_input = 2;

// What went wrong through no fault of the input: one line and exit_failure.
struct Failure : std::runtime_error {
    using std::runtime_error::runtime_error;
};

struct Command {
    CLI::App* parser = nullptr;
    std::function<int()> run;  // returns the exit status; throws UserError for bad input
};

// What was typed.
struct Invocation {
    std::string command_line;            // in one line, quoted where needed
    std::vector<std::string> arguments;  // behind the sub-command
};

Command add_render(CLI::App& app, const Invocation& invocation);
Command add_resume(CLI::App& app);
Command add_merge(CLI::App& app);
Command add_inspect(CLI::App& app);
Command add_compare(CLI::App& app);
Command add_doctor(CLI::App& app);
Command add_integrators(CLI::App& app);

// Reads a scene with the volumes that it names. Throws UserError.
scene::Description read_scene(const std::string& path);

// Whether this processor has what the program was built for.
bool processor_suffices();

// "dapple 0.1.0 (commit abc1234, release)".
std::string version_line();

}  // namespace dapple::cli
