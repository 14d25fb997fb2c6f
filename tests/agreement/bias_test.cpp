// Photon mapping is consistent: its difference from the path tracer falls as photons and radius improve. The caustic of
// a glass ball under a large lamp, whose blur is seen in blocks of 4 x 4 pixels.
#include "agreement/scenes.h"
#include "support/statistics.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

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

std::vector<Image> path_traced(const TestScene& scene)
{
    RenderRequest path;
    path.integrator = "path";
    path.color_model = ColorModel::rgb;
    path.passes = 64;
    return scene.render_batches(path, 8);
}

TEST(PhotonMapping, BiasFallsWithRadiusAndPhotons)
{
    const TestScene scene = agreement_scene("glass_and_mirror");
    const std::vector<Image> reference = path_traced(scene);
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
    const double fine = bias("40000", "0.07", "100");
    fmt::print("[ measured ] squared bias of blocks: coarse {:.3g}, fine {:.3g}\n", coarse, fine);
    EXPECT_GT(coarse, 0);
    EXPECT_LT(fine, coarse / 4);
}

// Estimates of the k nearest photons get narrower from epoch to epoch: after 64 the mean square of their radii is 0.37
// of the first, and so the blur that passes average.
TEST(PhotonMapping, EpochsTakeTheBlurOfDirectVisualisation)
{
    const TestScene scene = agreement_scene("glass_and_mirror");
    const std::vector<Image> reference = path_traced(scene);
    const auto bias = [&](uint32_t passes) {
        RenderRequest request;
        request.integrator = "photonmap";
        request.color_model = ColorModel::rgb;
        request.passes = passes;
        request.seed = 500;
        request.settings = {{"photons", "10000"},
                            {"causticphotons", "0"},
                            {"nearest", "200"},
                            {"epoch", "1"},
                            {"finalgather", "false"}};
        return squared_bias(reference, scene.render_batches(request, 8));
    };
    const double first = bias(1), many = bias(64);
    fmt::print("[ measured ] squared bias of blocks: first epoch {:.3g}, 64 epochs {:.3g}\n", first, many);
    EXPECT_GT(first, 0);
    EXPECT_LT(many, first / 3);
}

// The mean of the picture is that of the same gathering without a cache, within 1 %. Two sets of maps in each batch:
// their noise is what is left to see.
TEST(IrradianceCaching, HasTheMeanOfGatheringWithoutACache)
{
    for (const char* name : {"diffuse_room", "smooth_normals"}) {
        const TestScene scene = agreement_scene(name);
        const auto render = [&](const char* integrator, const char* rays) {
            RenderRequest request;
            request.integrator = integrator;
            request.color_model = ColorModel::rgb;
            request.passes = 16;
            request.seed = 50;
            request.settings = {{"photons", "30000"}, {"causticphotons", "0"}, {"epoch", "8"}, {"gatherrays", rays}};
            return scene.render_batches(request, 8);
        };
        const std::vector<Image> plain = render("photonmap", "8"), cached = render("irradiancecache", "2");
        for (int c = 0; c < 3; ++c) {
            const Estimate p = channel_estimate(plain, c), q = channel_estimate(cached, c);
            const double error = std::hypot(p.error, q.error) / p.mean;
            fmt::print("[ measured ] {}, channel {}: cached / uncached {:.4f} +- {:.4f}\n", name, c, q.mean / p.mean,
                       error);
            EXPECT_LT(error, 0.0025) << "too noisy to tell";
            EXPECT_NEAR(q.mean / p.mean, 1.0, 0.01);
        }
        // One block in the middle, where interpolation has most to say.
        const Estimate p = region_estimate(plain, 1, 12, 16, 16, 20), q = region_estimate(cached, 1, 12, 16, 16, 20);
        EXPECT_NEAR(q.mean / p.mean, 1.0, 0.03);
    }
}

}  // namespace
}  // namespace dapple::testing
