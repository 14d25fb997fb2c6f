// What a person or a program sees while a render runs.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace dapple {

// A moment of a render.
struct ProgressState {
    uint32_t passes_done = 0;
    uint32_t passes_total = 0;  // 0: unknown
    uint64_t eye_paths = 0;
    uint64_t light_paths = 0;
    uint64_t photons = 0;   // stored so far, over all passes
    double elapsed = 0;     // [s] since the start of the first pass
    double remaining = -1;  // [s]; negative: unknown
    double fraction = 0;    // in [0, 1)
    double error = -1;      // estimated error of the image, a part of its brightness; negative: unknown
    // The running pass is the last one, because the user asked for it: `remaining` and `fraction` are those of the
    // pass.
    bool stopping = false;
};

// Whole percent, rounded down and never 100: that is for the end.
int progress_percent(double fraction);

// One line without a line end: percentage, bar of `bar_width` characters, pass, samples, photons, elapsed, remaining.
std::string format_progress(const ProgressState& state, int bar_width);

// One JSON object: {"event": "progress", "pass": ..., ...}.
std::string format_progress_json(const ProgressState& state);

// A text as a JSON string, quotes included.
std::string json_string(const std::string& text);

// Receives what happens. Calls come one at a time, though not always from the same thread.
class Progress {
public:
    virtual ~Progress() = default;
    // Once, before the first pass: what the integrator resolved its settings to.
    virtual void begin(const std::string& integrator, const std::vector<std::string>& report) = 0;
    virtual void update(const ProgressState& state) = 0;
    // A message in the middle of a render ("finishing this pass ...").
    virtual void note(const std::string& text) = 0;
    // Once, after the last pass; `reason` says in words why the render ended.
    virtual void end(const ProgressState& state, const std::string& reason) = 0;
    // After a file was written.
    virtual void written(const std::string& path) = 0;
};

enum class ProgressKind { bar, json, none };

// bar: on stderr; where that is no terminal, a plain line every few seconds instead of a bar.
// json: one object per line on stdout, where no warning can come in between.
std::unique_ptr<Progress> make_progress(ProgressKind kind);

}  // namespace dapple
