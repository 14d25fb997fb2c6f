// Checkpoints: what goes in comes out, damage of any byte is noticed, and only what belongs together is merged.
#include "dapple/render/checkpoint.h"

#include "dapple/base/error.h"
#include "dapple/base/log.h"
#include "dapple/base/temp_folder.h"
#include "dapple/render/checkpointer.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>

namespace dapple {
namespace {

namespace fs = std::filesystem;

class CheckpointFile : public testing::Test {
protected:
    CheckpointFile() { set_log_level(LogLevel::silent); }
    ~CheckpointFile() override { set_log_level(LogLevel::info); }

    static CheckpointHeader header(uint32_t first, uint32_t count)
    {
        CheckpointHeader header;
        header.record = {
            "1.0 (abc)", "dapple render 'a b.pbrt'", "/x/a b.pbrt", "path", {"report one", "two"}, ~0ull, 3};
        header.settings = {{"maxdepth", "12"}};
        header.files = {{"/x/a b.pbrt", "0123"}, {"/x/floor tile.png", "4567"}};
        header.film.resolution = header.film.crop_max = {6, 4};
        header.film.light_groups = {"", "lamp one"};
        header.film.error_layer = true;
        header.film.first_pass = first;
        header.ranges = {{first, count}};
        header.counters = {1.0 / 3, 1, 2, 3, 4};
        header.arguments = {"a b.pbrt", "-o", "x.exr", ""};
        header.folder = "/home/some one";
        return header;
    }

    // A film whose pass i adds i + 1 to each pixel.
    static Checkpoint part(uint32_t first, uint32_t count)
    {
        Checkpoint made{header(first, count), nullptr};
        made.film = std::make_unique<Film>(made.header.film);
        for (uint32_t pass = first; pass < first + count; ++pass) {
            for (int y = 0; y < 4; ++y)
                for (int x = 0; x < 6; ++x) {
                    PixelSample sample(2);
                    sample.add(Vec3(static_cast<float>(pass + 1)), PathClass::caustic, LightGroup(1));
                    made.film->add_pixel({x, y}, sample, 1);
                }
            made.film->end_pass();
        }
        return made;
    }

    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    std::string write(const std::string& name, uint32_t first, uint32_t count) const
    {
        const Checkpoint made = part(first, count);
        write_checkpoint(path(name), made.header, *made.film);
        return path(name);
    }
    static std::string bytes_of(const std::string& file)
    {
        std::ifstream in(file, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    static std::string error_of(const std::function<void()>& action)
    {
        try {
            action();
        } catch (const UserError& error) {
            return error.what();
        }
        return "no error";
    }

    TempFolder folder_;
};

TEST_F(CheckpointFile, ComesBackAsItWas)
{
    const Checkpoint read = read_checkpoint(write("a.dapple", 2, 3));
    const CheckpointHeader expected = header(2, 3);
    const CheckpointHeader& found = read.header;
    EXPECT_EQ(difference(expected, found), "");
    EXPECT_EQ(found.record.seed, ~0ull);
    EXPECT_EQ(found.record.command, expected.record.command);
    EXPECT_EQ(found.record.report, expected.record.report);
    EXPECT_EQ(found.settings, expected.settings);
    EXPECT_EQ(found.files, expected.files);
    EXPECT_EQ(found.film.light_groups, expected.film.light_groups);
    EXPECT_EQ(found.film.first_pass, 2u);
    EXPECT_EQ(found.counters.seconds, 1.0 / 3);
    EXPECT_EQ(found.counters.rays, 4u);
    EXPECT_EQ(found.arguments, expected.arguments);
    EXPECT_EQ(found.folder, expected.folder);
    EXPECT_EQ(found.passes(), 3u);
    std::vector<std::string> names;
    EXPECT_EQ(read.film->layers(names).pixels, part(2, 3).film->layers(names).pixels);
    EXPECT_EQ(fs::exists(path("a.dapple.new-" + std::to_string(getpid()))), false);
}

TEST_F(CheckpointFile, EveryDamagedByteAndEveryCutIsNoticed)
{
    const std::string good = bytes_of(write("a.dapple", 0, 2));
    const auto read_bytes = [&](const std::string& bytes) {
        std::ofstream(path("b.dapple"), std::ios::binary) << bytes;
        return error_of([&] { read_checkpoint(path("b.dapple")); });
    };
    ASSERT_EQ(read_bytes(good), "no error");
    for (size_t at = 0; at < good.size(); at += at < 1200 ? 1 : 97) {
        std::string damaged = good;
        damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
        const std::string error = read_bytes(damaged);
        EXPECT_NE(error, "no error") << at;
        EXPECT_NE(error.find("b.dapple"), std::string::npos) << error;
        EXPECT_NE(read_bytes(good.substr(0, at)), "no error") << at;
    }
    EXPECT_NE(read_bytes(good + "x"), "no error");
    EXPECT_NE(read_bytes("v/1\n").find("is no .dapple file"), std::string::npos);
    EXPECT_NE(error_of([&] { read_checkpoint(path("none.dapple")); }).find("no such file"), std::string::npos);
}

TEST_F(CheckpointFile, PartsMergeToTheWhole)
{
    Checkpoint merged = read_checkpoint(write("b.dapple", 4, 3));
    merge_checkpoint(merged, read_checkpoint(write("c.dapple", 7, 1)), "c.dapple");
    EXPECT_EQ(merged.header.ranges.size(), 1u);
    merge_checkpoint(merged, read_checkpoint(write("a.dapple", 0, 3)), "a.dapple");
    EXPECT_EQ(merged.header.ranges.size(), 2u);
    merge_checkpoint(merged, read_checkpoint(write("d.dapple", 3, 1)), "d.dapple");
    EXPECT_EQ(merged.header.ranges.size(), 1u);
    EXPECT_EQ(merged.header.passes(), 8u);
    std::vector<std::string> names;
    EXPECT_EQ(merged.film->layers(names).pixels, part(0, 8).film->layers(names).pixels);
    const std::string error = error_of([&] { merge_checkpoint(merged, part(7, 2), "e.dapple"); });
    EXPECT_NE(error.find("'e.dapple' holds passes 7 to 8, of which some are already there (0 to 7)"), std::string::npos)
        << error;
    EXPECT_EQ(merged.film->passes(), 8u) << "nothing was merged by halves";
}

TEST_F(CheckpointFile, WhatBelongsToAnotherRenderIsRefusedWithTheReason)
{
    const std::vector<std::pair<std::function<void(CheckpointHeader&)>, std::string>> changes = {
        {[](CheckpointHeader& h) { h.record.version = "2.0"; }, "Dapple 2.0, not 1.0 (abc)"},
        {[](CheckpointHeader& h) { h.files[1].second = "8"; }, "another scene: '/x/floor tile.png' differs"},
        {[](CheckpointHeader& h) { h.files.pop_back(); }, "another scene"},
        {[](CheckpointHeader& h) { h.record.seed = 5; }, "seed 5, not 18446744073709551615"},
        {[](CheckpointHeader& h) { h.record.integrator = "photonmap"; }, "integrator photonmap, not path"},
        {[](CheckpointHeader& h) { h.settings.clear(); }, "settings the defaults, not maxdepth=12"},
        {[](CheckpointHeader& h) { h.film.resolution.x = 7; }, "resolution 7x4, not 6x4"},
        {[](CheckpointHeader& h) { h.film.crop_min.x = 1; }, "crop 1,6,0,4, not 0,6,0,4"},
        {[](CheckpointHeader& h) { h.film.color_model = ColorModel::rgb; }, "rgb, not spectral"},
        {[](CheckpointHeader& h) { h.film.guide_layers = false; }, "layers"},
        {[](CheckpointHeader& h) { h.pbrt_coats = true; }, "--pbrt-coats"},
    };
    Checkpoint whole = part(0, 1);
    for (const auto& [change, reason] : changes) {
        Checkpoint other = part(1, 1);
        change(other.header);
        const std::string error = error_of([&] { merge_checkpoint(whole, other, "o.dapple"); });
        EXPECT_NE(error.find(reason), std::string::npos) << error << " / " << reason;
        EXPECT_NE(error.find("o.dapple"), std::string::npos) << error;
    }
    EXPECT_EQ(whole.film->passes(), 1u);
    // Names of files do not matter: the scene may lie elsewhere.
    Checkpoint moved = part(1, 1);
    moved.header.files[0].first = "/y/a.pbrt";
    EXPECT_NO_THROW(merge_checkpoint(whole, moved, "o.dapple"));
}

// A disk that fills up: by the limit of the size of files, which fails in the same place.
TEST_F(CheckpointFile, FullDiskLeavesTheOldOneAndTheRenderGoesOn)
{
    const std::string file = write("a.dapple", 0, 1);
    const std::string before = bytes_of(file);
    Checkpoint more = part(0, 2);
    Checkpointer checkpointer({file, 0, 0, false}, more.header);
    const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
    rlimit old_limit{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old_limit), 0);
    const rlimit small{100, old_limit.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    const std::string error = error_of([&] { write_checkpoint(file, more.header, *more.film); });
    EXPECT_NO_THROW(checkpointer.after_pass(*more.film, {}));
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &old_limit), 0);
    std::signal(SIGXFSZ, old_handler);

    EXPECT_NE(error.find("cannot be written"), std::string::npos) << error;
    EXPECT_EQ(bytes_of(file), before);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 1) << "nothing else is left lying about";
    checkpointer.after_pass(*more.film, {});
    EXPECT_TRUE(checkpointer.written());
    EXPECT_EQ(read_checkpoint_header(file).passes(), 2u);
}

TEST_F(CheckpointFile, AutomaticOnesGoWhenTheRenderIsDone)
{
    const Checkpoint made = part(0, 2);
    RenderResult result;
    result.film_whole = true;
    for (const bool by_request : {false, true}) {
        result.by_request = by_request;
        Checkpointer checkpointer({path("auto.dapple"), 0, 0, true}, made.header);
        checkpointer.after_pass(*made.film, {});
        EXPECT_TRUE(read_checkpoint_header(path("auto.dapple")).automatic);
        EXPECT_TRUE(checkpointer.finish(*made.film, result));
        EXPECT_EQ(fs::exists(path("auto.dapple")), by_request);
    }
    fs::remove(path("auto.dapple"));
    Checkpointer short_render({path("auto.dapple"), 1000, 1000, true}, made.header);
    short_render.after_pass(*made.film, {});
    EXPECT_TRUE(short_render.finish(*made.film, result));
    EXPECT_FALSE(fs::exists(path("auto.dapple")));
}

}  // namespace
}  // namespace dapple
