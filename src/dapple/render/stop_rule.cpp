// When a render ends. Under a time limit T, where passes are whole or nothing and take t seconds, the end is within t/2
// of T, so that T is kept within 5 % where a pass takes at most a tenth of it; the pass that overruns nevertheless is
// given up. Where passes may be cut, the end is at T (see render_job.h).
#include "dapple/render/stop_rule.h"

#include <fmt/format.h>

#include <algorithm>

namespace dapple {

void PassTimes::add(double seconds)
{
    last_.push_back(seconds);
    // The first pass also warms caches and builds what later passes share: it goes as soon as there is a second one.
    if (last_.size() == 2 && seconds < last_.front()) last_.pop_front();
    if (last_.size() > window) last_.pop_front();
}

double PassTimes::expected() const
{
    if (last_.empty()) return 0;
    double sum = 0;
    for (double seconds : last_) sum += seconds;
    return sum / static_cast<double>(last_.size());
}

StopRule StopRule::leaving(double seconds_after) const
{
    constexpr double least = 1e-3;  // 0 would be no limit
    StopRule rule = *this;
    if (seconds > 0) rule.seconds = std::max(seconds - seconds_after, std::min(seconds, least));
    return rule;
}

bool StopRule::another(uint32_t done, double elapsed, double expected_pass) const
{
    if (done == 0) return true;
    if (passes > 0 && done >= passes) return false;
    return seconds <= 0 || elapsed + 0.5 * expected_pass < seconds;
}

std::string StopRule::error_missed(double estimated) const
{
    if (error <= 0 || estimated <= error) return "";
    return fmt::format("; the estimated error is {:.3g} %, not yet {:.3g} %", 100 * estimated, 100 * error);
}

bool StopRule::error_due(uint32_t next, uint32_t done, uint32_t correlated) const
{
    const uint32_t batches = done / correlated;
    if (error <= 0 || next % correlated != 0 || batches < 4 || done < 8) return false;
    return batches % std::max(batches / 16, 1u) == 0;
}

bool StopRule::last_by_time(double elapsed, double expected_pass) const
{
    return seconds > 0 && elapsed + 1.5 * expected_pass >= seconds;
}

bool StopRule::overdue(double elapsed) const { return seconds > 0 && elapsed > seconds * (1 + tolerance); }

double StopRule::fraction(uint32_t done, double elapsed, double in_pass, double expected_pass) const
{
    double part = 0;
    if (passes > 0) {
        // A pass that takes longer than expected waits at its end; it does not run over into the next one.
        const double in_this = expected_pass > 0 ? std::min(0.99, in_pass / expected_pass) : 0.0;
        part = (done + in_this) / passes;
    }
    if (seconds > 0) part = std::max(part, elapsed / seconds);
    return std::clamp(part, 0.0, 0.999999);
}

double StopRule::remaining(uint32_t done, double elapsed, double in_pass, double expected_pass) const
{
    double left = -1;
    if (passes > 0 && expected_pass > 0)
        left = std::max(0.0, (passes - std::min(done, passes)) * expected_pass - in_pass);
    if (seconds > 0) {
        const double by_time = std::max(0.0, seconds - elapsed);
        left = left < 0 ? by_time : std::min(left, by_time);
    }
    return left;
}

}  // namespace dapple
