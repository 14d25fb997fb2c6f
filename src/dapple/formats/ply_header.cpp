#include "dapple/formats/ply_header.h"

#include "dapple/base/error.h"
#include "dapple/formats/pbrt_context.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>

namespace dapple {
namespace {

struct TypeName {
    std::string_view name;
    PlyType type;
};
constexpr TypeName type_names[] = {
    {"char", PlyType::int8},       {"int8", PlyType::int8},       {"uchar", PlyType::uint8},
    {"uint8", PlyType::uint8},     {"short", PlyType::int16},     {"int16", PlyType::int16},
    {"ushort", PlyType::uint16},   {"uint16", PlyType::uint16},   {"int", PlyType::int32},
    {"int32", PlyType::int32},     {"uint", PlyType::uint32},     {"uint32", PlyType::uint32},
    {"float", PlyType::float32},   {"float32", PlyType::float32}, {"double", PlyType::float64},
    {"float64", PlyType::float64},
};
constexpr std::string_view formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
constexpr std::string_view keywords[] = {"format", "element", "property", "comment", "obj_info", "end_header"};

std::vector<std::string_view> split(std::string_view line)
{
    std::vector<std::string_view> words;
    constexpr std::string_view spaces = " \t\r";
    for (size_t start = line.find_first_not_of(spaces); start != line.npos;) {
        const size_t end = std::min(line.find_first_of(spaces, start), line.size());
        words.push_back(line.substr(start, end - start));
        start = line.find_first_not_of(spaces, end);
    }
    return words;
}

class HeaderParser {
public:
    HeaderParser(std::string_view content, const std::string& name) : content_(content), name_(name) {}

    PlyHeader parse()
    {
        if (next_line() != std::vector<std::string_view>{"ply"}) fail("not a PLY file: its first line is not 'ply'");
        bool has_format = false;
        while (true) {
            const auto words = next_line();
            if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
            if (words[0] == "end_header") break;
            if (words[0] == "format") {
                read_format(words);
                has_format = true;
            } else if (words[0] == "element") {
                read_element(words);
            } else if (words[0] == "property") {
                read_property(words);
            } else {
                fail(fmt::format("unknown header word '{}'{}", shown(words[0]), suggest(words[0], keywords)));
            }
        }
        if (!has_format) fail("the header names no format");
        header_.body = cursor_;
        header_.lines = line_;
        return std::move(header_);
    }

private:
    [[noreturn]] void fail(const std::string& message) const { throw UserError({name_, line_, 0}, message); }

    std::vector<std::string_view> next_line()
    {
        ++line_;
        const size_t end = content_.find('\n', cursor_);
        if (end == content_.npos) fail("the file ends within the header");
        const std::string_view line = content_.substr(cursor_, end - cursor_);
        cursor_ = end + 1;
        return split(line);
    }

    PlyType type(std::string_view word) const
    {
        std::vector<std::string_view> known;
        for (const TypeName& entry : type_names) {
            if (entry.name == word) return entry.type;
            known.push_back(entry.name);
        }
        fail(fmt::format("unknown type '{}'{}", shown(word), suggest(word, known)));
    }

    void read_format(const std::vector<std::string_view>& words)
    {
        if (words.size() != 3) fail("expected 'format NAME 1.0'");
        for (size_t i = 0; i < std::size(formats); ++i)
            if (words[1] == formats[i]) {
                header_.format = static_cast<PlyFormat>(i);
                return;
            }
        fail(fmt::format("unknown format '{}'{}", shown(words[1]), suggest(words[1], formats)));
    }

    void read_element(const std::vector<std::string_view>& words)
    {
        if (words.size() != 3) fail("expected 'element NAME COUNT'");
        PlyElement element;
        element.name = words[1];
        element.line = line_;
        const char* end = words[2].data() + words[2].size();
        const auto result = std::from_chars(words[2].data(), end, element.count);
        if (result.ec != std::errc{} || result.ptr != end || element.count < 0)
            fail(fmt::format("'{}' is not a count of elements", shown(words[2])));
        header_.elements.push_back(std::move(element));
    }

    void read_property(const std::vector<std::string_view>& words)
    {
        if (header_.elements.empty()) fail("a property stands before any element");
        PlyProperty property;
        property.list = words.size() > 1 && words[1] == "list";
        if (words.size() != (property.list ? 5u : 3u))
            fail("expected 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
        if (property.list) {
            property.count_type = type(words[2]);
            if (property.count_type >= PlyType::float32) fail("the length of a list must be of an integer type");
        }
        property.type = type(words[words.size() - 2]);
        property.name = words.back();
        header_.elements.back().properties.push_back(std::move(property));
    }

    std::string_view content_;
    const std::string& name_;
    size_t cursor_ = 0;
    int line_ = 0;
    PlyHeader header_;
};

}  // namespace

PlyHeader parse_ply_header(std::string_view content, const std::string& name)
{
    return HeaderParser(content, name).parse();
}

}  // namespace dapple
