// Passes, one after the other, with a second thread that watches the clock and the user.
#include "dapple/render/render_job.h"

#include "dapple/integrators/pixel_loop.h"
#include "dapple/render/memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <stop_token>
#include <thread>

namespace dapple {
namespace {

constexpr double copy_share = 0.02;  // largest part of the render time spent on copies of the image
constexpr double look_share = 0.1;   // largest part of a thread's time spent on looking at the picture
constexpr std::chrono::milliseconds tick{50};
constexpr int ticks_per_update = 4;

class Runner {
public:
    Runner(const RenderJob& job, const StopRequests& requests, Progress& progress)
        : job_(job),
          requests_(requests),
          progress_(progress),
          writing_(job.writing.expected()),
          may_cut_(!job.keep_film_whole && !job.film.settings().error_layer),
          // Adding a film to another reads two, and makes no image.
          adding_(may_cut_ && job.integrator.light_comes_last() ? 1.5 * job.writing.layers : 0.0),
          eyes_alone_(job.integrator.adds_eye_samples_alone()),
          first_round_(pixels_of_first_round(job.film.settings())),
          done_(job.film.passes())
    {
        statistics_.eye_paths = job.before.eye_paths;
        statistics_.light_paths = job.before.light_paths;
        statistics_.photons_stored = job.before.photons;
        statistics_.rays = job.before.rays;
        eye_paths_before_pass_ = job.before.eye_paths;
    }

    RenderResult run()
    {
        std::vector<std::string> report = job_.integrator.report();
        report.insert(report.end(), job_.notes.begin(), job_.notes.end());
        progress_.begin(job_.integrator_name, report);
        start_ = Clock::now();
        {
            const std::jthread watcher([this](const std::stop_token& token) { watch(token); });
            run_passes();
        }
        finish();
        progress_.end(state(), result_.reason);
        return std::move(result_);
    }

private:
    using Clock = std::chrono::steady_clock;

    double elapsed() const
    {
        return job_.before.seconds + std::chrono::duration<double>(Clock::now() - start_).count();
    }

    StopRule stop() const { return job_.stop.leaving(writing_.load() + adding_); }  // for the passes

    uint32_t next_pass() const { return job_.film.settings().first_pass + done_; }

    void run_passes()
    {
        if (done_ > 0) estimate_error();
        while (!error_reached_ && stop().another(done_, elapsed(), may_cut_ ? 0.0 : times_.expected())) {
            if (done_ > 0 && requests_.count() > 0) break;
            copy_if_due();
            begin_pass();
            try {
                job_.integrator.render_pass(context_of_pass(), job_.film);
            } catch (const std::exception& error) {
                if (done_ == 0) throw;
                result_.failed = true;
                result_.reason = std::string("stopped by an error in a pass: ") + error.what();
                // Pixels may lack the light that was to come after their eye paths.
                const std::lock_guard lock(mutex_);
                if (!eyes_alone_) job_.film.give_up_pass();
                return;
            }
            if (cancel_.load() && !is_whole()) return;
            end_pass();
            estimate_error();
            for (PassObserver* observer : job_.observers) observer->after_pass(job_.film, counters());
        }
        result_.reason = why_ended() + (passes_at_error_ > 0 ? stop().error_missed(error_) : "");
        whole_ = true;
    }

    PassContext context_of_pass()
    {
        PassContext context{job_.world, job_.seed, next_pass(), statistics_, &cancel_};
        context.coarse_to_fine = done_ == 0 && shows_part();
        if (may_cut_ && may_give_up_ && stop().seconds > 0) context.half_time = &half_time_;
        return context;
    }

    // A pass that is cancelled at its end may be whole.
    bool is_whole() const { return may_cut_ && eyes_alone_ && job_.film.reached_part() == 1.0; }
    // Whether the film can show a part of the running pass. The order from coarse to fine takes bidirectional methods 3
    // to 5 % longer: only under a time limit.
    bool shows_part() const
    {
        return may_cut_ && (eyes_alone_ || (done_ > 0 ? copied_passes_ == done_ : stop().seconds > 0));
    }

    // Where the stop rule asks for an error and it is due. Whether it is depends on the pass alone, so a render that
    // was interrupted ends at the same pass.
    void estimate_error()
    {
        if (!stop().error_due(next_pass(), done_, job_.film.settings().correlated_passes)) return;
        const ErrorEstimate error = job_.film.error();
        error_reached_ = error.total() <= stop().error;
        const std::lock_guard lock(mutex_);
        error_ = error.total();
        passes_at_error_ = done_;
    }

    std::string why_ended()
    {
        if (error_reached_) return fmt::format("the estimated error is {:.3g} %", 100 * error_);
        if (requests_.count() > 0) return "stopped by request";
        if (stop().passes > 0 && done_ >= stop().passes) return "all passes done";
        const double beyond = elapsed() + times_.expected() - stop().seconds;
        if (may_cut_ || elapsed() > 0.95 * stop().seconds) return "time is up";
        return fmt::format("time is up: the next pass would end {:.1f} s after the limit", beyond);
    }

    // Copies the image of the completed passes where the running pass may be given up, or where it costs little.
    void copy_if_due()
    {
        if ((may_cut_ && eyes_alone_) || done_ == 0 || copied_passes_ == done_) return;
        const double now = elapsed();
        const bool may_be_given_up = !job_.keep_film_whole && stop().last_by_time(now, times_.expected());
        if (!may_be_given_up && now - last_copy_ < copy_cost_ / copy_share) return;
        copy_ = job_.film.layers(copy_channels_);
        copied_passes_ = done_;
        last_copy_ = elapsed();
        copy_cost_ = last_copy_ - now;
    }

    void begin_pass()
    {
        const std::lock_guard lock(mutex_);
        pass_start_ = elapsed();
        half_time_.store(cancel_.load());
        may_give_up_ = !job_.keep_film_whole && (shows_part() || (done_ > 0 && copied_passes_ == done_));
    }

    void end_pass()
    {
        const std::lock_guard lock(mutex_);
        job_.film.end_pass();
        times_.add(elapsed() - pass_start_);
        done_ = job_.film.passes();
        pass_start_ = elapsed();
        eye_paths_before_pass_ = statistics_.eye_paths.load();
        may_give_up_ = false;
    }

    bool shows_all() const { return done_ > 0 || statistics_.eye_paths.load() >= first_round_; }

    // A tick, or less where a pass is to be cut before that.
    std::chrono::duration<double> until_next_look() const
    {
        const double left = stop().seconds - elapsed();
        return may_cut_ && left > 0 ? std::min<std::chrono::duration<double>>(tick, std::chrono::duration<double>(left))
                                    : tick;
    }

    // Looks at the picture once it shows all of itself, to see how long writing will take; more often towards the end.
    // Where that does not matter, what was expected stays.
    void look_at_picture()
    {
        const double now = elapsed(), least = 4 * std::chrono::duration<double>(tick).count();
        if (job_.writing.noise < 0.01 * job_.stop.seconds) return;
        if (now < next_look_ || now < job_.stop.seconds - 1.5 * job_.writing.noise) return;
        if (cancel_.load() || stop().seconds - now < 2 * look_cost_) return;  // it would delay the end
        std::unique_lock lock(mutex_);
        if (!shows_all()) return;
        const Image sample = job_.film.sample_rows(16);
        lock.unlock();
        writing_ = job_.writing.seconds(
            sample, done_ == 0 && job_.integrator.light_comes_last() ? WriteTime::late_channels : 0);
        look_cost_ = elapsed() - now;
        next_look_ = now + std::max({0.5 * (stop().seconds - now), look_cost_ / look_share, least});
    }

    // Ends what must end for time.
    void look_at_clock()
    {
        const std::lock_guard lock(mutex_);
        if (!may_give_up_ || !shows_all()) return;
        const double now = elapsed();
        if (may_cut_ && stop().time_is_up(2 * now - pass_start_)) half_time_.store(true);
        if (may_cut_ ? stop().time_is_up(now) : stop().overdue(now)) cancel(Cause::time);
    }

    // The second thread: reports progress, and cancels the running pass when it must.
    void watch(const std::stop_token& token)
    {
        std::mutex sleep_mutex;
        std::unique_lock sleep(sleep_mutex);
        std::condition_variable_any wake;
        bool announced = false;
        for (int ticks = 1; !token.stop_requested(); ++ticks) {
            wake.wait_for(sleep, token, until_next_look(), [] { return false; });
            const int asked = requests_.count();
            if (asked == 1 && !announced) {
                progress_.note("finishing this pass; press Ctrl-C again to stop at once");
                announced = true;
            }
            if (asked > 1) cancel(Cause::user);
            look_at_clock();
            if (job_.stop.seconds > 0) look_at_picture();
            if (ticks % ticks_per_update == 0 && !token.stop_requested()) progress_.update(state());
        }
    }

    enum class Cause { none, user, time };
    void cancel(Cause cause)
    {
        Cause none = Cause::none;
        cause_.compare_exchange_strong(none, cause);
        cancel_.store(true);
        half_time_.store(true);
    }

    ProgressState state()
    {
        const std::lock_guard lock(mutex_);
        const double now = elapsed();
        const double in_pass = now - pass_start_;
        ProgressState state;
        state.passes_done = done_;
        state.passes_total = stop().passes;
        state.eye_paths = statistics_.eye_paths.load();
        state.light_paths = statistics_.light_paths.load();
        state.photons = statistics_.photons_stored.load();
        state.elapsed = now;
        state.remaining = stop().remaining(done_, now, in_pass, times_.expected());
        state.fraction = stop().fraction(done_, now, in_pass, times_.expected());
        state.stopping = requests_.count() > 0;
        if (passes_at_error_ > 0) {
            // The error of a mean falls with the square root of the passes.
            state.error = error_ * std::sqrt(static_cast<double>(passes_at_error_) / std::max(done_, 1u));
            const double ratio = error_ / stop().error;
            const double left = (ratio * ratio * passes_at_error_ - done_) * times_.expected() - in_pass;
            if (state.remaining < 0 || left < state.remaining) {
                state.remaining = std::max(left, 0.0);
                state.fraction = now / (now + state.remaining + times_.expected());
            }
        }
        if (state.stopping) {
            const double part = part_of_pass(in_pass, state.eye_paths);
            state.fraction = part;
            state.remaining = part > 0 ? in_pass / part - in_pass : -1.0;
        }
        return state;
    }

    // How much of the running pass is done, in [0, 1): by the time that passes take, in the first by its eye paths.
    double part_of_pass(double in_pass, uint64_t eye_paths) const
    {
        const double expected = times_.expected();
        const double part = expected > 0 ? in_pass / expected
                                         : static_cast<double>(eye_paths - eye_paths_before_pass_) /
                                               static_cast<double>(pixel_count(job_.film.settings()));
        return std::min(part, 0.99);
    }

    RenderCounters counters() const
    {
        return {elapsed(), statistics_.eye_paths.load(), statistics_.light_paths.load(),
                statistics_.photons_stored.load(), statistics_.rays.load()};
    }

    // Takes the image that may be shown; see the head of render_job.h.
    void finish()
    {
        result_.seconds = elapsed();
        const double cut_part = may_cut_ && !whole_ ? job_.film.reached_part() : 0.0;
        result_.first_pass = job_.film.settings().first_pass;
        result_.film_whole = whole_;
        result_.by_request = requests_.count() > 0;
        if (whole_) {
            if (done_ == 1 && stop().overdue(result_.seconds))
                progress_.note("one pass of this scene takes longer than the time limit; it was finished");
            result_.image = job_.film.layers(result_.channels);
            result_.passes = done_;
            result_.error = job_.film.error();
        } else {
            if (!result_.failed) result_.reason = why_cut(cut_part);
            if (shows_part() && (cut_part > 0 || (eyes_alone_ && done_ > 0))) {
                take_cut(cut_part);
            } else if (copied_passes_ > 0) {
                result_.image = std::move(copy_);
                result_.channels = std::move(copy_channels_);
                result_.passes = copied_passes_;
                result_.passes_lost = done_ - copied_passes_;
            } else {
                take_incomplete();
            }
        }
        result_.eye_paths = statistics_.eye_paths.load();
        result_.light_paths = statistics_.light_paths.load();
        result_.photons = statistics_.photons_stored.load();
        result_.rays = statistics_.rays.load();
    }

    std::string why_cut(double part) const
    {
        const char* why = cause_.load() == Cause::time ? "time is up" : "stopped at once by request";
        if (part > 0)
            return fmt::format("{}, with {:.0f} % of {}", why, std::floor(100 * part),
                               done_ > 0 ? "another pass" : "the first pass");
        return std::string(why) + ", the last pass was given up";
    }

    // Whole passes, and a part of one more for some pixels.
    void take_cut(double part)
    {
        if (part > 0) job_.film.end_cut_pass(eyes_alone_ ? Image() : std::move(copy_));
        result_.film_whole = part == 0;
        result_.image = job_.film.layers(result_.channels);
        result_.passes = done_;
        if (done_ > 0) return;
        result_.incomplete =
            part == 1.0
                ? std::string("the first pass was cut short: it has not all of its light paths")
                : fmt::format(
                      "the first pass was cut short at {:.0f} %: pixels that it did not reach show their nearest "
                      "neighbours",
                      std::floor(100 * part));
    }

    // Cancelled before there was any copy. The film holds `done` passes and a part of one more. Only when done is 0 is
    // there no better image; a film after its first pass is always copied before the second (the cost is not known
    // yet).
    void take_incomplete()
    {
        job_.film.end_pass();
        result_.image = job_.film.layers(result_.channels);
        result_.incomplete =
            "the first pass was cut short: black pixels were not reached, and light from light paths is too dark";
    }

    const RenderJob& job_;
    const StopRequests& requests_;
    Progress& progress_;
    Statistics statistics_;
    RenderResult result_;
    Clock::time_point start_;
    std::atomic<double> writing_;           // that is expected [s]
    double next_look_ = 0, look_cost_ = 0;  // at the picture, by the watcher [s]
    std::atomic<Cause> cause_{Cause::none};
    std::atomic<bool> cancel_{false};
    std::atomic<bool> half_time_{false};  // of what is left for the running pass
    const bool may_cut_;                  // a part of a pass may be kept
    const double adding_;                 // the light that comes last [s]
    const bool eyes_alone_;
    const uint64_t first_round_;

    Image copy_;
    std::vector<std::string> copy_channels_;
    double last_copy_ = 0;
    double copy_cost_ = 0;
    uint32_t copied_passes_ = 0;
    bool error_reached_ = false;
    bool whole_ = false;

    std::mutex mutex_;  // guards what the watcher reads: from here on
    PassTimes times_;
    double error_ = 0;
    double pass_start_ = 0;
    uint64_t eye_paths_before_pass_ = 0;
    uint32_t done_;
    uint32_t passes_at_error_ = 0;  // 0: the error is not known
    bool may_give_up_ = false;
};

}  // namespace

RenderResult run(const RenderJob& job, const StopRequests& requests, Progress& progress)
{
    return Runner(job, requests, progress).run();
}

}  // namespace dapple
