// `dapple doctor`: says what the program was built from, whether this machine can run it, and renders a scene whose
// answer is known.
#include "build_info.h"
#include "commands.h"
#include "dapple/base/log.h"
#include "dapple/base/parallel.h"
#include "dapple/render/self_check.h"

#include <fmt/format.h>

namespace dapple::cli {
namespace {

void print_processor()
{
#if defined(__x86_64__)
    fmt::print("processor     {}avx2 {}fma {}bmi2 {}avx512f\n", __builtin_cpu_supports("avx2") ? "" : "no ",
               __builtin_cpu_supports("fma") ? "" : "no ", __builtin_cpu_supports("bmi2") ? "" : "no ",
               __builtin_cpu_supports("avx512f") ? "" : "no ");
#else
    fmt::print("processor     not x86-64\n");
#endif
}

int doctor()
{
    fmt::print("{}\n", version_line());
    fmt::print("built with    {}, for {}\n", build_info::compiler,
               build_info::architecture.empty() ? "any processor of its kind" : build_info::architecture);
    fmt::print("libraries     ");
    for (const auto& [name, version] : build_info::libraries) fmt::print("{} {}  ", name, version);
    fmt::print("\nthreads       {}\n", thread_count());
    print_processor();

    bool good = true;
    set_log_level(LogLevel::silent);
    for (const SelfCheck& check : run_self_checks()) {
        fmt::print("check         {}: {} ({})\n", check.name, check.passed ? "right" : "WRONG", check.detail);
        good = good && check.passed;
    }
    fmt::print("{}\n", good ? "All is well." : "Something is wrong; please report the lines above.");
    return good ? 0 : exit_failure;
}

}  // namespace

bool processor_suffices()
{
#if defined(__x86_64__)
    return build_info::architecture != "x86-64-v3" ||
           (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2"));
#else
    return true;
#endif
}

Command add_doctor(CLI::App& app)
{
    CLI::App* parser = app.add_subcommand("doctor", "check that everything works on this machine");
    parser->footer(
        "Examples:\n  dapple doctor                 every algorithm renders a scene whose answer is known\n"
        "  dapple doctor > doctor.txt    for a report of an error");
    return {parser, [] { return doctor(); }};
}

}  // namespace dapple::cli
