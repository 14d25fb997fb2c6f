// What shading, sampling and bookkeeping cost beside ray traversal: the rays of `path` and of photon tracing are
// recorded where they enter Embree, then traced again by bare Embree calls, in the same order and with nothing around
// them. ratio = bare time / time of the whole algorithm (film and photon storage included) for these very rays.
// Rounds measure all parts one after the other, so that other load on the machine strikes all alike; medians are
// printed, of CPU seconds (one thread, and two) and of wall seconds.
// The linker puts record_* in the place of Embree's entries (--wrap, see CMakeLists.txt).
// Usage: bench_rays [rounds] [scene folder] [only lines that contain this, e.g. "cornell-box path"]
#include "dapple/base/parallel.h"
#include "dapple/formats/pbrt.h"
#include "dapple/integrators/registry.h"
#include "dapple/render/film_settings.h"
#include "dapple/transport/photon_tracing.h"
#include "dapple/world/compile.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
using QueryArguments = RTCIntersectArguments;
using ShadowArguments = RTCOccludedArguments;
#else
#include <embree3/rtcore.h>
using QueryArguments = RTCIntersectContext;
using ShadowArguments = RTCIntersectContext;
#endif

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

using namespace dapple;

namespace {

struct RecordedRay {
    float origin[3], t_near, direction[3], time, t_max;
    bool shadow;
};

struct Recording {
    RTCScene scene = nullptr;
    std::vector<RecordedRay> rays;
    size_t shadows = 0;
};
Recording* recording = nullptr;  // set while one thread alone traces

void record(RTCScene scene, const RTCRay& ray, bool shadow)
{
    // Rays within user geometry callbacks do not exist; all queries are for one scene.
    recording->scene = scene;
    recording->shadows += shadow ? 1 : 0;
    recording->rays.push_back(
        {{ray.org_x, ray.org_y, ray.org_z}, ray.tnear, {ray.dir_x, ray.dir_y, ray.dir_z}, ray.time, ray.tfar, shadow});
}

}  // namespace

extern "C" {
void __real_rtcIntersect1(RTCScene scene, QueryArguments* arguments, RTCRayHit* query);
void __real_rtcOccluded1(RTCScene scene, ShadowArguments* arguments, RTCRay* query);

void __wrap_rtcIntersect1(RTCScene scene, QueryArguments* arguments, RTCRayHit* query)
{
    if (recording) record(scene, query->ray, false);
    __real_rtcIntersect1(scene, arguments, query);
}

void __wrap_rtcOccluded1(RTCScene scene, ShadowArguments* arguments, RTCRay* query)
{
    if (recording) record(scene, *query, true);
    __real_rtcOccluded1(scene, arguments, query);
}
}

namespace {

// What stays after compilation so that the calls cannot be left out.
std::atomic<uint64_t> hits{0};

void trace_again(const Recording& recorded, int64_t begin, int64_t end)
{
    uint64_t count = 0;
    for (int64_t i = begin; i < end; ++i) {
        const RecordedRay& ray = recorded.rays[static_cast<size_t>(i)];
        RTCRayHit query;
        query.ray = {ray.origin[0],
                     ray.origin[1],
                     ray.origin[2],
                     ray.t_near,
                     ray.direction[0],
                     ray.direction[1],
                     ray.direction[2],
                     ray.time,
                     ray.t_max,
                     0xffffffffu,
                     0,
                     0};
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if __has_include(<embree4/rtcore.h>)
        if (ray.shadow)
            __real_rtcOccluded1(recorded.scene, nullptr, &query.ray);
        else
            __real_rtcIntersect1(recorded.scene, nullptr, &query);
#else
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        if (ray.shadow)
            __real_rtcOccluded1(recorded.scene, &context, &query.ray);
        else
            __real_rtcIntersect1(recorded.scene, &context, &query);
#endif
        count += ray.shadow ? query.ray.tfar < 0.0f : query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
    hits += count;
}

struct Seconds {
    double cpu = 0.0;
    double wall = 0.0;
};

double clock_seconds(clockid_t clock)
{
    timespec now;
    clock_gettime(clock, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Seconds timed(const std::function<void()>& body)
{
    const double cpu = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
    const double wall = clock_seconds(CLOCK_MONOTONIC);
    body();
    return {clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu, clock_seconds(CLOCK_MONOTONIC) - wall};
}

double median(std::vector<Seconds> values, double Seconds::*part)
{
    std::sort(values.begin(), values.end(), [&](const Seconds& a, const Seconds& b) { return a.*part < b.*part; });
    return values[values.size() / 2].*part;
}

// Times `algorithm` against bare calls for its rays, and prints a line per number of threads.
void compare(const std::string& name, int rounds, const std::function<void()>& algorithm)
{
    set_thread_count(1);
    algorithm();  // what is built once is not measured
    Recording recorded;
    recording = &recorded;
    algorithm();
    recording = nullptr;
    const double rays = static_cast<double>(recorded.rays.size());
    const double segments = rays - static_cast<double>(recorded.shadows);
    for (const int threads : {1, 2}) {
        set_thread_count(threads);
        const auto bare = [&] {
            parallel_for_ranges(static_cast<int64_t>(recorded.rays.size()), 4096,
                                [&](int64_t begin, int64_t end) { trace_again(recorded, begin, end); });
        };
        std::vector<Seconds> bare_times, times;
        for (int round = 0; round < rounds; ++round) {
            bare_times.push_back(timed(bare));
            times.push_back(timed(algorithm));
        }
        const double bare_cpu = median(bare_times, &Seconds::cpu), cpu = median(times, &Seconds::cpu);
        const double wall = median(times, &Seconds::wall);
        std::printf("%-28s %d  %7.2f M %4.0f %%  %8.1f %8.1f ns  %6.2f M/s %6.2f M/s  %5.1f %% (wall %5.1f %%)\n",
                    name.c_str(), threads, rays * 1e-6, 100.0 * segments / rays, bare_cpu / rays * 1e9,
                    cpu / rays * 1e9, segments / wall * 1e-6, segments / cpu * 1e-6, 100.0 * bare_cpu / cpu,
                    100.0 * median(bare_times, &Seconds::wall) / wall);
        std::fflush(stdout);
    }
}

void measure(const std::string& name, const std::filesystem::path& file, int rounds, const std::string& filter)
{
    if (!std::filesystem::exists(file)) {
        std::printf("%s: not here, left out\n", file.c_str());
        return;
    }
    const auto wanted = [&](const char* algorithm) {
        return (name + ' ' + algorithm).find(filter) != std::string::npos;
    };
    if (!wanted("path") && !wanted("photons")) return;
    scene::Description description = read_pbrt(file);
    set_resolution(description.film, Int2(192, 192));
    const std::unique_ptr<World> world = compile(description);
    if (wanted("path")) {
        const IntegratorEntry& entry = find_integrator("path");
        const std::unique_ptr<Integrator> integrator = entry.create(*world, Settings(entry.settings));
        Film film(film_settings(description, *world, LayerChoice{}, false, ColorModel::spectral));
        Statistics statistics;
        compare(name + " path", rounds, [&] { integrator->render_pass(PassContext{*world, 1, 0, statistics}, film); });
    }
    if (wanted("photons")) {
        PhotonRequest request;
        request.wavelengths = Wavelengths::sample_visible(0.3f);
        request.paths = 50000;
        compare(name + " photons", rounds, [&] { trace_photons(*world, request); });
    }
}

}  // namespace

int main(int argc, char** argv)
{
    const int rounds = argc > 1 ? std::atoi(argv[1]) : 5;
    const std::filesystem::path folder = argc > 2 ? argv[2] : "../shared/scenes";
    const std::string filter = argc > 3 ? argv[3] : "";
    std::printf("%-28s %s  %9s %6s  %8s %11s  %10s %10s  %s\n", "", "threads", "rays", "path", "bare/ray", "all/ray",
                "segments", "per CPU s", "ratio");
    measure("cornell-box", folder / "cornell-box/pbrt/scene-v4.pbrt", rounds, filter);
    measure("caustic-glass", folder / "caustic-glass/caustic-glass-v4.pbrt", rounds, filter);
    measure("water-caustic", folder / "water-caustic/pbrt/scene-v4.pbrt", rounds, filter);
    measure("killeroo-simple", folder / "killeroos/killeroo-simple.pbrt", rounds, filter);
}
