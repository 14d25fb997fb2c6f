// Output: what is refused before rendering, what is in the header, and that a failed write loses nothing.
#include "dapple/render/output.h"

#include "dapple/base/error.h"
#include "dapple/base/log.h"
#include "dapple/base/temp_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

namespace dapple {
namespace {

namespace fs = std::filesystem;

class Output : public testing::Test {
protected:
    Output() : progress_(make_progress(ProgressKind::none))
    {
        set_log_level(LogLevel::silent);
        result_.image = Image(2, 2, 4);
        for (float& value : result_.image.pixels) value = 0.25f;
        result_.channels = {"R", "G", "B", "Z"};
        result_.passes = 7;
        result_.reason = "all passes done";
        record_.version = "1.2.3";
        record_.command = "dapple render x.pbrt";
        record_.seed = 18446744073709551615ull;
    }
    ~Output() override { set_log_level(LogLevel::info); }

    std::string in_folder(const std::string& name) const { return (folder_ / name).string(); }

    TempFolder folder_;
    RenderResult result_;
    RenderRecord record_;
    std::unique_ptr<Progress> progress_;
};

std::string attribute(const ImageFile& file, const std::string& name)
{
    for (const auto& [key, value] : file.metadata)
        if (key == name)
            return std::holds_alternative<std::string>(value) ? std::get<std::string>(value)
                                                              : std::to_string(std::get<int>(value));
    return "(none)";
}

TEST_F(Output, RefusesBeforeRendering)
{
    EXPECT_NO_THROW(check_output_paths({in_folder("a.exr"), in_folder("a.PNG"), in_folder("a.pfm")}));
    EXPECT_THROW(check_output_paths({in_folder("a.xyz")}), UserError);
    EXPECT_THROW(check_output_paths({in_folder("a")}), UserError);
    EXPECT_THROW(check_output_paths({in_folder("missing/a.exr")}), UserError);
    fs::create_directories(folder_ / "b.exr");
    EXPECT_THROW(check_output_paths({in_folder("b.exr")}), UserError);
}

TEST_F(Output, HeaderSaysHowTheImageWasMade)
{
    OutputOptions options;
    options.paths = {in_folder("a.exr")};
    ASSERT_EQ(write_outputs(result_, record_, options, *progress_), "");
    const ImageFile file = read_image_file(options.paths[0]);
    EXPECT_EQ(attribute(file, "dapple:version"), "1.2.3");
    EXPECT_EQ(attribute(file, "dapple:command"), "dapple render x.pbrt");
    EXPECT_EQ(attribute(file, "dapple:seed"), "18446744073709551615");
    EXPECT_EQ(attribute(file, "dapple:passes"), "7");
    EXPECT_EQ(attribute(file, "dapple:incomplete"), "(none)");
    EXPECT_GE(file.channel("Z"), 0);
}

TEST_F(Output, IncompleteImagesSaySo)
{
    result_.incomplete = "a part";
    const ImageMetadata metadata = image_metadata(record_, result_);
    EXPECT_TRUE(std::any_of(metadata.begin(), metadata.end(),
                            [](const auto& entry) { return entry.first == "dapple:incomplete"; }));
}

TEST_F(Output, FailedWriteIsRescued)
{
    OutputOptions options;
    options.paths = {in_folder("missing/a.png"), in_folder("b.png")};
    options.rescue_folders = {in_folder("also-missing"), folder_.path().string()};
    options.retry_pauses = {};
    const std::string error = write_outputs(result_, record_, options, *progress_);
    EXPECT_NE(error.find("missing/a.png'"), error.npos) << error;
    EXPECT_TRUE(error.ends_with("; the render was saved as " + in_folder("dapple-rescue-1.exr"))) << error;
    EXPECT_TRUE(fs::exists(folder_ / "b.png"));
    EXPECT_EQ(read_image_file(in_folder("dapple-rescue-1.exr")).image.channels, 4);
    EXPECT_NE(write_outputs(result_, record_, options, *progress_), "");
    EXPECT_TRUE(fs::exists(folder_ / "dapple-rescue-2.exr")) << "an earlier rescue is not overwritten";
}

TEST_F(Output, WhatWasRescuedIsNamedAndNotRescuedAgain)
{
    OutputOptions options;
    options.paths = {in_folder("a.dapple")};
    options.rescue_folders = {in_folder("missing"), folder_.path().string()};
    options.retry_pauses = {0.001, 0.001};
    options.write_state = [](const std::string& path) { throw UserError("no room for " + path); };
    const std::string error = write_outputs(result_, record_, options, *progress_);
    EXPECT_TRUE(error.ends_with("; the image was saved as " + in_folder("dapple-rescue-1.exr"))) << error;
    EXPECT_NE(error.find("no room for " + in_folder("dapple-rescue-1.dapple")), error.npos) << error;
    EXPECT_FALSE(fs::exists(folder_ / "dapple-rescue-2.exr"));
}

TEST_F(Output, TriesAgainWhenNothingTakesIt)
{
    OutputOptions options;
    options.paths = {in_folder("later/a.exr")};
    options.retry_pauses = {0.001, 0.001};
    EXPECT_NE(write_outputs(result_, record_, options, *progress_), "");
    fs::create_directories(folder_ / "later");
    EXPECT_EQ(write_outputs(result_, record_, options, *progress_), "");
}

}  // namespace
}  // namespace dapple
