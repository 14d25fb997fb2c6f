#include "dapple/base/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <memory>

namespace dapple {
namespace {

std::unique_ptr<tbb::global_control> control;

// oneTBB is not built for the thread sanitizer, so that it does not see that a body runs after the call that started it
// and before that call returns. These marks tell it, in sanitizer builds only; bodies among themselves stay unordered.
#if defined(__SANITIZE_THREAD__)
extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);
#define DAPPLE_UNSANITIZED __attribute__((no_sanitize("thread")))
struct ForkAndJoin {
    ForkAndJoin() { __tsan_release(&fork); }
    ~ForkAndJoin() { __tsan_acquire(&join); }
    void enter() { __tsan_acquire(&fork); }
    void leave() { __tsan_release(&join); }
    char fork = 0, join = 0;
};
#else
#define DAPPLE_UNSANITIZED
struct ForkAndJoin {
    void enter() {}
    void leave() {}
};
#endif

}  // namespace

void set_thread_count(int threads)
{
    control.reset();
    if (threads > 0)
        control = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                        static_cast<size_t>(threads));
}

int thread_count()
{
    return static_cast<int>(
        std::min<size_t>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism), 1u << 16));
}

void parallel_for_ranges(int64_t count, int64_t grain, const std::function<void(int64_t, int64_t)>& body)
{
    if (count <= 0) return;
    grain = std::max<int64_t>(1, grain);
    const int64_t chunks = (count + grain - 1) / grain;
    ForkAndJoin marks;
    tbb::parallel_for(
        int64_t{0}, chunks,
        [&](int64_t chunk) DAPPLE_UNSANITIZED {
            marks.enter();
            body(chunk * grain, std::min(count, (chunk + 1) * grain));
            marks.leave();
        },
        tbb::simple_partitioner());
}

void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b)
{
    ForkAndJoin marks;
    const auto marked = [&marks](const std::function<void()>& work) DAPPLE_UNSANITIZED {
        marks.enter();
        work();
        marks.leave();
    };
    tbb::parallel_invoke([&]() DAPPLE_UNSANITIZED { marked(a); }, [&]() DAPPLE_UNSANITIZED { marked(b); });
}

}  // namespace dapple
