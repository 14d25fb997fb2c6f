// Estimates within a radius do not darken where part of it is empty: along the edges of a floor, and at the foot of a
// thin wall, where light of the other side does not seep through either. Default radii, three pixels wide.
#include "agreement/scenes.h"
#include "support/statistics.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

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
    request.passes = 12;
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

// The edge of the shadow, 0.3 from the left border, is sharp: it lies in column 9, of which 0.6 are lit. A lowered
// radius blurs it less. Even light stays as it is. The light near the edge need not: dark places, which have few
// photons, all of them on one side, are found uneven sooner than bright ones, so what spills over is taken away before
// what it lacks is given back.
TEST(RadiusTest, SharpensShadowsAndKeepsTheirLight)
{
    const TestScene scene = TestScene::from_text(floor_and_wall);
    constexpr double lit = 0.8 / 3.14159265358979 * 4.0 * 0.894427190999916;  // reflectance, irradiance, cosine
    struct Result {
        double error = 0;  // mean square near the edge
        Estimate near, even;
    };
    for (const ColorModel model : {ColorModel::rgb, ColorModel::spectral}) {
        std::map<std::string, Result> results;
        for (const char* tested : {"false", "true"}) {
            RenderRequest request;
            request.integrator = "sppm";
            request.settings = {{"radiustest", tested}};
            request.color_model = model;
            request.passes = 5;
            const std::vector<Image> images = scene.render_batches(request, batches);
            Result& result = results[tested];
            int pixels = 0;
            for (const Image& image : images)
                for (int y = 4; y < 28; ++y)
                    for (int x = 5; x < 14; ++x, ++pixels) {
                        const double expected = lit * (x < 9 ? 1.0 : x > 9 ? 0.0 : 0.6);
                        result.error += std::pow(image.at(x, y, 1) - expected, 2);
                    }
            result.error /= pixels;
            result.near = region_estimate(images, 1, 3, 15, 4, 28);
            result.even = region_estimate(images, 1, 20, 28, 4, 28);
        }
        const Result &plain = results["false"], &tested = results["true"];
        fmt::print(
            "[ measured ] {}: mean squared error near the edge {:.3g}, with the test {:.3g} ({:.2f}); light near it "
            "{:.4f} +- {:.4f} and {:.4f} +- {:.4f}, in even light {:.4f} +- {:.4f} and {:.4f} +- {:.4f}\n",
            model == ColorModel::rgb ? "rgb" : "spectral", plain.error, tested.error, tested.error / plain.error,
            plain.near.mean, plain.near.error, tested.near.mean, tested.near.error, plain.even.mean, plain.even.error,
            tested.even.mean, tested.even.error);
        EXPECT_LT(tested.error, 0.7 * plain.error);
        EXPECT_GT(p_value(plain.near, tested.near, 0.03 * plain.near.mean), 1e-3);
        EXPECT_GT(p_value(plain.even, tested.even), 1e-3);
        EXPECT_GT(p_value(tested.even, lit, 1e-3 * lit), 1e-3);
    }
}

INSTANTIATE_TEST_SUITE_P(Integrators, Edges, ::testing::Values("sppm", "photonsplat", "vcm"),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace dapple::testing
