// NanoVDB files: a file made here byte by byte, the shared scene's cloud, and damaged ones.

#include "dapple/formats/nanovdb.h"

#include "dapple/base/error.h"
#include "dapple/base/temp_folder.h"
#include "dapple/math/hash.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>
#include <filesystem>
#include <fstream>

namespace dapple {
namespace {

constexpr size_t root_at = 736, upper_at = root_at + 64 + 2 * 32, lower_at = upper_at + 270400,
                 leaf_at = lower_at + 33856, data_size = leaf_at + 2144;

template <class T>
void put(std::string& bytes, size_t at, T value)
{
    std::memcpy(bytes.data() + at, &value, sizeof(T));
}

// One leaf with origin (-8, 0, 16) whose voxel (x, y, z) holds 100 x + 10 y + z (its own coordinates), a tile of
// value 7 at the lower node's next entry in z, (-8, 0, 24); the active box reaches from (-8, 0, 16) to (-1, 7, 31).
std::string grid_data()
{
    std::string d(data_size, '\0');
    std::memcpy(d.data(), "NanoVDB0", 8);
    const double matrix[9] = {0, 0.5, 0, 0.25, 0, 0, 0, 0, 2}, translation[3] = {1, 2, 3};
    std::memcpy(d.data() + 384, matrix, sizeof matrix);
    std::memcpy(d.data() + 528, translation, sizeof translation);
    put<uint64_t>(d, 672 + 24, root_at - 672);
    const int32_t box[6] = {-8, 0, 16, -1, 7, 31};
    std::memcpy(d.data() + root_at, box, sizeof box);
    put<uint32_t>(d, root_at + 24, 2);
    // First tile: a constant far away. Second: the upper node at (-4096, 0, 0).
    put<uint64_t>(d, root_at + 64, uint64_t(5) << 42);
    put<uint64_t>(d, root_at + 96, uint64_t(0x1fffff) << 42);
    put<int64_t>(d, root_at + 96 + 8, int64_t(upper_at - root_at));
    const size_t upper_entry = 31 << 10;  // x 31, y 0, z 0: voxels from (-128, 0, 0)
    put<uint64_t>(d, upper_at + 32 + 4096 + 8 * (upper_entry / 64), uint64_t(1) << (upper_entry % 64));
    put<int64_t>(d, upper_at + 8256 + 8 * upper_entry, int64_t(lower_at - upper_at));
    const size_t lower_entry = 15 << 8 | 0 << 4 | 2;  // voxels from (-8, 0, 16)
    put<uint64_t>(d, lower_at + 32 + 512 + 8 * (lower_entry / 64), uint64_t(1) << (lower_entry % 64));
    put<int64_t>(d, lower_at + 1088 + 8 * lower_entry, int64_t(leaf_at - lower_at));
    put<float>(d, lower_at + 1088 + 8 * (lower_entry + 1), 7.0f);
    for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; ++y)
            for (int z = 0; z < 8; ++z)
                put<float>(d, leaf_at + 96 + 4 * (x << 6 | y << 3 | z), float(100 * x + 10 * y + z));
    return d;
}

std::string file_bytes(bool zip, uint32_t type = 1, uint32_t grid_class = 2)
{
    const std::string data = grid_data();
    std::string file(16 + 176, '\0');
    std::memcpy(file.data(), "NanoVDB0", 8);
    put<uint32_t>(file, 8, 32u << 21 | 3u << 10 | 3u);
    put<uint16_t>(file, 12, 1);
    put<uint16_t>(file, 14, zip ? 1 : 0);
    put<uint64_t>(file, 16, data.size());
    put<uint32_t>(file, 16 + 32, type);
    put<uint32_t>(file, 16 + 36, grid_class);
    put<uint32_t>(file, 16 + 136, 6);
    file += std::string("smoke\0", 6);
    if (!zip) return file + data;
    uLongf size = compressBound(data.size());
    std::string packed(size, '\0');
    compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(data.data()), data.size());
    std::string count(8, '\0');
    put<uint64_t>(count, 0, size);
    return file + count + packed.substr(0, size);
}

class NanoVdb : public testing::Test {
protected:
    TempFolder folder_;
    std::string path_ = (folder_ / "grids.nvdb").string();

    std::vector<NanoVdbGrid> read(const std::string& bytes)
    {
        std::ofstream(path_, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        return read_nanovdb(path_);
    }
};

float value_at(const NanoVdbGrid& grid, int x, int y, int z)
{
    return grid.values[(size_t(z) * grid.ny + y) * grid.nx + x];
}

TEST_F(NanoVdb, ExpandsLeavesAndTilesWithBothCodecs)
{
    for (const bool zip : {false, true}) {
        const auto grids = read(file_bytes(zip));
        ASSERT_EQ(grids.size(), 1u);
        const NanoVdbGrid& grid = grids[0];
        EXPECT_EQ(grid.name, "smoke");
        ASSERT_EQ(grid.nx, 10);
        ASSERT_EQ(grid.ny, 10);
        ASSERT_EQ(grid.nz, 18);
        for (int z = 0; z < 18; ++z)
            for (int y = 0; y < 10; ++y)
                for (int x = 0; x < 10; ++x) {
                    const bool rim = x == 0 || x == 9 || y == 0 || y == 9 || z == 0 || z == 17;
                    const float expected = rim ? 0.0f : (z <= 8 ? float(100 * (x - 1) + 10 * (y - 1) + z - 1) : 7.0f);
                    ASSERT_EQ(value_at(grid, x, y, z), expected) << x << " " << y << " " << z;
                }
        // Voxel (-8, 0, 16) lies at world (0.5 * 0 + 1, 0.25 * -8 + 2, 2 * 16 + 3); it is sample (1, 1, 1).
        const Vec3 p = grid.world_from_unit.point(Vec3(1.5f / 10, 1.5f / 10, 1.5f / 18));
        EXPECT_NEAR(p.x, 1.0f, 1e-5f);
        EXPECT_NEAR(p.y, 0.0f, 1e-5f);
        EXPECT_NEAR(p.z, 35.0f, 1e-4f);
        EXPECT_NEAR(grid.bounds.min.z, 2 * 14.5f + 3, 1e-4f);
        EXPECT_NEAR(grid.bounds.max.x, 0.5f * 8.5f + 1, 1e-4f);
    }
}

TEST_F(NanoVdb, GridsOfOneMapShareABox)
{
    std::string second = file_bytes(true);
    const auto grids = read(file_bytes(false) + second);
    ASSERT_EQ(grids.size(), 2u);
    EXPECT_EQ(grids[0].values, grids[1].values);

    std::string wider = file_bytes(false);
    put<int32_t>(wider, 16 + 176 + 6 + root_at + 12, 3);  // the active box of the second grid ends at x = 3
    const auto joined = read(file_bytes(false) + wider);
    EXPECT_EQ(joined[0].nx, 14);
    EXPECT_EQ(joined[1].nx, 14);
    EXPECT_EQ(value_at(joined[0], 2, 3, 4), 123.0f);
}

TEST_F(NanoVdb, RejectsWhatItCannotUse)
{
    EXPECT_THROW(read(file_bytes(false, 2)), UserError);     // doubles only
    EXPECT_THROW(read(file_bytes(false, 1, 1)), UserError);  // a level set
    std::string file = file_bytes(false);
    put<uint16_t>(file, 14, 2);
    EXPECT_THROW(read(file), UserError);  // Blosc
    file = file_bytes(false);
    put<uint32_t>(file, 8, 31u << 21);
    EXPECT_THROW(read(file), UserError);  // another version
    file = file_bytes(false);
    put<int32_t>(file, 16 + 176 + 6 + root_at + 12, 2000000000);
    EXPECT_THROW(read(file), UserError);  // too large a box
    EXPECT_THROW(read("NanoVDB"), UserError);
    EXPECT_THROW(read(""), UserError);
    EXPECT_THROW(read_nanovdb("/nonexistent.nvdb"), UserError);
}

TEST_F(NanoVdb, DamageIsAnErrorNeverACrash)
{
    const std::string whole = file_bytes(false);
    for (size_t size = 0; size < whole.size(); size = size < 1200 ? size + 7 : size * 2)
        EXPECT_THROW(read(whole.substr(0, size)), UserError) << size;
    EXPECT_THROW(read(whole.substr(0, whole.size() - 1)), UserError);
    const std::string zip = file_bytes(true);
    EXPECT_THROW(read(zip.substr(0, zip.size() - 1)), UserError);

    // Wild child offsets.
    for (const size_t at : {root_at + 96 + 8, upper_at + 8256 + 8 * size_t(31 << 10),
                            lower_at + 1088 + 8 * size_t(15 << 8 | 2), size_t(672 + 24)})
        for (const int64_t offset : {int64_t(1) << 62, -(int64_t(1) << 62), int64_t(-1) << 40, int64_t(data_size)}) {
            std::string file = whole;
            put<int64_t>(file, 16 + 176 + 6 + at, offset);
            EXPECT_THROW(read(file), UserError) << at << " " << offset;
        }

    // Random bytes: anything but a crash.
    for (uint64_t trial = 0; trial < 300; ++trial) {
        std::string file = whole;
        for (uint64_t i = 0; i < 4; ++i) {
            const uint64_t h = hash_words(trial, i);
            const size_t range = i < 3 ? 16 + 176 + 6 + upper_at + 40 : whole.size();
            file[h % range] = static_cast<char>(h >> 56);
        }
        try {
            for (const NanoVdbGrid& grid : read(file))
                ASSERT_EQ(grid.values.size(), size_t(grid.nx) * grid.ny * grid.nz);
        } catch (const UserError&) {
        }
    }
}

TEST_F(NanoVdb, BecomesAGridMediumInPlace)
{
    read(file_bytes(true));
    scene::Medium medium;
    medium.kind = scene::NanoVdbMedium{.file = path_, .density_grid = "smoke"};
    medium.world_from_medium = translation(Vec3(0, 0, 10));
    expand_nanovdb(medium);
    const auto& grid = std::get<scene::UniformGridMedium>(medium.kind);
    EXPECT_EQ(grid.density.nz, 18);
    EXPECT_EQ(grid.density.values.size(), 1800u);
    EXPECT_TRUE(grid.temperature.values.empty());
    EXPECT_NEAR(Transform(medium.world_from_medium).point(Vec3(0.15f, 0.15f, 1.5f / 18)).z, 45.0f, 1e-4f);

    // Both grids at once, and their names when one is missing.
    medium.kind = scene::NanoVdbMedium{.file = path_, .density_grid = "smok"};
    EXPECT_THROW(expand_nanovdb(medium), UserError);
    std::string hot = file_bytes(false);
    hot.replace(16 + 176, 5, "tempe");
    std::ofstream(path_, std::ios::binary) << file_bytes(false) << hot;
    medium.kind = scene::NanoVdbMedium{
        .file = path_, .density_grid = "smoke", .temperature_grid = "tempe", .emission_scale = 2.0f};
    expand_nanovdb(medium);
    const auto& both = std::get<scene::UniformGridMedium>(medium.kind);
    EXPECT_EQ(both.temperature.values, both.density.values);
    EXPECT_EQ(both.emission_scale.values, std::vector<float>(1800, 2.0f));
}

TEST_F(NanoVdb, ReadsTheSharedCloud)
{
    const char* path = "/work/shared/scenes/teapot-cloud/geometry/teapot_cloud-RENDER-0.85.nvdb";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "the shared scenes are not here";
    const auto grids = read_nanovdb(path);
    ASSERT_EQ(grids.size(), 1u);
    const NanoVdbGrid& grid = grids[0];
    EXPECT_EQ(grid.name, "density");
    // The box of the file's metadata, (-136, -60, -90) to (130, 73, 87), and one layer; the sum and the maximum are
    // what the NanoVDB library of OpenVDB 10 reads (it agreed in every voxel).
    EXPECT_EQ(grid.nx, 269);
    EXPECT_EQ(grid.ny, 136);
    EXPECT_EQ(grid.nz, 180);
    double sum = 0.0;
    float largest = 0.0f;
    for (const float value : grid.values) {
        sum += value;
        largest = std::max(largest, value);
    }
    EXPECT_NEAR(sum, 91680947.3, 1.0);
    EXPECT_EQ(largest, 50.0f);
    EXPECT_NEAR(grid.bounds.min.x, -1.05483f, 1e-5f);
    EXPECT_NEAR(grid.bounds.max.z, 0.678926f, 1e-5f);
}

}  // namespace
}  // namespace dapple
