// There is no global epsilon: the same scene in millimetres, metres and kilometres gives the same picture, with every
// integrator. A closed room with a matte box, a glass ball and an area light, its lengths multiplied by S; radiance
// does not change. The means of 8 x 8 blocks are compared by Student's t, significance 1e-5 over all blocks.
#include "support/render_scene.h"
#include "support/statistics.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace dapple::testing {
namespace {

std::string room(double s)
{
    const std::string head = fmt::format(
        "LookAt 0 0 {0}  0 0 0  0 1 0\n"
        "Camera \"perspective\" \"float fov\" [60]\n",
        1.9 * s);
    // The scale stands in the transform, so that radii and positions grow with it.
    return head + R"(Film "rgb" "integer xresolution" [32] "integer yresolution" [32]
PixelFilter "box"
WorldBegin
)" + fmt::format("Scale {0} {0} {0}\n", s) +
           R"(AttributeBegin
AreaLightSource "diffuse" "rgb L" [8 8 8]
Material "diffuse" "rgb reflectance" [0 0 0]
Shape "bilinearmesh" "point3 P" [-0.4 0.99 -0.4  0.4 0.99 -0.4  -0.4 0.99 0.4  0.4 0.99 0.4]
AttributeEnd
Material "diffuse" "rgb reflectance" [0.7 0.6 0.5]
Shape "bilinearmesh" "point3 P" [-1 -1 -1  1 -1 -1  -1 -1 2  1 -1 2]
Shape "bilinearmesh" "point3 P" [-1 1 -1  1 1 -1  -1 1 2  1 1 2]
Shape "bilinearmesh" "point3 P" [-1 -1 -1  1 -1 -1  -1 1 -1  1 1 -1]
Material "diffuse" "rgb reflectance" [0.2 0.6 0.2]
Shape "bilinearmesh" "point3 P" [-1 -1 -1  -1 -1 2  -1 1 -1  -1 1 2]
Shape "bilinearmesh" "point3 P" [1 -1 -1  1 -1 2  1 1 -1  1 1 2]
Material "dielectric" "float eta" [1.5]
AttributeBegin
Translate 0.4 -0.6 0.2
Shape "sphere" "float radius" [0.4]
AttributeEnd
Material "conductor" "float roughness" [0.1]
Translate -0.5 -0.7 -0.2
Shape "sphere" "float radius" [0.3]
)";
}

class Scale : public ::testing::TestWithParam<std::string> {};

TEST_P(Scale, DoesNotShowInThePicture)
{
    constexpr int batches = 12, block = 8;
    constexpr double significance = 1e-5 / (2 * 16 * 3);
    std::map<double, std::vector<Image>> images;
    for (double s : {1.0, 1e-3, 1e3}) {
        RenderRequest request;
        request.integrator = GetParam();
        request.passes = 4;
        request.seed = 50 + static_cast<uint64_t>(s * 1000);  // independent
        request.color_model = ColorModel::rgb;
        for (const char* name : {"photons", "causticphotons"})
            if (has_setting(GetParam(), name)) request.settings.emplace_back(name, "10000");
        images[s] = TestScene::from_text(room(s)).render_batches(request, batches);
    }
    for (double s : {1e-3, 1e3})
        for (int c = 0; c < 3; ++c) {
            for (int y = 0; y < 32; y += block)
                for (int x = 0; x < 32; x += block) {
                    const Estimate a = region_estimate(images[1.0], c, x, x + block, y, y + block);
                    const Estimate b = region_estimate(images[s], c, x, x + block, y, y + block);
                    EXPECT_GT(p_value(a, b, 1e-4 * a.mean), significance)
                        << fmt::format("scale {}, block {},{}, channel {}: {} +- {} and {} +- {}", s, x, y, c, a.mean,
                                       a.error, b.mean, b.error);
                }
            const Estimate a = channel_estimate(images[1.0], c);
            EXPECT_LT(a.error / a.mean, 0.02) << "too noisy to tell";
        }
}

// Radii and photon counts that nobody gave follow the scene: the same seed makes the same picture, but for rounding,
// which now and then turns a path away.
TEST_P(Scale, KeepsThePictureOfASeedWithoutSettings)
{
    if (!has_setting(GetParam(), "radius")) GTEST_SKIP() << GetParam() << " has no radius";
    const auto picture = [&](double s) {
        RenderRequest request;
        request.integrator = GetParam();
        request.passes = 1;
        request.color_model = ColorModel::rgb;
        return TestScene::from_text(room(s)).render(request).beauty;
    };
    const Image wanted = picture(1.0);
    double sum = 0;
    for (float v : wanted.pixels) sum += v;
    for (double s : {1e-3, 1e3}) {
        const Image image = picture(s);
        double difference = 0;
        for (size_t i = 0; i < image.pixels.size(); ++i)
            difference += std::abs(double(image.pixels[i]) - wanted.pixels[i]);
        fmt::print("[ measured ] {} at scale {}: {:.2g} of the light differs\n", GetParam(), s, difference / sum);
        EXPECT_LT(difference, 0.01 * sum) << s;
    }
}

INSTANTIATE_TEST_SUITE_P(Integrators, Scale, ::testing::ValuesIn(integrator_names()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace dapple::testing
