// The header of a PLY file.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dapple {

enum class PlyFormat : uint8_t { ascii, little_endian, big_endian };
enum class PlyType : uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

// Bytes of one value.
constexpr int size_of(PlyType type)
{
    constexpr int sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[static_cast<int>(type)];
}

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::float32;      // of the values
    PlyType count_type = PlyType::uint8;  // of a list's length
    bool list = false;
};

struct PlyElement {
    std::string name;
    int64_t count = 0;
    std::vector<PlyProperty> properties;
    int line = 0;  // of its declaration
};

struct PlyHeader {
    PlyFormat format = PlyFormat::ascii;
    std::vector<PlyElement> elements;
    size_t body = 0;  // offset of the first byte after the header
    int lines = 0;    // of the header
};

// Throws UserError with the line when the header is out of form.
PlyHeader parse_ply_header(std::string_view content, const std::string& name);

}  // namespace dapple
