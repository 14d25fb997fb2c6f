// Ctrl-C (SIGINT) and SIGTERM while a scene is loaded and rendered.
#pragma once

#include "dapple/render/render_job.h"

#include <array>
#include <csignal>

namespace dapple::cli {

// While this lives, a signal ends the program at once with a line that says so, as the signal would have done (status
// 128 + signal in a shell); after pass_to() it is a request to stop. What would end the program while it writes, a
// reader of its progress that goes away or a limit of file sizes, does not. One at a time.
class Interrupts {
public:
    Interrupts();
    ~Interrupts();
    Interrupts(const Interrupts&) = delete;
    Interrupts& operator=(const Interrupts&) = delete;

    void pass_to(StopRequests& requests);

    // 128 + the last signal; 0 when there was none.
    int status() const;

private:
    static constexpr std::array<int, 4> signals = {SIGINT, SIGTERM, SIGPIPE, SIGXFSZ};
    std::array<struct sigaction, signals.size()> before_{};
};

}  // namespace dapple::cli
