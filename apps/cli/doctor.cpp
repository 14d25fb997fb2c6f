// `dapple doctor`: says what the program was built from, whether this machine can run it, and renders a scene whose
// answer is known.
#include "build_info.h"
#include "commands.h"
#include "dapple/base/log.h"
#include "dapple/base/parallel.h"
#include "dapple/render/self_check.h"

#include <fmt/format.h>

#include <array>
#include <string_view>

namespace dapple::cli {
namespace {

// The features of x86-64-v3 that matter here; the program is built for it by default.
bool print_cpu_features()
{
#if defined(__x86_64__)
    const std::array<std::pair<std::string_view, bool>, 4> features = {
        {{"avx2", __builtin_cpu_supports("avx2") != 0},
         {"fma", __builtin_cpu_supports("fma") != 0},
         {"bmi2", __builtin_cpu_supports("bmi2") != 0},
         {"avx512f", __builtin_cpu_supports("avx512f") != 0}}};
    fmt::print("processor     ");
    for (const auto& [name, has] : features) fmt::print("{}{} ", has ? "" : "no ", name);
    fmt::print("\n");
    const bool needed = build_info::architecture == "x86-64-v3";
    return !needed || (features[0].second && features[1].second && features[2].second);
#else
    fmt::print("processor     not x86-64\n");
    return true;
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
    bool good = print_cpu_features();
    if (!good)
        fmt::print("problem       this processor lacks what the program was built for; build with -DDAPPLE_ARCH=\n");

    set_log_level(LogLevel::silent);
    for (const SelfCheck& check : run_self_checks()) {
        fmt::print("check         {}: {} ({})\n", check.name, check.passed ? "right" : "WRONG", check.detail);
        good = good && check.passed;
    }
    fmt::print("{}\n", good ? "All is well." : "Something is wrong; please report the lines above.");
    return good ? 0 : exit_failure;
}

}  // namespace

Command add_doctor(CLI::App& app)
{
    CLI::App* parser = app.add_subcommand("doctor", "check that everything works on this machine");
    return {parser, [] { return doctor(); }};
}

}  // namespace dapple::cli
