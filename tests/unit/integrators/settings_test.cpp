// Settings: forms, bounds, fallbacks and the errors people meet.
#include "dapple/integrators/settings.h"

#include "support/error_of.h"

#include <gtest/gtest.h>

#include <array>

namespace dapple {
namespace {

constexpr std::array<SettingInfo, 6> table = {{
    {"photons", "photons", "1M", "integer >= 1", "photons per pass"},
    {"radius", "scene units", "auto", "> 0", "bandwidth"},
    {"alpha", "", "0.75", "> 0 and < 1", "reduction"},
    {"share", "", "0.5", "0 to 1", "share"},
    {"kernel", "", "cone", "constant|cone|gaussian", "kernel"},
    {"gather", "", "true", "true|false", "final gathering"},
}};

std::string error_of(const std::string& name, const std::string& value)
{
    Settings settings(table);
    return dapple::error_of([&] { settings.set(name, value); });
}

TEST(Settings, GiveFallbacksUntilSet)
{
    Settings settings(table);
    EXPECT_EQ(settings.integer("photons"), 1'000'000);
    EXPECT_TRUE(settings.is_auto("radius"));
    EXPECT_DOUBLE_EQ(settings.number("alpha"), 0.75);
    EXPECT_EQ(settings.word("kernel"), "cone");
    EXPECT_TRUE(settings.boolean("gather"));
}

TEST(Settings, ReadMultipliers)
{
    Settings settings(table);
    for (const auto& [text, value] : std::array<std::pair<const char*, int64_t>, 5>{
             {{"1e6", 1'000'000}, {"500k", 500'000}, {"2M", 2'000'000}, {"1G", 1'000'000'000}, {"1.5k", 1500}}}) {
        settings.set("photons", text);
        EXPECT_EQ(settings.integer("photons"), value) << text;
    }
}

TEST(Settings, AutoOnlyWhereTheSceneDecides)
{
    EXPECT_EQ(error_of("radius", "auto"), "");
    EXPECT_NE(error_of("alpha", "auto"), "");
}

TEST(Settings, RefuseWhatIsOutOfBounds)
{
    EXPECT_EQ(error_of("photons", "1"), "");
    EXPECT_NE(error_of("photons", "0"), "");
    EXPECT_NE(error_of("photons", "1.5"), "");
    EXPECT_NE(error_of("radius", "0"), "");
    EXPECT_EQ(error_of("alpha", "0.999"), "");
    EXPECT_NE(error_of("alpha", "1"), "");
    EXPECT_EQ(error_of("share", "1"), "");
    EXPECT_NE(error_of("share", "1.001"), "");
    EXPECT_NE(error_of("share", "-0.001"), "");
}

TEST(Settings, RefuseWhatIsNoNumber)
{
    for (const char* text : {"", " 1", "1 ", "1x", "nan", "inf", "1kk", "k", "many"})
        EXPECT_NE(error_of("radius", text), "") << "'" << text << "'";
}

TEST(Settings, SayTheirRangeInWords)
{
    EXPECT_EQ(error_of("photons", "0"), "setting 'photons' takes a whole number of 1 or more, not '0'");
    EXPECT_EQ(error_of("radius", "x"), "setting 'radius' takes a number above 0 or auto, not 'x'");
    EXPECT_EQ(error_of("alpha", "1"), "setting 'alpha' takes a number above 0 and below 1, not '1'");
    EXPECT_EQ(error_of("share", "2"), "setting 'share' takes a number from 0 to 1, not '2'");
    EXPECT_EQ(error_of("kernel", "x"), "setting 'kernel' takes constant, cone or gaussian, not 'x'");
}

TEST(Settings, NameTheNearestKnownWord)
{
    EXPECT_NE(error_of("photon", "1").find("'photons'"), std::string::npos);
    EXPECT_NE(error_of("kernel", "gausian").find("'gaussian'"), std::string::npos);
    EXPECT_NE(error_of("gather", "yes").find("true or false"), std::string::npos);
}

}  // namespace
}  // namespace dapple
