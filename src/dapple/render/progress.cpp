// What a person or a program sees while a render runs.
#include "dapple/render/progress.h"

#include "dapple/base/words.h"
#include "dapple/render/duration.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace dapple {
namespace {

constexpr int terminal_bar_width = 24;
constexpr double seconds_between_lines = 5.0;

// Errors are left alone: a render does not end because nobody reads of its progress any more.
void put(std::FILE* stream, const std::string& text)
{
    std::fputs(text.c_str(), stream);
    std::fflush(stream);
}

size_t terminal_columns()
{
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

// On one line: without the bar where it has no room, and cut where that is not enough.
std::string fitting(const ProgressState& state, size_t columns)
{
    std::string text = format_progress(state, terminal_bar_width);
    if (text.size() >= columns) text = format_progress(state, 0);
    return text.substr(0, columns - 1);
}

class BarProgress final : public Progress {
public:
    explicit BarProgress(bool terminal) : terminal_(terminal) {}

    void begin(const std::string& integrator, const std::vector<std::string>& report) override
    {
        print_line(integrator);
        for (const std::string& line : report) print_line("  " + line);
    }

    void update(const ProgressState& state) override
    {
        if (terminal_) {
            put(stderr, fmt::format("\r\x1b[K{}", fitting(state, terminal_columns())));
            bar_shown_ = true;
        } else if (state.elapsed - last_line_ >= seconds_between_lines) {
            last_line_ = state.elapsed;
            print_line(format_progress(state, 0));
        }
    }

    void note(const std::string& text) override { print_line(text); }

    void end(const ProgressState& state, const std::string& reason) override
    {
        std::string done = fmt::format("{} in {:.1f} s", counted(state.passes_done, "pass"), state.elapsed);
        if (state.photons > 0)
            done += fmt::format(", {} {}", format_count(state.photons), plural(state.photons, "photon"));
        print_line(done + ": " + reason);
    }

    void written(const std::string& path) override { print_line("wrote " + path); }

private:
    void print_line(const std::string& text)
    {
        put(stderr, fmt::format("{}{}\n", bar_shown_ ? "\r\x1b[K" : "", text));
        bar_shown_ = false;
    }

    bool terminal_;
    bool bar_shown_ = false;
    double last_line_ = 0;
};

class JsonProgress final : public Progress {
public:
    void begin(const std::string& integrator, const std::vector<std::string>& report) override
    {
        std::string lines;
        for (const std::string& line : report) lines += (lines.empty() ? "" : ", ") + json_string(line);
        print(fmt::format(R"({{"event": "begin", "integrator": {}, "report": [{}]}})", json_string(integrator), lines));
    }

    void update(const ProgressState& state) override { print(format_progress_json(state)); }

    void note(const std::string& text) override
    {
        print(fmt::format(R"({{"event": "note", "text": {}}})", json_string(text)));
    }

    void end(const ProgressState& state, const std::string& reason) override
    {
        print(fmt::format(R"({{"event": "end", "passes": {}, "elapsed": {:.3f}, "eye_paths": {}, "light_paths": {}, )"
                          R"("photons": {}, "reason": {}}})",
                          state.passes_done, state.elapsed, state.eye_paths, state.light_paths, state.photons,
                          json_string(reason)));
    }

    void written(const std::string& path) override
    {
        print(fmt::format(R"({{"event": "written", "path": {}}})", json_string(path)));
    }

private:
    static void print(const std::string& line) { put(stdout, line + "\n"); }
};

class NoProgress final : public Progress {
public:
    void begin(const std::string&, const std::vector<std::string>&) override {}
    void update(const ProgressState&) override {}
    void note(const std::string&) override {}
    void end(const ProgressState&, const std::string&) override {}
    void written(const std::string&) override {}
};

}  // namespace

int progress_percent(double fraction)
{
    return std::clamp(static_cast<int>(std::floor(std::clamp(fraction, 0.0, 1.0) * 100)), 0, 99);
}

std::string format_progress(const ProgressState& state, int bar_width)
{
    std::string text;
    const bool known = state.passes_total > 0 || state.remaining >= 0 || state.stopping;
    if (known) text += fmt::format("{:2} % ", progress_percent(state.fraction));
    if (known && bar_width > 0) {
        const int filled = std::min(static_cast<int>(state.fraction * bar_width), bar_width - 1);
        text += fmt::format("[{:#<{}}{:.<{}}] ", "", filled, "", bar_width - filled);
    }
    text += fmt::format("{}pass {}", state.stopping ? "of " : "", state.passes_done + 1);
    if (state.stopping)
        text += ", the last";
    else if (state.passes_total > 0)
        text += fmt::format(" of {}", state.passes_total);
    if (state.eye_paths > 0) text += fmt::format(", {} eye paths", format_count(state.eye_paths));
    if (state.light_paths > 0) text += fmt::format(", {} light paths", format_count(state.light_paths));
    if (state.photons > 0) text += fmt::format(", {} photons", format_count(state.photons));
    if (state.error >= 0) text += fmt::format(", error {:.2g} %", 100 * state.error);
    text += fmt::format(", {} gone", format_duration(state.elapsed));
    if (state.remaining >= 0) text += fmt::format(", {} left", format_duration(state.remaining));
    return text;
}

std::string format_progress_json(const ProgressState& state)
{
    const auto optional = [](bool known, auto value) { return known ? fmt::format("{}", value) : std::string("null"); };
    return fmt::format(
        R"({{"event": "progress", "pass": {}, "passes": {}, "eye_paths": {}, "light_paths": {}, )"
        R"("photons": {}, "elapsed": {:.3f}, "remaining": {}, "percent": {}, "error": {}, "stopping": {}}})",
        state.passes_done + 1, optional(state.passes_total > 0, state.passes_total), state.eye_paths, state.light_paths,
        state.photons, state.elapsed, optional(state.remaining >= 0, std::floor(state.remaining)),
        progress_percent(state.fraction), optional(state.error >= 0, fmt::format("{:.5f}", state.error)),
        state.stopping);
}

std::string json_string(const std::string& text)
{
    std::string quoted = "\"";
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\')
            quoted += std::string("\\") + c;
        else if (code < 0x20)
            quoted += fmt::format("\\u{:04x}", code);
        else
            quoted += c;
    }
    return quoted + "\"";
}

std::unique_ptr<Progress> make_progress(ProgressKind kind)
{
    switch (kind) {
        case ProgressKind::bar: return std::make_unique<BarProgress>(isatty(STDERR_FILENO) != 0);
        case ProgressKind::json: return std::make_unique<JsonProgress>();
        case ProgressKind::none: break;
    }
    return std::make_unique<NoProgress>();
}

}  // namespace dapple
