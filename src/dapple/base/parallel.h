// Parallel loops; oneTBB is hidden here. Bodies run in any order on any thread, so they must write to places of their
// own or add in an order-independent way (see film/exact_sum.h).
#pragma once

#include <cstdint>
#include <functional>

namespace dapple {

// Threads used by every later parallel call; 0 means all cores the process may use.
void set_thread_count(int threads);
int thread_count();

// Calls body(begin, end) on disjoint ranges that cover [0, count), each at most `grain` long and starting at a
// multiple of `grain`: the split depends on count and grain alone, never on the number of threads.
void parallel_for_ranges(int64_t count, int64_t grain, const std::function<void(int64_t begin, int64_t end)>& body);

// Calls body(i) for each i in [0, count).
template <class Body>
void parallel_for(int64_t count, int64_t grain, const Body& body)
{
    parallel_for_ranges(count, grain, [&](int64_t begin, int64_t end) {
        for (int64_t i = begin; i < end; ++i) body(i);
    });
}

// Runs both, possibly at the same time; returns when both are done.
void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b);

}  // namespace dapple
