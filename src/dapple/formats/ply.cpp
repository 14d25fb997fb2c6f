// One pass over the body through a cursor that hides text and byte order. A count is believed only after checking that
// the rest of the file could hold so many elements.
#include "dapple/formats/ply.h"

#include "dapple/formats/ply_header.h"
#include "dapple/formats/read_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>

namespace dapple {
namespace {

class BodyCursor {
public:
    BodyCursor(std::string_view content, const PlyHeader& header, const std::string& name)
        : cursor_(content.data() + header.body),
          end_(content.data() + content.size()),
          format_(header.format),
          line_(header.lines + 1),
          name_(name)
    {
    }

    bool ascii() const { return format_ == PlyFormat::ascii; }
    int64_t bytes_left() const { return end_ - cursor_; }

    double next(PlyType type) { return ascii() ? next_text() : next_binary(type); }

    void skip(PlyType type, int64_t count)
    {
        if (ascii()) {
            for (int64_t i = 0; i < count; ++i) next_text();
            return;
        }
        const int64_t bytes = count * size_of(type);
        if (bytes > bytes_left()) fail_truncated();
        cursor_ += bytes;
    }

    // Element of a file's messages: "face 12".
    void enter(std::string_view element, int64_t index)
    {
        element_ = element;
        index_ = index;
    }
    [[noreturn]] void fail(const std::string& message) const
    {
        throw UserError({name_, ascii() ? line_ : 0, 0}, fmt::format("{} {}: {}", shown(element_), index_, message));
    }

private:
    [[noreturn]] void fail_truncated() const { fail("the file ends here: it is truncated"); }

    double next_text()
    {
        while (cursor_ < end_ && (*cursor_ == ' ' || *cursor_ == '\n' || *cursor_ == '\t' || *cursor_ == '\r'))
            line_ += *cursor_++ == '\n';
        if (cursor_ == end_) fail_truncated();
        double value = 0.0;
        const auto [stop, error] = std::from_chars(cursor_ + (*cursor_ == '+'), end_, value);
        const bool ends = stop == end_ || *stop == ' ' || *stop == '\n' || *stop == '\t' || *stop == '\r';
        if (error == std::errc::invalid_argument || !ends) {
            const std::string_view rest(cursor_, static_cast<size_t>(end_ - cursor_));
            fail(fmt::format("expected a number, got '{}'", shown(rest.substr(0, rest.find_first_of(" \n\t\r")))));
        }
        cursor_ = stop;
        return value;
    }

    template <class Value>
    double read_as()
    {
        std::array<char, sizeof(Value)> bytes;
        std::memcpy(bytes.data(), cursor_, sizeof(Value));
        if (format_ == PlyFormat::big_endian) std::reverse(bytes.begin(), bytes.end());
        cursor_ += sizeof(Value);
        return static_cast<double>(std::bit_cast<Value>(bytes));
    }

    double next_binary(PlyType type)
    {
        static_assert(std::endian::native == std::endian::little);
        if (bytes_left() < size_of(type)) fail_truncated();
        switch (type) {
            case PlyType::int8: return read_as<int8_t>();
            case PlyType::uint8: return read_as<uint8_t>();
            case PlyType::int16: return read_as<int16_t>();
            case PlyType::uint16: return read_as<uint16_t>();
            case PlyType::int32: return read_as<int32_t>();
            case PlyType::uint32: return read_as<uint32_t>();
            case PlyType::float32: return read_as<float>();
            case PlyType::float64: break;
        }
        return read_as<double>();
    }

    const char* cursor_;
    const char* end_;
    PlyFormat format_;
    int line_;
    const std::string& name_;
    std::string_view element_;
    int64_t index_ = 0;
};

int64_t read_list_length(BodyCursor& cursor, const PlyProperty& property)
{
    const double length = cursor.next(property.count_type);
    if (!(length >= 0.0) || length != std::floor(length) || length > 4294967295.0)
        cursor.fail(fmt::format("{} is not the length of a list", length));
    return static_cast<int64_t>(length);
}

void skip_property(BodyCursor& cursor, const PlyProperty& property)
{
    cursor.skip(property.type, property.list ? read_list_length(cursor, property) : 1);
}

// The least bytes one element can take.
int64_t least_size(const PlyElement& element, bool ascii)
{
    int64_t size = 0;
    for (const PlyProperty& property : element.properties)
        size += ascii ? 2 : size_of(property.list ? property.count_type : property.type);
    return size;
}

void check_count(const PlyElement& element, const BodyCursor& cursor, const std::string& name)
{
    const int64_t size = least_size(element, cursor.ascii());
    // The last number of a text needs no space after it.
    const int64_t room = size == 0 ? 0 : (cursor.bytes_left() + cursor.ascii()) / size;
    if (size == 0 && element.count > 0)
        throw UserError({name, element.line, 0}, fmt::format("element '{}' has no properties", shown(element.name)));
    if (element.count > room)
        throw UserError({name, element.line, 0},
                        fmt::format("{} elements '{}' are promised, but the file has room for {}: it is truncated",
                                    element.count, shown(element.name), room));
    if (element.count > std::numeric_limits<uint32_t>::max() / 4)
        throw UserError({name, element.line, 0}, fmt::format("{} elements are too many", element.count));
}

// Where a property of a vertex goes: 0-2 position, 3-5 normal, 6-7 texture coordinates; -1: nowhere.
int vertex_slot(const PlyProperty& property)
{
    constexpr std::string_view names[][4] = {{"x"},
                                             {"y"},
                                             {"z"},
                                             {"nx"},
                                             {"ny"},
                                             {"nz"},
                                             {"u", "s", "texture_u", "texture_s"},
                                             {"v", "t", "texture_v", "texture_t"}};
    if (property.list) return -1;
    for (int slot = 0; slot < 8; ++slot)
        for (std::string_view name : names[slot])
            if (!name.empty() && name == property.name) return slot;
    return -1;
}

void read_vertices(BodyCursor& cursor, const PlyElement& element, const std::string& name, scene::MeshData& mesh)
{
    std::vector<int> slots;
    std::array<bool, 8> present{};
    for (const PlyProperty& property : element.properties) {
        slots.push_back(vertex_slot(property));
        if (slots.back() >= 0) present[slots.back()] = true;
    }
    if (!present[0] || !present[1] || !present[2])
        throw UserError({name, element.line, 0}, "the vertices lack one of 'x', 'y' and 'z'");
    const bool normals = present[3] && present[4] && present[5];
    const bool uvs = present[6] && present[7];
    mesh.positions.reserve(static_cast<size_t>(element.count));

    for (int64_t i = 0; i < element.count; ++i) {
        cursor.enter("vertex", i);
        std::array<float, 8> v{};
        for (size_t p = 0; p < slots.size(); ++p) {
            if (slots[p] < 0)
                skip_property(cursor, element.properties[p]);
            else
                v[slots[p]] = static_cast<float>(cursor.next(element.properties[p].type));
        }
        for (float value : v)
            if (!std::isfinite(value)) cursor.fail("a coordinate is not a finite number");
        mesh.positions.emplace_back(v[0], v[1], v[2]);
        if (normals) mesh.normals.emplace_back(v[3], v[4], v[5]);
        if (uvs) mesh.uvs.emplace_back(v[6], v[7]);
    }
}

uint32_t read_index(BodyCursor& cursor, const PlyProperty& property, size_t vertices)
{
    const double value = cursor.next(property.type);
    if (value >= 0.0 && value < static_cast<double>(vertices) && value == std::floor(value))
        return static_cast<uint32_t>(value);
    std::string hint;
    if (!cursor.ascii() && size_of(property.type) == 4 && std::fabs(value) < 4294967296.0) {
        const auto swapped = __builtin_bswap32(static_cast<uint32_t>(static_cast<int64_t>(value)));
        if (swapped < vertices) hint = " (does the header name the wrong byte order?)";
    }
    cursor.fail(fmt::format("index {} is out of range, there are {} vertices{}", value, vertices, hint));
}

void read_face(BodyCursor& cursor, const PlyProperty& property, scene::MeshData& mesh)
{
    const int64_t corners = read_list_length(cursor, property);
    if (corners != 3 && corners != 4)
        cursor.fail(fmt::format("it has {} corners; only 3 and 4 are supported", corners));
    std::array<uint32_t, 4> face{};
    for (int64_t i = 0; i < corners; ++i) face[i] = read_index(cursor, property, mesh.positions.size());
    if (corners == 3)
        mesh.triangles.insert(mesh.triangles.end(), face.begin(), face.begin() + 3);
    else  // PLY goes around, a patch is p00, p10, p01, p11
        mesh.quads.insert(mesh.quads.end(), {face[0], face[1], face[3], face[2]});
}

void read_faces(BodyCursor& cursor, const PlyElement& element, const std::string& name, scene::MeshData& mesh)
{
    if (mesh.positions.empty()) throw UserError({name, element.line, 0}, "the faces stand before any vertices");
    int indices = -1;
    for (size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (property.list && (property.name == "vertex_indices" || property.name == "vertex_index"))
            indices = static_cast<int>(p);
    }
    if (indices < 0) throw UserError({name, element.line, 0}, "the faces lack a list 'vertex_indices'");
    for (int64_t i = 0; i < element.count; ++i) {
        cursor.enter("face", i);
        for (size_t p = 0; p < element.properties.size(); ++p) {
            if (static_cast<int>(p) == indices)
                read_face(cursor, element.properties[p], mesh);
            else
                skip_property(cursor, element.properties[p]);
        }
    }
}

}  // namespace

scene::MeshData parse_ply(const std::string& content, const std::string& name)
{
    const PlyHeader header = parse_ply_header(content, name);
    BodyCursor cursor(content, header, name);
    scene::MeshData mesh;
    for (const PlyElement& element : header.elements) {
        check_count(element, cursor, name);
        if (element.name == "vertex") {
            if (!mesh.positions.empty()) throw UserError({name, element.line, 0}, "element 'vertex' stands here again");
            read_vertices(cursor, element, name, mesh);
        } else if (element.name == "face") {
            read_faces(cursor, element, name, mesh);
        } else {
            for (int64_t i = 0; i < element.count; ++i) {
                cursor.enter(element.name, i);
                for (const PlyProperty& property : element.properties) skip_property(cursor, property);
            }
        }
    }
    if (mesh.triangles.empty() && mesh.quads.empty()) throw UserError({name, 0, 0}, "the file has no faces");
    return mesh;
}

scene::MeshData read_ply(const std::filesystem::path& path, const SourceLocation& where)
{
    return parse_ply(read_file(path, where), path.string());
}

}  // namespace dapple
