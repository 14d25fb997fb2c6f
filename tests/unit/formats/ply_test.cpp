// The same small mesh in all forms of PLY must read the same.
#include "dapple/formats/ply.h"

#include "dapple/base/temp_folder.h"
#include "dapple/formats/read_file.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <filesystem>

namespace dapple {
namespace {

const char* const text_mesh =
    "ply\r\nformat ascii 1.0\ncomment made by hand\nobj_info nothing\n"
    "element vertex 5\nproperty float x\nproperty double y\nproperty float z\nproperty uchar red\n"
    "property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n"
    "element edge 1\nproperty int from\nproperty list uchar float weights\n"
    "element face 2\nproperty list uchar int vertex_indices\nproperty int face_indices\nend_header\n"
    "0 0 0 255 0 0 1 0 0\n1 0 0 255 0 0 1 1 0\n1 1 0 255 0 0 1 1 1\n0 1 0 255 0 0 1 0 1\n.5 +2 -1e-1 0 0 0 1 .5 1\n"
    "7 2 0.5 0.25\n"
    "4 0 1 2 3 0\n3 3 2 4 1\n";

void check(const scene::MeshData& mesh)
{
    ASSERT_EQ(mesh.positions.size(), 5u);
    EXPECT_EQ(mesh.positions[2], Vec3(1, 1, 0));
    EXPECT_EQ(mesh.positions[4], Vec3(0.5f, 2, -0.1f));
    ASSERT_EQ(mesh.normals.size(), 5u);
    EXPECT_EQ(mesh.normals[4], Vec3(0, 0, 1));
    ASSERT_EQ(mesh.uvs.size(), 5u);
    EXPECT_EQ(mesh.uvs[4], Vec2(0.5f, 1));
    EXPECT_EQ(mesh.triangles, (std::vector<uint32_t>{3, 2, 4}));
    // PLY goes around the quadrangle; the patch's order is (0,0), (1,0), (0,1), (1,1).
    EXPECT_EQ(mesh.quads, (std::vector<uint32_t>{0, 1, 3, 2}));
}

class BinaryWriter {
public:
    explicit BinaryWriter(bool big) : big_(big) {}
    template <class Value>
    void put(Value value)
    {
        char bytes[sizeof(Value)];
        std::memcpy(bytes, &value, sizeof(Value));
        if (big_) std::reverse(bytes, bytes + sizeof(Value));
        text.append(bytes, sizeof(Value));
    }
    std::string text;

private:
    bool big_;
};

std::string binary_mesh(bool big)
{
    std::string header(text_mesh, std::strstr(text_mesh, "0 0 0 255") - text_mesh);
    header.replace(header.find("ascii"), 5, big ? "binary_big_endian" : "binary_little_endian");
    BinaryWriter out(big);
    const float vertices[5][9] = {{0, 0, 0, 255, 0, 0, 1, 0, 0},
                                  {1, 0, 0, 255, 0, 0, 1, 1, 0},
                                  {1, 1, 0, 255, 0, 0, 1, 1, 1},
                                  {0, 1, 0, 255, 0, 0, 1, 0, 1},
                                  {0.5f, 2, -0.1f, 0, 0, 0, 1, 0.5f, 1}};
    for (const auto& v : vertices) {
        out.put(v[0]);
        out.put(double{v[1]});
        out.put(v[2]);
        out.put(static_cast<uint8_t>(v[3]));
        for (int i = 4; i < 9; ++i) out.put(v[i]);
    }
    out.put(int32_t{7});
    out.put(uint8_t{2});
    out.put(0.5f);
    out.put(0.25f);
    out.put(uint8_t{4});
    for (int32_t i : {0, 1, 2, 3, 0}) out.put(i);
    out.put(uint8_t{3});
    for (int32_t i : {3, 2, 4, 1}) out.put(i);
    return header + out.text;
}

TEST(Ply, ReadsText) { check(parse_ply(text_mesh, "mesh.ply")); }
TEST(Ply, ReadsLittleEndian) { check(parse_ply(binary_mesh(false), "mesh.ply")); }
TEST(Ply, ReadsBigEndian) { check(parse_ply(binary_mesh(true), "mesh.ply")); }

TEST(Ply, ReadsGzipFiles)
{
    const TempFolder folder;
    const auto path = folder / "mesh.ply.gz";
    const std::string content = binary_mesh(false);
    gzFile file = gzopen(path.c_str(), "wb");
    gzwrite(file, content.data(), static_cast<unsigned>(content.size()));
    gzclose(file);
    check(read_ply(path, {}));
}

// Each prefix of a mesh is damaged: it must give a UserError, never a crash or a mesh.
TEST(Ply, EveryTruncationIsAnError)
{
    for (const std::string& whole : {std::string(text_mesh), binary_mesh(false), binary_mesh(true)})
        for (size_t length = 0; length + 2 < whole.size(); ++length)
            EXPECT_THROW(parse_ply(whole.substr(0, length), "mesh.ply"), UserError) << length;
}

TEST(Ply, PartialNormalsAreNone)
{
    const auto mesh = parse_ply(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float "
        "nx\n"
        "element face 1\nproperty list uchar uint vertex_index\nend_header\n0 0 0 1\n1 0 0 1\n0 1 0 1\n3 0 1 2",
        "mesh.ply");
    EXPECT_TRUE(mesh.normals.empty());
    EXPECT_EQ(mesh.triangles.size(), 3u);
}

// A small file that expands a thousandfold is refused before memory runs out.
TEST(ReadFile, RefusesGzipBombs)
{
    const TempFolder folder;
    const auto path = folder / "bomb.gz";
    gzFile file = gzopen(path.c_str(), "wb9");
    const std::string zeros(1 << 20, '\0');
    for (int i = 0; i < 20; ++i) gzwrite(file, zeros.data(), static_cast<unsigned>(zeros.size()));
    gzclose(file);
    EXPECT_THROW(read_file(path, {}), UserError);
}

TEST(ReadFile, ShowsTextsOnOneLine)
{
    EXPECT_EQ(shown("a\nb\x7f"), "a?b?");
    EXPECT_EQ(shown("na\xc3\xafve"), "na\xc3\xafve");
    EXPECT_EQ(shown("\xff\x80z"), "??z");
    EXPECT_EQ(shown(std::string(1000, 'x')).size(), 123u);
}

}  // namespace
}  // namespace dapple
