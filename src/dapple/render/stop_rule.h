// When a render ends: after a number of passes, after a time, or at whichever comes first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>

namespace dapple {

// Expected duration of the next pass: the mean of the last few. Photon maps are built in the first pass of an epoch
// only, so that single passes differ and a mean is wanted; old passes are forgotten, because the load of a machine
// changes.
class PassTimes {
public:
    void add(double seconds);
    // [s]; 0 while there is no pass.
    double expected() const;

private:
    static constexpr size_t window = 8;
    std::deque<double> last_;
};

struct StopRule {
    uint32_t passes = 0;  // 0: no limit
    double seconds = 0;   // render time, counted from the start of the first pass; 0: no limit
    double error = 0;     // estimated error of the image (ErrorEstimate::total); 0: none is asked for

    // The rule with so many seconds less, where it has a time limit: for what comes after the passes.
    StopRule leaving(double seconds_after) const;

    // How far past the time limit a running pass may go before it is given up, as a part of the limit.
    static constexpr double tolerance = 0.04;

    // Whether to start another pass after `done` passes and `elapsed` seconds. There is always a first pass. Under a
    // time limit the next pass is started if the render is expected to end nearer to the limit with it than without it;
    // expected_pass of 0, for passes that may be cut at the limit: while there is time.
    bool another(uint32_t done, double elapsed, double expected_pass) const;

    // Whether to look at the error before pass `next`, when `done` passes are there and `correlated` ones make a batch:
    // at the ends of batches, from 4 batches and 8 passes on, and ever more rarely, so that it costs little. Depends on
    // passes alone.
    bool error_due(uint32_t next, uint32_t done, uint32_t correlated) const;

    // "; the estimated error is 9 %, not yet 5 %", where one was asked for and `estimated` does not reach it.
    std::string error_missed(double estimated) const;

    // Whether the pass started now is expected to be the last one by time.
    bool last_by_time(double elapsed, double expected_pass) const;

    // Whether the time is over.
    bool time_is_up(double elapsed) const { return seconds > 0 && elapsed >= seconds; }
    // Whether a running pass has passed the limit by more than the tolerance.
    bool overdue(double elapsed) const;

    // Part of the render that is done, in [0, 1); `in_pass` is the time spent in the running pass.
    double fraction(uint32_t done, double elapsed, double in_pass, double expected_pass) const;

    // Expected time to the end [s]; negative when there is nothing to tell it from.
    double remaining(uint32_t done, double elapsed, double in_pass, double expected_pass) const;
};

}  // namespace dapple
