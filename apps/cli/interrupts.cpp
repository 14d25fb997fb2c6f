#include "interrupts.h"

#include <unistd.h>

#include <atomic>
#include <string_view>

namespace dapple::cli {
namespace {

std::atomic<StopRequests*> stop_requests{nullptr};
std::atomic<int> last_signal{0};
static_assert(std::atomic<StopRequests*>::is_always_lock_free);

// In a signal handler: nothing but what is safe there.
void on_signal(int signal)
{
    last_signal = signal;
    if (StopRequests* requests = stop_requests) {
        requests->add();
        return;
    }
    constexpr std::string_view line = "dapple: error: interrupted while loading the scene: nothing is written\n";
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, line.data(), line.size());
    ::signal(signal, SIG_DFL);
    ::raise(signal);
}

}  // namespace

Interrupts::Interrupts()
{
    struct sigaction action = {};
    for (size_t i = 0; i < signals.size(); ++i) {
        action.sa_handler = signals[i] == SIGINT || signals[i] == SIGTERM ? on_signal : SIG_IGN;
        sigaction(signals[i], &action, &before_[i]);
    }
}

Interrupts::~Interrupts()
{
    for (size_t i = 0; i < signals.size(); ++i) sigaction(signals[i], &before_[i], nullptr);
    stop_requests = nullptr;
}

void Interrupts::pass_to(StopRequests& requests) { stop_requests = &requests; }

int Interrupts::status() const { return last_signal == 0 ? 0 : 128 + last_signal; }

}  // namespace dapple::cli
