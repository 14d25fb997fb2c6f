// Writes checkpoints while a render runs, between passes.
#pragma once

#include "dapple/render/checkpoint.h"

#include <chrono>
#include <string>

namespace dapple {

struct CheckpointPlan {
    std::string path;
    double first = 60;  // [s] of rendering before the first one
    double every = 60;  // [s] between them, at least; more where writing takes more than 2 % of the time
    // Not asked for: removed when the render ends as its stop rule says, and at an early end only written if one was
    // due before.
    bool automatic = false;
};

class Checkpointer final : public PassObserver {
public:
    // `header`: all but ranges and counters. The clock starts now.
    Checkpointer(CheckpointPlan plan, CheckpointHeader header);

    void after_pass(const Film& film, const RenderCounters& counters) override;

    // After the render: the last state, if the film holds whole passes. Returns false if there is to be a checkpoint
    // and it is not the last state, because that could not be written or is lost.
    bool finish(const Film& film, const RenderResult& result);

    // Whether there is a file on which `dapple resume` can go on.
    bool written() const { return written_; }
    bool automatic() const { return plan_.automatic; }
    const std::string& path() const { return plan_.path; }

private:
    double now() const;
    bool write(const Film& film, const RenderCounters& counters);

    CheckpointPlan plan_;
    CheckpointHeader header_;
    std::chrono::steady_clock::time_point start_;
    double due_;
    bool written_ = false;
};

// What the header needs to say of the passes of a film that was rendered in one go.
void set_progress(CheckpointHeader& header, const Film& film, const RenderCounters& counters);

}  // namespace dapple
