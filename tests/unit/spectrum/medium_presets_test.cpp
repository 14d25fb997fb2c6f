// Scattering parameters by name.
#include "dapple/spectrum/medium_presets.h"

#include <gtest/gtest.h>

#include <string>

namespace dapple {
namespace {

TEST(MediumPresets, AreFoundOrTheNearestIsNamed)
{
    EXPECT_EQ(find_medium_preset("Wholemilk").sigma_s, Vec3(2.55f, 3.21f, 3.77f));
    EXPECT_EQ(find_medium_preset("Pacific Ocean Surface Water").sigma_a, Vec3(0.031845f, 0.031324f, 0.030147f));
    // Reduced coefficients: those of the paper times 1 - g (tables D2).
    EXPECT_NEAR(find_medium_preset("Regular Milk").sigma_s.x, 18.2052f * (1 - 0.75f), 1e-3f);
    try {
        find_medium_preset("Wholmilk", {"scene.pbrt", 7, 3});
        FAIL();
    } catch (const UserError& error) {
        const std::string what = error.what();
        EXPECT_NE(what.find("scene.pbrt:7:3"), std::string::npos);
        EXPECT_NE(what.find("Wholemilk"), std::string::npos);
    }
}

TEST(MediumPresets, EachNameIsFoundAndItsNumbersAreNotNegative)
{
    for (const std::string_view name : medium_preset_names()) {
        const MediumPreset& preset = find_medium_preset(name);
        EXPECT_EQ(preset.name, name);
        for (int c = 0; c < 3; ++c) {
            EXPECT_GE(preset.sigma_s[c], 0.0f) << name;
            EXPECT_GE(preset.sigma_a[c], 0.0f) << name;
        }
    }
}

}  // namespace
}  // namespace dapple
