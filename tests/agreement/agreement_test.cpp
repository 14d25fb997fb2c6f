// Ring 3. On every scene of scenes/, pairs of integrators of the registry: 12 independent batches of passes each give
// means and standard errors; Welch's t-test compares the means of blocks of 4 x 4 pixels and of the picture, channel by
// channel. Significance 1e-5 per pair and scene (divided by the number of comparisons), so below 1e-3 over the ring.
// The standard error of the picture's mean must be below 0.5 % (most are below 0.2 %), so that a difference of 2 to 3 %
// beyond the stated bias is found.
// An integrator whose code adds nothing new on some scenes runs on those of the table `selections`; with the
// environment variable DAPPLE_FULL_RINGS, every integrator runs on every scene that it can do.
// An integrator that is only consistent may differ by its stated bias (table below), relative to the block's value.
// An algorithm that cannot see light through delta surfaces is judged where no eye path starts with one.
#include "agreement/scenes.h"
#include "support/statistics.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <string_view>

namespace dapple::testing {
namespace {

constexpr int batches = 12;
constexpr int block = 4;
constexpr double significance = 1e-5;
constexpr double largest_error = 0.005;
constexpr double largest_error_of_colors = 0.02;

struct Bias {
    std::string_view integrator;
    double block, picture;  // relative
    std::string_view reason;
    std::string_view scene = {};  // this one alone
};
constexpr Bias biases[] = {
    {"photonmap", 0.06, 0.005, "photons of the time of their eye paths", "motion_blur"},
    {"irradiancecache", 0.06, 0.005, "as photonmap", "motion_blur"},
    {"photonmap", 0.08, 0.015, "blur of a patch that a hundred photons light", "sunlit_room"},
    {"irradiancecache", 0.08, 0.015, "as photonmap", "sunlit_room"},
    {"photonmap", 0.06, 0.03, "20000 photons: blur of caustics and of the global estimate"},
    {"irradiancecache", 0.06, 0.03, "as photonmap, and interpolation of irradiance"},
    {"sppm", 0.08, 0.005, "blur of three pixels at 32: caustics, indirect light that falls off in corners"},
    {"photonsplat", 0.08, 0.005, "as sppm"},
    {"vcm", 0.06, 0.005, "blur where merging outweighs joining: caustics"},
};

// The scenes of integrators that do not run on all.
struct Selection {
    std::string_view integrator, reason;
    std::vector<std::string_view> scenes;
};
const Selection selections[] = {
    {"irradiancecache",
     "photonmap, but for the cache: interpolation over curvature, past sheets, and at all distances",
     {"diffuse_room", "environment", "glass_and_mirror", "glossy", "many_lights", "sheets", "smooth_normals",
      "motion_blur", "spherical", "sunlit_room"}},
    {"sppm",
     "alpha, instances, maps of normals: eye paths are those of path, photons those of photonmap",
     {"bump", "coated", "diffuse_room", "dispersion", "environment", "glass_and_mirror", "glossy", "many_lights",
      "motion_blur", "orthographic", "sheets", "spherical", "spherical_equal_area", "thin_lens"}},
    {"photonsplat",
     "PhotonSplatting.MakesThePictureOfProgressivePhotonMapping compares its pixels on every scene",
     {"coated", "diffuse_room"}},
    {"vcm",
     "bdpt, but for merging: where this meets materials, normals, media, cameras and kinds of light",
     {"bump", "coated", "diffuse_room", "dispersion", "environment", "fog", "glass_and_mirror", "glossy", "grid_cloud",
      "many_lights", "sheets", "smooth_normals", "spherical", "thin_lens"}},
};

bool is_selected(const std::string& integrator, const std::string& scene)
{
    if (std::getenv("DAPPLE_FULL_RINGS")) return true;
    for (const Selection& selection : selections)
        if (selection.integrator == integrator)
            return std::find(selection.scenes.begin(), selection.scenes.end(), scene) != selection.scenes.end();
    return true;
}

// Passes of a batch: half as many where each costs several of path tracing's and has less noise; more where eye paths
// meet the lamp by chance, through glass that parts its wavelengths, and where most light paths never come in.
uint32_t batch_passes(const std::string& integrator, const std::string& scene)
{
    const bool thorough =
        integrator == "bdpt" || integrator == "vcm" || integrator == "photonmap" || integrator == "irradiancecache";
    const bool by_chance = scene == "dispersion" && (integrator == "path" || integrator == "vcm");
    const bool outside = scene == "sunlit_room" && (integrator == "lightpath" || integrator == "bdpt");
    return (thorough ? 8 : 16) * (by_chance ? 3 : outside ? 6 : 1);
}

constexpr std::string_view blind_through_delta[] = {"lightpath"};

Bias bias_of(const std::string& integrator, const std::string& scene)
{
    for (const Bias& bias : biases)
        if (bias.integrator == integrator && (bias.scene.empty() || bias.scene == scene)) return bias;
    return {integrator, 0, 0, ""};
}

bool is_blind_through_delta(const std::string& integrator)
{
    return std::find(std::begin(blind_through_delta), std::end(blind_through_delta), integrator) !=
           std::end(blind_through_delta);
}

struct Judge {
    const std::vector<Image>&a, &b;
    double level;

    void compare(int x0, int x1, int y0, int y1, double bias, const std::string& what) const
    {
        for (int c = 0; c < 3; ++c) {
            const Estimate p = region_estimate(a, c, x0, x1, y0, y1), q = region_estimate(b, c, x0, x1, y0, y1);
            // Single precision, and what a few dark blocks lose in it.
            const double allowance = (bias + 3e-4) * std::max(std::abs(p.mean), std::abs(q.mean));
            EXPECT_GT(p_value(p, q, allowance), level)
                << fmt::format("{}, channel {}: {:.5f} +- {:.5f} and {:.5f} +- {:.5f}, ratio {:.4f}", what, c, p.mean,
                               p.error, q.mean, q.error, q.mean / p.mean);
        }
    }
};

void compare_pair(const TestScene& scene, const std::string& name, const std::vector<Image>& a,
                  const std::vector<Image>& b, const std::string& first, const std::string& second)
{
    const Bias bias_a = bias_of(first, name), bias_b = bias_of(second, name);
    const bool skip_delta = is_blind_through_delta(first) || is_blind_through_delta(second);
    const int width = a.at(0).width, height = a.at(0).height;
    const Judge judge{a, b, significance / (3.0 * (width / block * (height / block) + 1))};
    int compared = 0, skipped = 0;
    for (int y = 0; y < height; y += block)
        for (int x = 0; x < width; x += block) {
            if (skip_delta && scene.sees_delta(x, x + block, y, y + block)) {
                ++skipped;
                continue;
            }
            ++compared;
            judge.compare(x, x + block, y, y + block, std::max(bias_a.block, bias_b.block),
                          fmt::format("{} and {}, block {},{}", first, second, x, y));
        }
    EXPECT_GE(compared, 16) << "too little of the picture can be compared";
    if (skipped == 0)
        judge.compare(0, width, 0, height, std::max(bias_a.picture, bias_b.picture),
                      fmt::format("{} and {}, whole picture", first, second));
    const Estimate p = channel_estimate(a, 1), q = channel_estimate(b, 1);
    fmt::print("[ measured ] {} / {}: mean ratio {:.4f} +- {:.4f}{}\n", second, first, q.mean / p.mean,
               q.mean / p.mean * std::hypot(p.error / p.mean, q.error / q.mean),
               skipped > 0 ? fmt::format(", {} of {} blocks compared", compared, compared + skipped) : "");
}

class Agreement : public ::testing::TestWithParam<std::string> {};

TEST_P(Agreement, OfEveryPairOfIntegrators)
{
    const TestScene scene = agreement_scene(GetParam());
    std::vector<std::pair<std::string, std::vector<Image>>> all;
    uint64_t seed = 100;
    for (const std::string& name : integrator_names()) {
        seed += 1000;
        if (!is_selected(name, GetParam()) || !scene.suits(name)) continue;
        RenderRequest request;
        request.integrator = name;
        request.passes = batch_passes(name, GetParam());
        request.settings = small_settings(name, request.passes);
        request.seed = seed;
        all.emplace_back(name, scene.render_batches(request, batches));
        const Estimate mean = channel_estimate(all.back().second, 1);
        EXPECT_LT(mean.error, largest_error * mean.mean) << name << " is too noisy to tell";
        fmt::print("[ measured ] {}: relative error {:.4f}\n", name, mean.error / mean.mean);
    }
    ASSERT_GE(all.size(), 2u);
    for (size_t i = 0; i < all.size(); ++i)
        for (size_t k = i + 1; k < all.size(); ++k)
            compare_pair(scene, GetParam(), all[i].second, all[k].second, all[i].first, all[k].first);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Agreement, ::testing::ValuesIn(agreement_scenes()),
                         [](const auto& test) { return test.param; });

TEST(AgreementRing, SelectionsNameScenesAndIntegratorsThatExist)
{
    const std::vector<std::string> scenes = agreement_scenes(), integrators = integrator_names();
    for (const Selection& selection : selections) {
        EXPECT_NE(std::find(integrators.begin(), integrators.end(), selection.integrator), integrators.end());
        EXPECT_FALSE(selection.scenes.empty()) << selection.integrator;
        for (std::string_view scene : selection.scenes)
            EXPECT_NE(std::find(scenes.begin(), scenes.end(), scene), scenes.end()) << scene;
    }
}

// Grey surfaces and lights have the same picture in both colour models, and the same as pbrt's RGB values say.
class ColorModels : public ::testing::TestWithParam<std::string> {};

TEST_P(ColorModels, AgreeOnGreyScenes)
{
    const TestScene scene = TestScene::from_text(R"(
LookAt 0 0 3.6  0 0 0  0 1 0
Camera "perspective" "float fov" [38]
Film "rgb" "integer xresolution" [16] "integer yresolution" [16]
WorldBegin
AttributeBegin
AreaLightSource "diffuse" "rgb L" [7 7 7]
Shape "bilinearmesh" "point3 P" [-0.5 0.98 -0.5  0.5 0.98 -0.5  -0.5 0.98 0.5  0.5 0.98 0.5]
AttributeEnd
Material "diffuse" "rgb reflectance" [0.6 0.6 0.6]
Shape "bilinearmesh" "point3 P" [-1 -1 -1  1 -1 -1  -1 -1 1  1 -1 1]
Shape "bilinearmesh" "point3 P" [-1 -1 -1  1 -1 -1  -1 1 -1  1 1 -1]
Material "dielectric" "float eta" [1.5]
Shape "sphere" "float radius" [0.5])");
    std::map<ColorModel, std::vector<Image>> images;
    for (ColorModel model : {ColorModel::rgb, ColorModel::spectral}) {
        RenderRequest request;
        request.integrator = GetParam();
        request.passes = 32;
        request.settings = small_settings(GetParam(), request.passes);
        request.seed = model == ColorModel::rgb ? 1 : 1000;
        request.color_model = model;
        images[model] = scene.render_batches(request, batches);
    }
    for (int c = 0; c < 3; ++c) {
        const Estimate a = channel_estimate(images[ColorModel::rgb], c);
        const Estimate b = channel_estimate(images[ColorModel::spectral], c);
        EXPECT_GT(p_value(a, b, 3e-4 * a.mean), significance) << fmt::format(
            "channel {}: rgb {:.5f} +- {:.5f}, spectral {:.5f} +- {:.5f}", c, a.mean, a.error, b.mean, b.error);
        EXPECT_LT(b.error, largest_error_of_colors * b.mean) << "too noisy to tell";
        fmt::print("[ measured ] {}: relative errors {:.4f}, {:.4f}\n", GetParam(), a.error / a.mean, b.error / b.mean);
    }
}

INSTANTIATE_TEST_SUITE_P(Integrators, ColorModels, ::testing::ValuesIn(integrator_names()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace dapple::testing
