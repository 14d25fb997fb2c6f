// A render: passes of one integrator into one film until a stop rule or the user ends it.
//
// How a render is stopped. A pass adds to the film directly. It may be cut between two pixels: those that it reached
// have a sample more, the image allows for that (Film::end_cut_pass), and nothing is lost. Which pixels are reached
// hangs on the time that those before them took and not on their own light, so there is no bias. But such a film can
// only be shown, so that it is not done where the film is to be kept, or is to estimate its error.
//
// Where not all light of a pass are eye samples (Integrator::adds_eye_samples_alone), pixels that a cut pass did not
// reach have light of it all the same: they show the image as it was before. For that the job keeps a copy of the image
// after a completed pass (floats, about a quarter of the film's memory); it also serves where a pass cannot be cut and
// is given up as a whole. A copy is made before a pass that may meet the time limit, and otherwise whenever copying has
// cost less than 2 % of the render time so far.
//   first request (Ctrl-C)   the running pass is finished, the image of all passes is returned;
//   second request           the running pass is cancelled: what there is of it is kept, or the latest copy is
//                            returned, and what it lacks is said;
//   time limit               a pass that may be cut is cut there; any other is cancelled when 4 % beyond it: the copy
//                            made before it has everything;
//   an error in a pass       as the second request, with `failed` set.
// The first pass, where it may be cut, goes over the image from coarse to fine, and is cut for time after its first
// round at the earliest: pixels that it did not reach show their neighbours. Where it may not be cut and is cancelled
// by the user, pixels not reached are black and light that was splatted is a part of the whole. `incomplete` says so
// for the header of the file and for the message.
#pragma once

#include "dapple/film/film.h"
#include "dapple/image/image.h"
#include "dapple/integrators/integrator.h"
#include "dapple/render/progress.h"
#include "dapple/render/stop_rule.h"
#include "dapple/render/write_time.h"
#include "dapple/world/world.h"

#include <atomic>
#include <string>
#include <vector>

namespace dapple {

// Requests to stop, made from any thread or from a signal handler.
class StopRequests {
public:
    void add() { count_.fetch_add(1, std::memory_order_relaxed); }
    int count() const { return count_.load(std::memory_order_relaxed); }

private:
    std::atomic<int> count_{0};
    static_assert(std::atomic<int>::is_always_lock_free);
};

// What was spent on the passes of a film.
struct RenderCounters {
    double seconds = 0;
    uint64_t eye_paths = 0, light_paths = 0, photons = 0, rays = 0;
};

// Told after each pass, on the thread that renders, while nobody writes to the film.
class PassObserver {
public:
    virtual ~PassObserver() = default;
    virtual void after_pass(const Film& film, const RenderCounters& counters) = 0;
};

// A film that already holds passes is continued: the job renders pass film.settings().first_pass + film.passes() next.
struct RenderJob {
    const World& world;
    Integrator& integrator;
    Film& film;
    std::string integrator_name;
    uint64_t seed = 0;
    StopRule stop;  // counts what the film holds already, and the time that went into it; writing included
    RenderCounters before{};
    std::vector<std::string> notes{};  // shown at the beginning, beside what the integrator reports
    WriteTime writing{};               // of the files, for which the time limit leaves room
    std::vector<PassObserver*> observers{};
    // No pass is given up for the time limit: the film stays one of whole passes, which may be continued.
    bool keep_film_whole = false;
};

struct RenderResult {
    Image image;                        // all layers, crop window
    std::vector<std::string> channels;  // OpenEXR names of the image's channels
    uint32_t first_pass = 0;
    uint32_t passes = 0;       // completed passes in the image, beside a part of one more; 0 when incomplete
    uint32_t passes_lost = 0;  // completed, but not in the image
    double seconds = 0;        // from the start of the first pass
    ErrorEstimate error;       // no batches where it was not asked for
    std::string reason;        // why the render ended, in words
    std::string incomplete;    // if the image is that of a part of the first pass, what it lacks
    bool failed = false;       // ended by an error inside of a pass
    bool film_whole = false;   // the film holds whole passes, and may be continued
    bool by_request = false;   // ended by the user
    uint64_t eye_paths = 0, light_paths = 0, photons = 0, rays = 0;
};

// Runs the job on the calling thread (and on the threads of base/parallel.h). Errors of the very first pass are thrown
// on; later ones end the render. The passes that are completed depend on the stop rule, their content on the job alone.
RenderResult run(const RenderJob& job, const StopRequests& requests, Progress& progress);

}  // namespace dapple
