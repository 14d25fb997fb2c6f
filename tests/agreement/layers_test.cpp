// The layers of path classes sum to the beauty, and so do those of the light groups, for every integrator.
#include "agreement/scenes.h"

#include "dapple/base/path_class.h"

#include <gtest/gtest.h>

namespace dapple::testing {
namespace {

int channel_index(const Rendered& rendered, const std::string& name)
{
    for (size_t i = 0; i < rendered.channels.size(); ++i)
        if (rendered.channels[i] == name) return static_cast<int>(i);
    return -1;
}

// Expects that the sum of the layers of these names is the beauty, to the precision of floats; returns how many of them
// hold any light.
int expect_sum(const Rendered& rendered, const std::vector<std::string>& names)
{
    std::vector<double> light(names.size());
    const Image& layers = rendered.layers;
    for (const char* color : {"R", "G", "B"}) {
        const int beauty = channel_index(rendered, color);
        std::vector<int> parts;
        for (const std::string& name : names) parts.push_back(channel_index(rendered, name + "." + color));
        for (size_t i = 0; i < parts.size(); ++i)
            if (parts[i] < 0) {
                ADD_FAILURE() << "no layer " << names[i];
                return 0;
            }
        for (int y = 0; y < layers.height; ++y)
            for (int x = 0; x < layers.width; ++x) {
                double sum = 0, size = 0;
                for (size_t i = 0; i < parts.size(); ++i) {
                    sum += layers.at(x, y, parts[i]);
                    size += std::abs(layers.at(x, y, parts[i]));
                    light[i] += std::abs(layers.at(x, y, parts[i]));
                }
                // A path's terms are summed as floats, and those of one wavelength may be negative: they round by their
                // own size, which is that of a bright pixel and not of this one.
                EXPECT_NEAR(sum, layers.at(x, y, beauty), 1e-6 * size + 2e-8) << "pixel " << x << "," << y;
            }
    }
    return static_cast<int>(std::count_if(light.begin(), light.end(), [](double l) { return l > 0; }));
}

class Layers : public ::testing::TestWithParam<std::string> {};

TEST_P(Layers, SumToTheBeauty)
{
    struct Expected {
        const char* scene;
        int classes;  // that hold light
        std::vector<std::string> groups;
    };
    const Expected all[] = {
        {"glass_and_mirror", 4, {"lightgroup_default", "lightgroup_lamp"}},
        {"many_lights", 3, {"lightgroup_default", "lightgroup_row0", "lightgroup_row1", "lightgroup_spot"}},
        {"fog", 3, {"lightgroup_default", "lightgroup_lamp"}}};
    std::vector<std::string> classes;
    for (std::string_view name : path_class_names) classes.emplace_back(name);
    for (const Expected& expected : all) {
        SCOPED_TRACE(expected.scene);
        const TestScene scene = agreement_scene(expected.scene);
        if (!scene.suits(GetParam())) continue;
        RenderRequest request;
        request.integrator = GetParam();
        request.passes = 4;
        request.settings = small_settings(GetParam(), request.passes);
        request.layers = true;
        const Rendered rendered = scene.render(request);
        EXPECT_GE(expect_sum(rendered, classes), expected.classes);
        // All lights of two of the scenes are in the group "lamp".
        EXPECT_GE(expect_sum(rendered, expected.groups), static_cast<int>(expected.groups.size()) - 1);
    }
}

INSTANTIATE_TEST_SUITE_P(Integrators, Layers, ::testing::ValuesIn(integrator_names()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace dapple::testing
