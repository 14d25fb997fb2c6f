// Light that comes by way of narrow lobes is shared out between photons and gather rays (transport/caustic_share.h):
// ways of light by themselves. That all shares sum to one: CausticRun in test_integrators.
#include "agreement/scenes.h"
#include "support/statistics.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <ostream>

namespace dapple::testing {
namespace {

constexpr int batches = 8;

constexpr std::string_view matte = R"(Material "diffuse" "rgb reflectance" [0.7 0.7 0.7])";
constexpr std::string_view metal =
    R"(Material "conductor" "rgb reflectance" [0.8 0.8 0.8] "bool remaproughness" [false] "float roughness" [0.2])";
// A coat alone: what enters is absorbed.
constexpr std::string_view coat =
    R"(Material "coateddiffuse" "rgb reflectance" [0 0 0] "bool remaproughness" [false] "float roughness" [0.2])";
constexpr std::string_view coated =
    R"(Material "coateddiffuse" "rgb reflectance" [0.5 0.5 0.5] "bool remaproughness" [false] "float roughness" [0.15])";
constexpr std::string_view pane = R"(Material "thindielectric" "float eta" [1.5])";

// A lamp lights a floor, steeply, so that the two directions of scattering differ; the floor lights a wall, which the
// camera sees alone. A screen keeps the lamp from the wall.
struct Way {
    const char* name;
    std::string_view floor, wall;
    bool spot = false;          // instead of the lamp
    bool through_pane = false;  // a pane above the floor
    const char* integrator = "photonmap";
};

const Way ways[] = {
    {"MetalMatte", metal, matte, true},
    {"MetalCoated", metal, coated, true},
    {"PaneCoatMatte", coat, matte, true, true},
    {"LampMetalMatte", metal, matte},
    {"MetalMatteCached", metal, matte, true, false, "irradiancecache"},
};

std::ostream& operator<<(std::ostream& out, const Way& way) { return out << way.name; }

std::string rectangle(std::string_view material, const char* points)
{
    return fmt::format("{}\nShape \"bilinearmesh\" \"point3 P\" [{}]\n", material, points);
}

TestScene scene_of(const Way& way)
{
    constexpr std::string_view black = R"(Material "diffuse" "rgb reflectance" [0 0 0])";
    std::string text = R"(LookAt 1.05 1 0  2 1 0  0 1 0
Camera "perspective" "float fov" [50]
Film "rgb" "integer xresolution" [12] "integer yresolution" [12]
PixelFilter "box"
WorldBegin
)";
    text += "AttributeBegin\nTranslate 0.4 1 0\nRotate -60 0 0 1\n";
    text += way.spot ? R"(LightSource "spot" "rgb I" [10 10 10] "point3 from" [0 0 0] "point3 to" [1 0 0]
    "float coneangle" [20] "float conedeltaangle" [10]
)"
                     : R"(AreaLightSource "diffuse" "rgb L" [40 40 40]
Rotate 90 0 1 0
Shape "disk" "float radius" [0.2]
)";
    text += "AttributeEnd\n";
    text += rectangle(black, "1 0.5 -2  1 3 -2  1 0.5 2  1 3 2");
    if (way.through_pane) text += rectangle(pane, "0 0.3 -1  2 0.3 -1  0 0.3 1  2 0.3 1");
    text += rectangle(way.floor, "0 0 -1  2 0 -1  0 0 1  2 0 1");
    text += rectangle(way.wall, "2 0 -1  2 2 -1  2 0 1  2 2 1");
    return TestScene::from_text(text);
}

class NarrowLobes : public ::testing::TestWithParam<Way> {};

TEST_P(NarrowLobes, AreSharedOutWholly)
{
    const TestScene scene = scene_of(GetParam());
    RenderRequest request;
    request.color_model = ColorModel::rgb;
    request.integrator = "lightpath";
    request.settings = {{"particles", "20000"}};
    request.passes = 64;
    const Estimate expected = channel_estimate(scene.render_batches(request, batches), 1);
    ASSERT_GT(expected.mean, 0.0);
    request.integrator = GetParam().integrator;
    request.seed = 100;
    request.settings = {{"photons", "10000"}, {"radius", "0.5"}};  // of pixels as large as these
    const Estimate found = channel_estimate(scene.render_batches(request, batches), 1);
    const double error = std::hypot(found.error / found.mean, expected.error / expected.mean);
    fmt::print("[ measured ] {:.4f} +- {:.4f} of lightpath (+- {:.4f})\n", found.mean / expected.mean, error,
               expected.error / expected.mean);
    EXPECT_NEAR(found.mean / expected.mean, 1.0, 3.0 * error + 0.01);
    EXPECT_LT(error, 0.015) << "too noisy to tell";
}

INSTANTIATE_TEST_SUITE_P(Ways, NarrowLobes, ::testing::ValuesIn(ways),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace dapple::testing
