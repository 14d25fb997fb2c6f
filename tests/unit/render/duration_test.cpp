// Durations, sizes and counts: what is read, what is refused, and that nothing is rounded up.
#include "dapple/render/duration.h"

#include "dapple/base/error.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

TEST(Duration, ReadsWhatPeopleWrite)
{
    EXPECT_DOUBLE_EQ(parse_duration("--time", "90"), 90);
    EXPECT_DOUBLE_EQ(parse_duration("--time", "60s"), 60);
    EXPECT_DOUBLE_EQ(parse_duration("--time", "1.5m"), 90);
    EXPECT_DOUBLE_EQ(parse_duration("--time", "2min"), 120);
    EXPECT_DOUBLE_EQ(parse_duration("--time", "1h30m"), 5400);
    EXPECT_DOUBLE_EQ(parse_duration("--time", "250ms"), 0.25);
}

TEST(Duration, RefusesTheRest)
{
    for (const char* text : {"", "0", "0s", "-1", "-5s", "fast", "10x", "1h30", "10 s", "s", "1e999"})
        EXPECT_THROW(parse_duration("--time", text), UserError) << "'" << text << "'";
}

TEST(Duration, ErrorNamesTheOption)
{
    try {
        parse_duration("--time", "soon");
        FAIL();
    } catch (const UserError& error) {
        EXPECT_NE(std::string(error.what()).find("--time"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("'soon'"), std::string::npos);
    }
}

TEST(Duration, IsWrittenRoundedDown)
{
    EXPECT_EQ(format_duration(0.99), "0 s");
    EXPECT_EQ(format_duration(59.99), "59 s");
    EXPECT_EQ(format_duration(60), "1 min 00 s");
    EXPECT_EQ(format_duration(185.9), "3 min 05 s");
    EXPECT_EQ(format_duration(3599.9), "59 min 59 s");
    EXPECT_EQ(format_duration(7379), "2 h 02 min");
    EXPECT_EQ(format_duration(-3), "0 s");
}

TEST(Size, ReadsPowersOf1024)
{
    EXPECT_EQ(parse_size("--memory", "8G"), 8ull << 30);
    EXPECT_EQ(parse_size("--memory", "512M"), 512ull << 20);
    EXPECT_EQ(parse_size("--memory", "1.5GiB"), 3ull << 29);
    EXPECT_EQ(parse_size("--memory", "100000"), 100000u);
    for (const char* text : {"", "G", "-1G", "8X", "8G8", "0"})
        EXPECT_THROW(parse_size("--memory", text), UserError) << "'" << text << "'";
}

TEST(Size, IsWrittenWithUnits)
{
    EXPECT_EQ(format_size(812), "812 B");
    EXPECT_EQ(format_size(1536), "1.5 KiB");
    EXPECT_EQ(format_size(3.0 * 1024 * 1024 * 1024), "3.0 GiB");
}

TEST(Count, KeepsThreeDigitsRoundedDown)
{
    EXPECT_EQ(format_count(999), "999");
    EXPECT_EQ(format_count(1000), "1.00 k");
    EXPECT_EQ(format_count(12'399), "12.3 k");
    EXPECT_EQ(format_count(999'999), "999 k");
    EXPECT_EQ(format_count(1'000'000), "1.00 M");
    EXPECT_EQ(format_count(4'569'999), "4.56 M");
    EXPECT_EQ(format_count(7'000'000'000), "7.00 G");
}

}  // namespace
}  // namespace dapple
