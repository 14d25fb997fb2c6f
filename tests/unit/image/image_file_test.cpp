#include "dapple/image/image_file.h"

#include "dapple/base/error.h"
#include "dapple/base/temp_folder.h"
#include "support/error_of.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>

namespace dapple {
namespace {

namespace fs = std::filesystem;

class ImageFileTest : public ::testing::Test {
protected:
    std::string place(const std::string& name) const { return (folder_ / name).string(); }
    size_t files() const { return std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()); }

    TempFolder folder_;
};

Image ramp(int width, int height, int channels)
{
    Image image(width, height, channels);
    for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = 0.37f * static_cast<float>(i) - 1.5f;
    return image;
}

TEST_F(ImageFileTest, ExrKeepsEveryBitEveryLayerAndTheHeader)
{
    const Image image = ramp(7, 5, 8);
    WriteOptions options;
    options.channel_names = {"R", "G", "B", "Albedo.R", "Albedo.G", "Albedo.B", "Z", "photons.density"};
    options.metadata = {{"dapple:version", std::string("0.1.0")},
                        {"dapple:command", std::string("dapple render 'a b.json'")},
                        {"dapple:seed", std::string("18446744073709551615")},
                        {"dapple:passes", 12},
                        {"dapple:seconds", 1.25}};
    write_image(place("a.exr"), image, options);

    const ImageFile file = read_image_file(place("a.exr"));
    ASSERT_EQ(file.image.width, 7);
    ASSERT_EQ(file.image.height, 5);
    ASSERT_EQ(file.image.channels, 8);
    for (int c = 0; c < 8; ++c) {
        const int found = file.channel(options.channel_names[c]);
        ASSERT_GE(found, 0) << options.channel_names[c];
        for (int y = 0; y < 5; ++y)
            for (int x = 0; x < 7; ++x) EXPECT_EQ(file.image.at(x, y, found), image.at(x, y, c));
    }
    const std::map<std::string, ImageAttribute> header(file.metadata.begin(), file.metadata.end());
    for (const auto& [name, value] : options.metadata) {
        ASSERT_TRUE(header.contains(name)) << name;
        EXPECT_EQ(header.at(name), value) << name;
    }
    EXPECT_EQ(file.channel("missing"), -1);
    EXPECT_EQ(files(), 1u);

    const Image color = read_image(place("a.exr"));
    ASSERT_EQ(color.channels, 3);
    EXPECT_EQ(color.at(6, 4, 2), image.at(6, 4, 2));
}

TEST_F(ImageFileTest, ExrHalfRoundsToElevenBits)
{
    Image image(1, 1, 3);
    image.pixels = {1.0f + 1.0f / 1024, 1.0f + 1.0f / 4096, 0.25f};
    WriteOptions options;
    options.half = true;
    write_image(place("a.exr"), image, options);
    EXPECT_EQ(read_image(place("a.exr")).pixels, (std::vector<float>{1.0f + 1.0f / 1024, 1.0f, 0.25f}));
}

TEST_F(ImageFileTest, PngHoldsTheStandardCurve)
{
    // Codes of the sRGB curve: 0.5 -> 188, 0.18 -> 118, 0.0031308 -> 10.3; above 1 is clipped, NaN and below 0 are
    // black.
    Image image(3, 2, 3);
    image.pixels = {0.5f,  0.18f, 0.0031308f, 1.0f, 7.0f, -1.0f, NAN,  infinity, 0.0f,
                    0.25f, 0.75f, 0.01f,      0.1f, 0.2f, 0.3f,  0.4f, 0.6f,     0.9f};
    write_image(place("a.png"), image);
    ReadOptions raw;
    raw.encoding.kind = ColorEncoding::Kind::linear;
    const Image codes = read_image(place("a.png"), raw);
    const int expected[9] = {188, 118, 10, 255, 255, 0, 0, 255, 0};
    for (int i = 0; i < 9; ++i) EXPECT_EQ(std::lround(codes.pixels[i] * 255), expected[i]) << i;

    const Image linear = read_image(place("a.png"));
    for (int i = 9; i < 18; ++i) EXPECT_NEAR(linear.pixels[i], image.pixels[i], 0.005f) << i;

    ReadOptions gamma;
    gamma.encoding = {ColorEncoding::Kind::gamma, 2.0f};
    EXPECT_NEAR(read_image(place("a.png"), gamma).pixels[0], std::pow(188 / 255.0f, 2.0f), 1e-6f);

    WriteOptions brighter;
    brighter.exposure = 1.0f;
    write_image(place("b.png"), image, brighter);
    EXPECT_EQ(std::lround(read_image(place("b.png"), raw).at(0, 1, 0) * 255), 188);
}

TEST_F(ImageFileTest, PngAlphaIsLinearAndNotMultipliedIn)
{
    Image image(2, 1, 4);
    image.pixels = {0.5f, 0.5f, 0.5f, 0.2f, 1.0f, 0.0f, 0.5f, 0.0f};
    write_image(place("a.png"), image);
    const Image back = read_image(place("a.png"));
    ASSERT_EQ(back.channels, 4);
    for (int i = 0; i < 8; ++i) EXPECT_NEAR(back.pixels[i], image.pixels[i], 0.005f) << i;
}

TEST_F(ImageFileTest, PfmAndHdrKeepRowsInOrder)
{
    for (const int channels : {1, 3}) {
        const Image image = ramp(4, 3, channels);
        write_image(place("a.pfm"), image);
        const Image back = read_image(place("a.pfm"));
        ASSERT_EQ(back.channels, channels);
        EXPECT_EQ(back.pixels, image.pixels);
    }
    Image image(2, 2, 3);
    image.pixels = {1, 2, 3, 100, 200, 50, 0.5f, 0.25f, 0.125f, 0, 0, 0};
    write_image(place("a.hdr"), image);
    const Image back = read_image(place("a.hdr"));
    ASSERT_EQ(back.pixels.size(), image.pixels.size());
    for (size_t i = 0; i < back.pixels.size(); ++i)
        EXPECT_NEAR(back.pixels[i], image.pixels[i], 0.01f * std::max(1.0f, image.pixels[i])) << i;
}

TEST_F(ImageFileTest, LayersOfOtherFormatsAreChosenByName)
{
    Image image(1, 1, 5);
    image.pixels = {9, 3, 2, 1, 8};
    WriteOptions options;
    options.channel_names = {"Z", "B", "G", "R", "N.X"};
    write_image(place("a.pfm"), image, options);
    EXPECT_EQ(read_image(place("a.pfm")).pixels, (std::vector<float>{1, 2, 3}));
}

TEST_F(ImageFileTest, ErrorsNameTheFileAndTheCause)
{
    EXPECT_NE(error_of([&] { read_image(place("none.png")); }).find("none.png': no such file"), std::string::npos);
    std::ofstream(place("bad.png")) << "this is no image";
    EXPECT_NE(error_of([&] { read_image(place("bad.png")); }).find("bad.png"), std::string::npos);
    std::ofstream(place("bad.exr")) << "this is no image";
    EXPECT_NE(error_of([&] { read_image(place("bad.exr")); }).find("bad.exr"), std::string::npos);
    const Image image(2, 2, 3);
    EXPECT_NE(error_of([&] { write_image(place("a.gif"), image); }).find(".gif"), std::string::npos);
    for (const char* name : {"no/such/folder/a.exr", "no/such/folder/a.png", "no/such/folder/a.pfm"})
        EXPECT_NE(error_of([&] { write_image(place(name), image); }).find("folder"), std::string::npos) << name;
    EXPECT_NE(error_of([&] { write_image(place("a.exr"), Image()); }), "");
    WriteOptions options;
    options.channel_names = {"R", "G"};
    EXPECT_NE(error_of([&] { write_image(place("a.exr"), image, options); }).find("2 names for 3"), std::string::npos);
}

TEST_F(ImageFileTest, TruncatedFileIsAnError)
{
    write_image(place("a.exr"), ramp(64, 64, 3));
    fs::resize_file(place("a.exr"), fs::file_size(place("a.exr")) / 2);
    EXPECT_NE(error_of([&] { read_image(place("a.exr")); }), "");
}

// A file size limit stands for a full disk.
TEST_F(ImageFileTest, FailedWriteLeavesTheOldFile)
{
    Image image(256, 256, 3);
    uint32_t state = 1;
    for (float& v : image.pixels) v = static_cast<float>((state = state * 1664525u + 1013904223u) >> 8) * 0x1p-24f;
    for (const char* name : {"a.exr", "a.png", "a.pfm", "a.hdr"}) {
        std::ofstream(place(name)) << "old";
        const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
        rlimit old_limit{};
        getrlimit(RLIMIT_FSIZE, &old_limit);
        const rlimit small{20000, old_limit.rlim_max};
        setrlimit(RLIMIT_FSIZE, &small);
        const std::string message = error_of([&] { write_image(place(name), image); });
        setrlimit(RLIMIT_FSIZE, &old_limit);
        std::signal(SIGXFSZ, old_handler);
        EXPECT_NE(message.find(name), std::string::npos) << name << ": " << message;
        EXPECT_EQ(fs::file_size(place(name)), 3u) << name;
    }
    EXPECT_EQ(files(), 4u);
}

TEST(Srgb, CurveMatchesTheStandard)
{
    EXPECT_NEAR(srgb_to_linear(0.5f), 0.21404114f, 1e-6f);
    EXPECT_NEAR(linear_to_srgb(0.18f), 0.46135613f, 1e-6f);
    for (int i = 0; i <= 255; ++i) EXPECT_NEAR(linear_to_srgb(srgb_to_linear(i / 255.0f)), i / 255.0f, 1e-5f);
}

}  // namespace
}  // namespace dapple
