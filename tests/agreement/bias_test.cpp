// Photon mapping is consistent: its difference from the path tracer falls as photons and radius improve. The caustic of
// a glass ball under a large lamp, whose blur is seen in blocks of 4 x 4 pixels.
#include "agreement/scenes.h"
#include "support/statistics.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace dapple::testing {
namespace {

// The mean square of the difference of block means, less what the noise of both adds to it.
double squared_bias(const std::vector<Image>& a, const std::vector<Image>& b)
{
    constexpr int block = 4;
    double sum = 0;
    int blocks = 0;
    for (int y = 0; y < a[0].height; y += block)
        for (int x = 0; x < a[0].width; x += block, ++blocks) {
            const Estimate p = region_estimate(a, 1, x, x + block, y, y + block);
            const Estimate q = region_estimate(b, 1, x, x + block, y, y + block);
            sum += (p.mean - q.mean) * (p.mean - q.mean) - p.error * p.error - q.error * q.error;
        }
    return sum / blocks;
}

TEST(PhotonMapping, BiasFallsWithRadiusAndPhotons)
{
    const TestScene scene = agreement_scene("glass_and_mirror");
    RenderRequest path;
    path.integrator = "path";
    path.color_model = ColorModel::rgb;
    path.passes = 128;
    const std::vector<Image> reference = scene.render_batches(path, 8);
    const auto bias = [&](const char* photons, const char* radius, const char* nearest) {
        RenderRequest request;
        request.integrator = "photonmap";
        request.color_model = ColorModel::rgb;
        request.passes = 8;
        request.seed = 500;
        request.settings = {{"photons", photons},    {"causticphotons", photons},
                            {"fixedradius", radius}, {"nearest", nearest},
                            {"epoch", "8"},          {"finalgather", "false"}};
        return squared_bias(reference, scene.render_batches(request, 8));
    };
    const double coarse = bias("5000", "0.3", "400");
    const double fine = bias("80000", "0.05", "100");
    fmt::print("[ measured ] squared bias of blocks: coarse {:.3g}, fine {:.3g}\n", coarse, fine);
    EXPECT_GT(coarse, 0);
    EXPECT_LT(fine, coarse / 4);
}

}  // namespace
}  // namespace dapple::testing
