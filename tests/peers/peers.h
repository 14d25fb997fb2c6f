// What the tests of this ring share. Means of 16 independent batches are compared by Student's t; significance 1e-7 for
// each of at most ten thousand comparisons, so 1e-3 over the ring. Each test also states how small the standard errors
// must be, so that noise cannot hide a difference.
#pragma once

#include "support/render_scene.h"
#include "support/statistics.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

namespace dapple::testing {

inline constexpr int peer_batches = 16;
inline constexpr double peer_significance = 1e-7;

// The six walls of the box from -1 to 1, normals inwards.
inline constexpr const char* box_walls = R"(Shape "bilinearmesh" "point3 P" [-1 -1 -1  -1 1 -1  1 -1 -1  1 1 -1]
Shape "bilinearmesh" "point3 P" [-1 -1 1  1 -1 1  -1 1 1  1 1 1]
Shape "bilinearmesh" "point3 P" [-1 -1 -1  1 -1 -1  -1 -1 1  1 -1 1]
Shape "bilinearmesh" "point3 P" [-1 1 -1  -1 1 1  1 1 -1  1 1 1]
Shape "bilinearmesh" "point3 P" [-1 -1 -1  -1 -1 1  -1 1 -1  -1 1 1]
Shape "bilinearmesh" "point3 P" [1 -1 -1  1 1 -1  1 -1 1  1 1 1]
)";

// Settings for pictures of about a hundred pixels; one set of photon maps for each batch.
inline SettingList peer_settings(const std::string& integrator, uint32_t passes, int light_paths = 1000)
{
    const std::string per_pass = std::to_string(light_paths);
    const std::string per_batch = std::to_string(light_paths * static_cast<int>(passes));
    const SettingList wanted = {{"particles", per_pass},
                                {"lightpaths", per_pass},
                                {"photons", has_setting(integrator, "epoch") ? per_batch : per_pass},
                                {"causticphotons", per_batch},
                                {"epoch", std::to_string(passes)}};
    SettingList known;
    for (const auto& setting : wanted)
        if (has_setting(integrator, setting.first)) known.push_back(setting);
    return known;
}

inline RenderRequest peer_request(const std::string& integrator, uint32_t passes, int light_paths = 1000)
{
    RenderRequest request;
    request.integrator = integrator;
    request.passes = passes;
    request.settings = peer_settings(integrator, passes, light_paths);
    request.color_model = ColorModel::rgb;
    // Independent of what other integrators draw.
    request.seed = 1000 * (1 + std::hash<std::string>{}(integrator) % 1000);
    return request;
}

// The mean of the green channel of the picture.
inline Estimate peer_mean(const TestScene& scene, const RenderRequest& request)
{
    return channel_estimate(scene.render_batches(request, peer_batches), 1);
}

// Expects that both are the same up to `bias` (relative), and that their errors are below `largest_error` (relative).
inline void expect_same(const Estimate& a, const Estimate& b, double bias, double largest_error,
                        const std::string& what)
{
    const double size = std::max(std::abs(a.mean), std::abs(b.mean));
    const std::string text = fmt::format("{}: {:.5f} +- {:.5f} and {:.5f} +- {:.5f}, ratio {:.4f}", what, a.mean,
                                         a.error, b.mean, b.error, b.mean / a.mean);
    EXPECT_GT(p_value(a, b, (bias + 3e-4) * size), peer_significance) << text;
    EXPECT_LT(std::max(a.error, b.error), largest_error * size) << "too noisy to tell: " << text;
}

inline void expect_value(const Estimate& a, double expected, double bias, double largest_error, const std::string& what)
{
    const std::string text = fmt::format("{}: {:.5f} +- {:.5f}, expected {:.5f}, ratio {:.4f}", what, a.mean, a.error,
                                         expected, a.mean / expected);
    EXPECT_GT(p_value(a, expected, (bias + 3e-4) * std::abs(expected)), peer_significance) << text;
    EXPECT_LE(a.error, largest_error * std::abs(expected)) << "too noisy to tell: " << text;
}

// A test for each integrator of the registry.
class PeerTest : public ::testing::TestWithParam<std::string> {};

}  // namespace dapple::testing
