#include "dapple/render/checkpointer.h"

#include "dapple/base/error.h"
#include "dapple/base/log.h"

#include <algorithm>
#include <filesystem>

namespace dapple {
namespace {

constexpr double largest_share = 0.02;  // of the time that goes into writing checkpoints

}  // namespace

void set_progress(CheckpointHeader& header, const Film& film, const RenderCounters& counters)
{
    header.ranges = {{film.settings().first_pass, film.passes()}};
    header.counters = counters;
}

Checkpointer::Checkpointer(CheckpointPlan plan, CheckpointHeader header)
    : plan_(std::move(plan)), header_(std::move(header)), start_(std::chrono::steady_clock::now()), due_(plan_.first)
{
    header_.automatic = plan_.automatic;
    std::error_code ignored;
    written_ = std::filesystem::exists(plan_.path, ignored);
}

double Checkpointer::now() const
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

bool Checkpointer::write(const Film& film, const RenderCounters& counters)
{
    const double start = now();
    set_progress(header_, film, counters);
    bool good = true;
    try {
        write_checkpoint(plan_.path, header_, film);
        written_ = true;
    } catch (const UserError& error) {
        good = false;
        log_warning("{}; the render goes on without it", error.what());
    }
    due_ = now() + (good ? std::max(plan_.every, (now() - start) / largest_share) : plan_.every);
    return good;
}

void Checkpointer::after_pass(const Film& film, const RenderCounters& counters)
{
    if (now() >= due_) write(film, counters);
}

bool Checkpointer::finish(const Film& film, const RenderResult& result)
{
    const bool ended_early = result.by_request || result.failed || !result.incomplete.empty();
    if (plan_.automatic && !ended_early) {
        std::error_code ignored;
        if (written_) std::filesystem::remove(plan_.path, ignored);
        written_ = false;
        return true;
    }
    if (plan_.automatic && !written_ && now() < plan_.first) return true;
    if (!result.film_whole) return false;
    return write(film, {result.seconds, result.eye_paths, result.light_paths, result.photons, result.rays});
}

}  // namespace dapple
