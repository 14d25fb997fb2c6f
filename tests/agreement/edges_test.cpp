// Estimates within a radius do not darken where part of it is empty: along the edges of a floor, and at the foot of a
// thin wall, where light of the other side does not seep through either. Default radii, three pixels wide.
#include "agreement/scenes.h"
#include "support/statistics.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

namespace dapple::testing {
namespace {

constexpr int batches = 8;

// A square of floor seen from above, evenly lit from the upper right through a pane that bends nothing, so that photons
// bring the light. A wall stands on it and throws a shadow to its left.
constexpr const char* floor_and_wall = R"(LookAt 0 0.5 0  0 0 0  0 0 1
Camera "orthographic" "float screenwindow" [-0.5 0.5 -0.5 0.5]
Film "rgb" "integer xresolution" [32] "integer yresolution" [32]
PixelFilter "box"
WorldBegin
LightSource "distant" "point3 from" [1 2 0] "point3 to" [0 0 0] "rgb L" [4 4 4]
Material "diffuse" "rgb reflectance" [0.8 0.8 0.8]
Shape "bilinearmesh" "point3 P" [-0.5 0 -0.5  0.5 0 -0.5  -0.5 0 0.5  0.5 0 0.5]
Material "diffuse" "rgb reflectance" [0 0 0]
Shape "bilinearmesh" "point3 P" [0 0 -0.7  0 0 0.7  0 0.4 -0.7  0 0.4 0.7]
Material "thindielectric" "float eta" [1]
Shape "bilinearmesh" "point3 P" [-0.7 0.6 -0.7  1 0.6 -0.7  -0.7 0.6 0.7  1 0.6 0.7]
)";

class Edges : public ::testing::TestWithParam<std::string> {};

TEST_P(Edges, AreAsBrightAsTheMiddleOfAnEvenlyLitFloor)
{
    const TestScene scene = TestScene::from_text(floor_and_wall);
    RenderRequest request;
    request.integrator = GetParam();
    request.color_model = ColorModel::rgb;
    request.seed = 7;
    request.passes = 10;
    if (GetParam() == "vcm") request.settings = {{"lightpaths", "20000"}, {"techniques", "bpm"}};
    const std::vector<Image> images = scene.render_batches(request, batches);
    // The camera sees x grow to the left or to the right; the shadow tells.
    const auto mean = [&](int x0, int x1, int y0, int y1) { return region_estimate(images, 1, x0, x1, y0, y1); };
    ASSERT_LT(mean(12, 15, 4, 28).mean, 0.05 * mean(20, 28, 4, 28).mean);
    const Estimate middle = mean(20, 28, 4, 28);
    const auto compare = [&](const char* name, const Estimate& band, double expected) {
        const double error = std::hypot(middle.error * expected, band.error) / middle.mean;
        fmt::print("[ measured ] {}, {}: {:.4f} +- {:.4f} of the middle\n", GetParam(), name, band.mean / middle.mean,
                   error);
        EXPECT_LT(std::abs(band.mean / middle.mean - expected), 4.0 * error + 0.01) << name;
        EXPECT_LT(error, 0.03) << name << " is too noisy to tell";
    };
    compare("edge", mean(31, 32, 2, 30), 1.0);
    compare("other edges", mean(18, 30, 0, 1), 1.0);
    compare("corner", mean(30, 32, 0, 2), 1.0);
    compare("lit foot of the wall", mean(16, 17, 2, 30), 1.0);
    compare("dark foot of the wall", mean(15, 16, 2, 30), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Integrators, Edges, ::testing::Values("sppm", "photonsplat", "vcm"),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace dapple::testing
