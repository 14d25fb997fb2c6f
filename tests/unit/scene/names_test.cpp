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

// Counts and words from pbrt-v4's util/spectrum.cpp, media.cpp and film.cpp.
TEST(Names, HoldsWhatPbrtHas)
{
    const std::string_view spectra_of_pbrt[] = {
        "glass-BK7",    "glass-BAF10",    "glass-FK51A",  "glass-LASF9",    "glass-F5",     "glass-F10",
        "glass-F11",    "metal-Ag-eta",   "metal-Ag-k",   "metal-Al-eta",   "metal-Al-k",   "metal-Au-eta",
        "metal-Au-k",   "metal-Cu-eta",   "metal-Cu-k",   "metal-CuZn-eta", "metal-CuZn-k", "metal-MgO-eta",
        "metal-MgO-k",  "metal-TiO2-eta", "metal-TiO2-k", "stdillum-A",     "stdillum-D50", "stdillum-D65",
        "stdillum-F1",  "stdillum-F2",    "stdillum-F3",  "stdillum-F4",    "stdillum-F5",  "stdillum-F6",
        "stdillum-F7",  "stdillum-F8",    "stdillum-F9",  "stdillum-F10",   "stdillum-F11", "stdillum-F12",
        "illum-acesD60"};
    for (const std::string_view name : spectra_of_pbrt) EXPECT_TRUE(contains(spectrum_names(), name)) << name;
    EXPECT_EQ(medium_preset_names().size(), 47u);
    EXPECT_EQ(sensor_names().size(), 18u);
    EXPECT_EQ(sensor_names().front(), Film{}.sensor);
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
