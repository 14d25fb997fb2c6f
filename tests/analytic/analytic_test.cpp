// Ring 2. Each file of scenes/ derives a number in the comment at its head and states how it is judged:
//   # expect V            every channel of the mean of the picture is V
//   # error E             largest relative standard error a run may have (so that noise cannot hide a difference),
//   three
//                         times as much in the spectral colour model; 0: the picture must be exactly V in every pixel
//   # passes N            passes of each of the 16 independent batches (default 64)
//   # colors both         run in the spectral colour model too (default: rgb alone)
//   # set NAME K=V ...    settings of an integrator
//   # allow NAME R        relative bias that a consistent integrator may have
// Every integrator of the registry runs on every scene; the exceptions stand in one table below. The mean of 16
// batches is held to V by Student's t. Significance: 1e-4 over the whole ring, divided by the number of comparisons
// (Bonferroni), so that a false alarm is one in ten thousand changes of the seeds. Beyond the statistics, 2e-4 of V is
// allowed for single precision and for the tables of colours.
#include "support/render_scene.h"
#include "support/statistics.h"

#include "dapple/integrators/integrator.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <string_view>

namespace dapple::testing {
namespace {

constexpr int batches = 16;
constexpr double ring_significance = 1e-4;
constexpr double comparisons = 2000;  // at least the number of p-values in this ring
constexpr double single_precision = 2e-4;

struct Exception {
    std::string_view integrator, scene, reason;
};
constexpr Exception exceptions[] = {
    {"lightpath", "emitting_slab", "light tracing starts particles on lights only, not in emitting media"},
    {"photonmap", "emitting_slab", "photons start on lights only, not in emitting media"},
    {"sppm", "emitting_slab", "photons start on lights only, not in emitting media"},
    {"photonsplat", "emitting_slab", "photons start on lights only, not in emitting media"},
    {"irradiancecache", "emitting_slab", "photons start on lights only, not in emitting media"},
    {"lightpath", "slab_total", "one particle in 1e5 meets the picture's 1 mm2 of the 100 mm wide slab"},
    {"lightpath", "slab_reflectance", "as slab_total"},
};

struct Expectation {
    double value = NAN;
    double error = NAN;
    uint32_t passes = 64;
    bool spectral = false;
    std::map<std::string, SettingList> settings;
    std::map<std::string, double> allowance;
};

Expectation read_expectation(const std::filesystem::path& file)
{
    Expectation expectation;
    std::istringstream text(read_text(file));
    for (std::string line; std::getline(text, line) && line.starts_with("#");) {
        std::istringstream words(line.substr(1));
        std::string key, name;
        words >> key;
        if (key == "expect") words >> expectation.value;
        if (key == "error") words >> expectation.error;
        if (key == "passes") words >> expectation.passes;
        if (key == "colors") expectation.spectral = true;
        if (key == "allow") words >> name >> expectation.allowance[name];
        if (key == "set") {
            words >> name;
            for (std::string setting; words >> setting;) {
                const size_t equals = setting.find('=');
                expectation.settings[name].emplace_back(setting.substr(0, equals), setting.substr(equals + 1));
            }
        }
    }
    return expectation;
}

std::vector<std::string> scene_names()
{
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(DAPPLE_ANALYTIC_SCENES))
        if (entry.path().extension() == ".pbrt") names.push_back(entry.path().stem());
    std::sort(names.begin(), names.end());
    return names;
}

using Case = std::tuple<std::string, std::string>;  // scene, integrator

std::string case_name(const ::testing::TestParamInfo<Case>& info)
{
    return std::get<0>(info.param) + "_" + std::get<1>(info.param);
}

class Analytic : public ::testing::TestWithParam<Case> {};

void expect_exact(const TestScene& scene, RenderRequest request, double value)
{
    request.passes *= batches;
    const Rendered rendered = scene.render(request);
    for (float v : rendered.beauty.pixels) ASSERT_EQ(v, static_cast<float>(value));
}

void expect_mean(const TestScene& scene, const RenderRequest& request, const Expectation& expected, double allowance)
{
    const std::vector<Image> images = scene.render_batches(request, batches);
    for (int channel = 0; channel < 3; ++channel) {
        const Estimate e = channel_estimate(images, channel);
        const double p = p_value(e, expected.value, (single_precision + allowance) * std::abs(expected.value));
        const std::string text = fmt::format("channel {}: {:.6f} +- {:.6f}, expected {:.6f} (ratio {:.5f}), p = {:.2g}",
                                             channel, e.mean, e.error, expected.value, e.mean / expected.value, p);
        if (channel == 1) ::testing::Test::RecordProperty("measured", text);
        EXPECT_GT(p, ring_significance / comparisons) << text;
        const double limit = expected.error * (request.color_model == ColorModel::rgb ? 1 : 3);
        EXPECT_LE(e.error, limit * std::abs(expected.value)) << "too noisy to tell: " << text;
        if (channel == 1)
            fmt::print("[ measured ] {} {}\n", request.color_model == ColorModel::rgb ? "rgb" : "spectral", text);
    }
}

// Settings for pictures of 64 pixels: defaults are made for larger ones. One set of maps per batch, or photons for each
// pass.
SettingList small_picture_settings(const std::string& integrator, uint32_t passes)
{
    const SettingList wanted = {{"particles", "500"},
                                {"photons", has_setting(integrator, "epoch") ? "10000" : "500"},
                                {"causticphotons", "10000"},
                                {"epoch", std::to_string(passes)}};
    SettingList known;
    for (const auto& setting : wanted)
        if (has_setting(integrator, setting.first)) known.push_back(setting);
    return known;
}

TEST_P(Analytic, HasTheNumberOfItsScene)
{
    const auto& [name, integrator] = GetParam();
    for (const Exception& exception : exceptions)
        if (exception.scene == name && exception.integrator == integrator) GTEST_SKIP() << exception.reason;
    const std::filesystem::path file = std::filesystem::path(DAPPLE_ANALYTIC_SCENES) / (name + ".pbrt");
    const Expectation expected = read_expectation(file);
    ASSERT_TRUE(std::isfinite(expected.value) && std::isfinite(expected.error)) << "the scene states no number";
    const TestScene scene = TestScene::from_file(file);
    if (!scene.suits(integrator)) GTEST_SKIP() << integrator << " does not handle scattering media";

    RenderRequest request;
    request.integrator = integrator;
    request.passes = expected.passes;
    request.seed = 1000;
    request.settings = small_picture_settings(integrator, request.passes);
    if (expected.settings.contains(integrator))
        for (const auto& setting : expected.settings.at(integrator)) request.settings.push_back(setting);
    const double allowance = expected.allowance.contains(integrator) ? expected.allowance.at(integrator) : 0;
    for (ColorModel model : {ColorModel::rgb, ColorModel::spectral}) {
        if (model == ColorModel::spectral && !expected.spectral) continue;
        request.color_model = model;
        if (expected.error == 0)
            expect_exact(scene, request, expected.value);
        else
            expect_mean(scene, request, expected, allowance);
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Analytic,
                         ::testing::Combine(::testing::ValuesIn(scene_names()),
                                            ::testing::ValuesIn(integrator_names())),
                         case_name);

TEST(AnalyticRing, StaysWithinItsSignificance)
{
    // Three channels, two colour models: the divisor of the significance is large enough.
    EXPECT_LE(scene_names().size() * integrator_names().size() * 6.0, comparisons);
}

TEST(AnalyticRing, ExceptionsNameScenesAndIntegratorsThatExist)
{
    const std::vector<std::string> scenes = scene_names(), integrators = integrator_names();
    for (const Exception& exception : exceptions) {
        EXPECT_TRUE(std::find(scenes.begin(), scenes.end(), exception.scene) != scenes.end()) << exception.scene;
        EXPECT_TRUE(std::find(integrators.begin(), integrators.end(), exception.integrator) != integrators.end())
            << exception.integrator;
    }
}

// Direct visualisation of the maps is another estimator than final gathering: it must be dark behind a wall, too.
TEST(AnalyticRing, MapsShownDirectlyDoNotLeakThroughAThinWall)
{
    if (!has_setting("photonmap", "finalgather")) GTEST_SKIP() << "photonmap has no finalgather";
    const TestScene scene = TestScene::from_file(std::filesystem::path(DAPPLE_ANALYTIC_SCENES) / "thin_wall.pbrt");
    RenderRequest request;
    request.integrator = "photonmap";
    request.passes = 1;
    for (const char* nearest : {"50", "0"}) {
        request.settings = {
            {"finalgather", "false"}, {"photons", "100000"}, {"nearest", nearest}, {"fixedradius", "0.2"}};
        expect_exact(scene, request, 0);
    }
}

}  // namespace
}  // namespace dapple::testing
