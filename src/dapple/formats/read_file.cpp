#include "dapple/formats/read_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

namespace dapple {
namespace {

// Text rarely shrinks more than thirtyfold; a file that expands further than this is an attack or an accident.
constexpr size_t largest_expansion = 200;
constexpr size_t always_allowed = size_t{16} << 20;

// True when every sequence of bytes above 127 is one lead byte with the continuation bytes it announces.
bool is_utf8(std::string_view text)
{
    int continuations = 0;
    for (char c : text) {
        const int leading_ones = std::countl_one(static_cast<unsigned char>(c));
        if ((leading_ones == 1) != (continuations > 0) || leading_ones > 4) return false;
        continuations = leading_ones == 1 ? continuations - 1 : std::max(0, leading_ones - 1);
    }
    return continuations == 0;
}

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

struct InflateStream {
    z_stream stream{};
    bool ready = inflateInit2(&stream, 16 + MAX_WBITS) == Z_OK;
    ~InflateStream() { inflateEnd(&stream); }
};

std::string expand(const std::string& packed, const std::string& name, const SourceLocation& where)
{
    InflateStream inflater;
    if (!inflater.ready) throw UserError(where, fmt::format("cannot expand '{}'", shown(name)));
    z_stream& z = inflater.stream;
    const size_t limit = std::max(always_allowed, packed.size() * largest_expansion);

    std::string text;
    size_t read = 0;
    while (true) {
        if (z.avail_in == 0) {
            const size_t chunk = std::min(packed.size() - read, size_t{1} << 30);
            z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + read));
            z.avail_in = static_cast<uInt>(chunk);
            read += chunk;
        }
        const size_t before = text.size();
        const size_t room = std::clamp(before, size_t{1} << 16, size_t{1} << 26);
        text.resize(before + room);
        z.next_out = reinterpret_cast<Bytef*>(text.data() + before);
        z.avail_out = static_cast<uInt>(room);
        const int status = inflate(&z, Z_NO_FLUSH);
        text.resize(before + room - z.avail_out);
        if (text.size() > limit)
            throw UserError(where,
                            fmt::format("'{}' expands to more than {} times its size", shown(name), largest_expansion));
        if (status == Z_STREAM_END) {
            if (z.avail_in == 0 && read == packed.size()) return text;
            if (inflateReset(&z) != Z_OK) break;  // gzip files may be joined end to end
        } else if (status != Z_OK || (z.avail_in == 0 && read == packed.size() && z.avail_out > 0)) {
            break;
        }
    }
    throw UserError(where, fmt::format("'{}' is a damaged or truncated gzip file", shown(name)));
}

}  // namespace

std::string shown(std::string_view text)
{
    constexpr size_t longest = 120;
    const bool cut = text.size() > longest;
    std::string result(text.substr(0, longest));
    const bool readable = is_utf8(result);
    for (char& c : result) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 32 || byte == 127 || (byte > 127 && !readable)) c = '?';
    }
    return cut ? result + "..." : result;
}

std::string read_file(const std::filesystem::path& path, const SourceLocation& where)
{
    const std::string name = path.string();
    const auto fail = [&](const char* why) -> UserError {
        return UserError(where, fmt::format("cannot open '{}': {}", shown(name), why));
    };
    if (name.find('\0') != std::string::npos) throw fail("the name holds a zero byte");
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) throw fail("no such file");
    if (!std::filesystem::is_regular_file(status)) throw fail("not a regular file");

    const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(name.c_str(), "rb"));
    if (!file) throw fail(std::strerror(errno));
    const auto size = std::filesystem::file_size(path, error);
    if (error) throw fail("its size is unknown");
    std::string content(static_cast<size_t>(size), '\0');
    if (std::fread(content.data(), 1, content.size(), file.get()) != content.size())
        throw fail("it cannot be read whole");

    const bool packed = content.size() >= 2 && content[0] == '\x1f' && content[1] == '\x8b';
    return packed ? expand(content, name, where) : content;
}

}  // namespace dapple
