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
    return static_cast<int>(std::min<size_t>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism),
                                             1u << 16));
}

void parallel_for_ranges(int64_t count, int64_t grain, const std::function<void(int64_t, int64_t)>& body)
{
    if (count <= 0) return;
    grain = std::max<int64_t>(1, grain);
    const int64_t chunks = (count + grain - 1) / grain;
    tbb::parallel_for(
        int64_t{0}, chunks, [&](int64_t chunk) { body(chunk * grain, std::min(count, (chunk + 1) * grain)); },
        tbb::simple_partitioner());
}

void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b) { tbb::parallel_invoke(a, b); }

}  // namespace dapple
