// The words of scene files and the values of a fresh description.
#include "dapple/scene/names.h"
#include "dapple/scene/description.h"

#include <gtest/gtest.h>

#include <set>

namespace dapple::scene {
namespace {

TEST(Names, ColorSpacesReadInAnyCaseAndComeBack)
{
    EXPECT_EQ(color_space_from_name("sRGB"), ColorSpace::srgb);
    EXPECT_EQ(color_space_from_name("ACES2065-1"), ColorSpace::aces2065_1);
    EXPECT_EQ(color_space_from_name("rec709"), std::nullopt);
    for (std::string_view name : color_space_names()) EXPECT_EQ(color_space_name(*color_space_from_name(name)), name);
}

TEST(Names, EachListHasNoWordTwice)
{
    for (auto names : {spectrum_names(), medium_preset_names(), sensor_names(), color_space_names()})
        EXPECT_EQ(std::set<std::string_view>(names.begin(), names.end()).size(), names.size());
}

TEST(Names, HoldsWhatPbrtHas)
{
    EXPECT_EQ(spectrum_names().size(), 37u);
    EXPECT_EQ(medium_preset_names().size(), 47u);
    EXPECT_EQ(sensor_names().size(), 18u);
    EXPECT_TRUE(contains(spectrum_names(), "metal-Cu-eta"));
    EXPECT_FALSE(contains(spectrum_names(), "metal-cu-eta"));
}

TEST(Description, DefaultsArePbrts)
{
    const Description scene;
    EXPECT_EQ(scene.film.resolution, Int2(1280, 720));
    EXPECT_EQ(scene.camera.fov, 90.0f);
    EXPECT_EQ(scene.film.imaging_ratio(scene.camera), 1.0f);
    EXPECT_EQ(std::get<Named>(ConductorMaterial{}.eta.value.value).name, "metal-Cu-eta");
    EXPECT_EQ(std::get<Constant>(DielectricMaterial{}.eta.value).value, 1.5f);
    EXPECT_FALSE(MovingMatrix{}.moves());
    EXPECT_FALSE(Shape{}.area_light.valid());
}

}  // namespace
}  // namespace dapple::scene
