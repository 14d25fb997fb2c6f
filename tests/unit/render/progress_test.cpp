// Progress: never 100 % before the end, remaining time rounded down, JSON that a program can read.
#include "dapple/render/progress.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

TEST(Progress, PercentIsRoundedDownAndNever100)
{
    EXPECT_EQ(progress_percent(0.0), 0);
    EXPECT_EQ(progress_percent(0.0099), 0);
    EXPECT_EQ(progress_percent(0.5099), 50);
    EXPECT_EQ(progress_percent(0.9999999), 99);
    EXPECT_EQ(progress_percent(1.0), 99);
    EXPECT_EQ(progress_percent(7.0), 99);
    EXPECT_EQ(progress_percent(-1.0), 0);
}

TEST(Progress, LineTellsPassSamplesPhotonsAndTimes)
{
    ProgressState state;
    state.passes_done = 3;
    state.passes_total = 16;
    state.eye_paths = 1'234'567;
    state.photons = 45'678;
    state.elapsed = 12.9;
    state.remaining = 61.99;
    state.fraction = 0.2;
    EXPECT_EQ(format_progress(state, 10),
              "20 % [##........] pass 4 of 16, 1.23 M eye paths, 45.6 k photons, 12 s gone, 1 min 01 s left");
}

TEST(Progress, AfterARequestTheLineIsOfThePass)
{
    ProgressState state;
    state.passes_done = 3;
    state.passes_total = 1000;
    state.elapsed = 12.9;
    state.remaining = 2.5;
    state.fraction = 0.4;
    state.stopping = true;
    EXPECT_EQ(format_progress(state, 10), "40 % [####......] of pass 4, the last, 12 s gone, 2 s left");
    state.remaining = -1;
    EXPECT_EQ(format_progress(state, 0), "40 % of pass 4, the last, 12 s gone");
}

TEST(Progress, BarIsNeverFull)
{
    ProgressState state;
    state.passes_total = 2;
    state.passes_done = 1;
    state.fraction = 0.999999;
    const std::string line = format_progress(state, 8);
    EXPECT_NE(line.find("99 % [#######.]"), std::string::npos) << line;
}

TEST(Progress, UnknownEndShowsNoPercentage)
{
    ProgressState state;
    state.elapsed = 5;
    EXPECT_EQ(format_progress(state, 10), "pass 1, 5 s gone");
}

TEST(Progress, JsonRoundsRemainingDownAndSaysNullForUnknown)
{
    ProgressState state;
    state.passes_done = 1;
    state.elapsed = 2.5;
    state.remaining = 9.99;
    state.fraction = 0.2;
    const std::string line = format_progress_json(state);
    EXPECT_NE(line.find(R"("pass": 2, "passes": null)"), std::string::npos) << line;
    EXPECT_NE(line.find(R"("remaining": 9, "percent": 20)"), std::string::npos) << line;
    state.remaining = -1;
    EXPECT_NE(format_progress_json(state).find(R"("remaining": null)"), std::string::npos);
}

TEST(Progress, JsonStringsAreEscaped) { EXPECT_EQ(json_string("a\"b\\c\nd"), "\"a\\\"b\\\\c\\u000ad\""); }

}  // namespace
}  // namespace dapple
