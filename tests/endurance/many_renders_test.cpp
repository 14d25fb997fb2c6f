// Thousands of renders in one process: neither memory nor open files grow (mitsuba3#190, BlendLuxCore#3), and neither
// do they within one render of thousands of passes (pbrt-v3#264). DAPPLE_MANY_RENDERS and DAPPLE_MANY_PASSES ask for
// more than the short forms; the issue's numbers are 5000 and 10000.
#include "dapple/base/log.h"
#include "dapple/formats/pbrt.h"
#include "dapple/render/film_settings.h"
#include "dapple/render/render_job.h"
#include "dapple/render/scene_defaults.h"
#include "dapple/world/compile.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace dapple {
namespace {

constexpr const char* scene_text = R"(
LookAt 0 2 6  0 0.6 0  0 1 0
Camera "perspective" "float fov" [35]
Film "rgb" "integer xresolution" [8] "integer yresolution" [6]
WorldBegin
LightSource "point" "point3 from" [1 4 1] "rgb I" [20 20 20]
Texture "squares" "spectrum" "checkerboard"
Material "diffuse" "texture reflectance" "squares"
Shape "trianglemesh" "point3 P" [-9 0 -9  9 0 -9  9 0 9  -9 0 9] "integer indices" [0 1 2 0 2 3]
Material "dielectric"
Translate 0 0.7 0
Shape "sphere" "float radius" [0.7]
)";

long count_from(const char* variable, long fallback)
{
    const char* text = std::getenv(variable);
    return text ? std::max(std::atol(text), 50L) : fallback;
}

size_t resident_bytes()
{
    std::ifstream in("/proc/self/statm");
    size_t pages = 0, resident = 0;
    in >> pages >> resident;
    return resident * static_cast<size_t>(sysconf(_SC_PAGESIZE));
}

std::ptrdiff_t open_files() { return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {}); }
std::ptrdiff_t threads() { return std::distance(std::filesystem::directory_iterator("/proc/self/task"), {}); }

// Everything that `dapple render` does for an image.
void render_once(const std::string& integrator, uint32_t passes, PassObserver* observer = nullptr)
{
    const scene::Description description = read_pbrt_string(scene_text, "many.pbrt", ".");
    std::vector<std::pair<std::string, std::string>> settings;
    if (integrator == "photonmap") settings = {{"photons", "400"}, {"causticphotons", "200"}, {"epoch", "2"}};
    const IntegratorChoice choice = choose_integrator({}, integrator, settings);
    const auto world = compile(description);
    LayerChoice layers;
    layers.error = true;
    FilmSettings film_of_scene =
        film_settings(description, *world, layers, choice.entry->photon_layers, ColorModel::spectral);
    const auto made = choice.entry->create(*world, choice.settings);
    describe_passes(film_of_scene, *made);
    Film film(film_of_scene);
    StopRequests requests;
    const auto progress = make_progress(ProgressKind::none);
    StopRule stop;
    stop.passes = passes;
    RenderJob job{*world, *made, film, integrator, 1, stop};
    if (observer) job.observers.push_back(observer);
    const RenderResult result = run(job, requests, *progress);
    EXPECT_EQ(result.passes, passes);
}

class ManyRenders : public testing::TestWithParam<const char*> {};

TEST_P(ManyRenders, NeitherMemoryNorHandlesGrow)
{
    const long count = count_from("DAPPLE_MANY_RENDERS", 200);
    // The first half warms caches of the allocator and of libraries.
    for (long i = 0; i < count / 2; ++i) render_once(GetParam(), 1);
    const size_t bytes = resident_bytes();
    const auto files = open_files(), tasks = threads();
    for (long i = 0; i < count / 2; ++i) render_once(GetParam(), 1);
    const double growth = static_cast<double>(resident_bytes()) - static_cast<double>(bytes);
    RecordProperty("bytes_per_render", std::to_string(growth / static_cast<double>(count / 2)));
    // A film or a world forgotten once per render would be tens of kilobytes each time.
    EXPECT_LT(growth, 1e6 + 500.0 * static_cast<double>(count));
    EXPECT_EQ(open_files(), files);
    EXPECT_LE(threads(), tasks + 1);
}

TEST_P(ManyRenders, PassesAreFreeOfMemory)
{
    struct Watch final : PassObserver {
        std::vector<size_t> bytes;
        void after_pass(const Film&, const RenderCounters&) override { bytes.push_back(resident_bytes()); }
    } watch;
    const auto passes = static_cast<uint32_t>(count_from("DAPPLE_MANY_PASSES", 600));
    render_once(GetParam(), passes, &watch);
    ASSERT_EQ(watch.bytes.size(), passes);
    const double growth =
        static_cast<double>(watch.bytes.back()) - static_cast<double>(watch.bytes[watch.bytes.size() / 3]);
    RecordProperty("bytes_per_pass", std::to_string(growth / passes));
    // The maps of an epoch are some 50 KB here.
    EXPECT_LT(growth, 1e6 + 100.0 * passes);
}

INSTANTIATE_TEST_SUITE_P(Of, ManyRenders, testing::Values("path", "photonmap"));

}  // namespace
}  // namespace dapple
