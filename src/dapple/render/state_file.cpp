// Errors while writing carry the errno of the first write that failed.
#include "dapple/render/state_file.h"

#include "dapple/base/error.h"
#include "dapple/render/content_hash.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <streambuf>

namespace dapple {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view magic =
    "\x89"
    "DAPPLE\n";
constexpr size_t kind_length = 8;
constexpr size_t head_bytes = magic.size() + kind_length + sizeof(uint64_t);
constexpr size_t hash_bytes = 2 * sizeof(uint64_t);
constexpr size_t tail_bytes = 2 * sizeof(uint64_t) + hash_bytes;

[[noreturn]] void fail(const std::string& path, const std::string& what)
{
    throw UserError(fmt::format("'{}' {}", path, what));
}

std::string padded_kind(std::string kind)
{
    kind.resize(kind_length, ' ');
    return kind;
}

// A descriptor that is closed, and its file removed, unless told otherwise.
class NewFile {
public:
    explicit NewFile(std::string path) : path_(std::move(path))
    {
        descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    }
    ~NewFile()
    {
        if (descriptor_ >= 0) ::close(descriptor_);
        if (descriptor_ >= 0 && !keep_) ::unlink(path_.c_str());
    }
    NewFile(const NewFile&) = delete;
    NewFile& operator=(const NewFile&) = delete;
    int descriptor() const { return descriptor_; }
    void keep() { keep_ = true; }

private:
    std::string path_;
    int descriptor_ = -1;
    bool keep_ = false;
};

// Bytes to a descriptor, hashed on the way. After the first error nothing more is written; `error` is its errno.
class HashingOutput final : public std::streambuf {
public:
    explicit HashingOutput(int descriptor) : descriptor_(descriptor), buffer_(size_t{1} << 20)
    {
        setp(buffer_.data(), buffer_.data() + buffer_.size());
    }
    int error() const { return error_; }
    uint64_t written() const { return bytes_; }
    bool flush() { return sync() == 0; }
    const ContentHash& hash() const { return hash_; }

protected:
    int_type overflow(int_type c) override
    {
        if (sync() != 0) return traits_type::eof();
        if (c != traits_type::eof()) sputc(traits_type::to_char_type(c));
        return traits_type::not_eof(c);
    }
    std::streamsize xsputn(const char* data, std::streamsize count) override
    {
        if (count <= 0) return 0;
        if (count < epptr() - pptr()) {
            std::memcpy(pptr(), data, static_cast<size_t>(count));
            pbump(static_cast<int>(count));
            return count;
        }
        return sync() == 0 && put(data, static_cast<size_t>(count)) ? count : 0;
    }
    int sync() override
    {
        const bool done = put(pbase(), static_cast<size_t>(pptr() - pbase()));
        setp(buffer_.data(), buffer_.data() + buffer_.size());
        return done ? 0 : -1;
    }

private:
    bool put(const char* data, size_t count)
    {
        if (error_ != 0) return false;
        hash_.add(data, count);
        bytes_ += count;
        while (count > 0) {
            const ssize_t written = ::write(descriptor_, data, count);
            if (written < 0 && errno == EINTR) continue;
            if (written < 0) {
                error_ = errno;
                return false;
            }
            data += written;
            count -= static_cast<size_t>(written);
        }
        return true;
    }

    int descriptor_;
    std::vector<char> buffer_;
    ContentHash hash_;
    uint64_t bytes_ = 0;
    int error_ = 0;
};

void write_word(std::ostream& out, uint64_t word) { out.write(reinterpret_cast<const char*>(&word), sizeof word); }

uint64_t read_word(std::istream& in)
{
    uint64_t word = 0;
    in.read(reinterpret_cast<char*>(&word), sizeof word);
    return word;
}

struct Layout {
    uint64_t fields = 0, body = 0;
};

// Opens the file behind its head, and checks that it is all there.
std::ifstream open_state(const std::string& path, const std::string& kind, Layout& layout)
{
    std::error_code error;
    if (!fs::exists(path, error)) fail(path, "cannot be read: no such file");
    std::ifstream in(path, std::ios::binary);
    if (!in || !fs::is_regular_file(path, error)) fail(path, "cannot be read: not a readable file");
    std::string head(magic.size() + kind_length, '\0');
    in.read(head.data(), static_cast<std::streamsize>(head.size()));
    if (!in || head.substr(0, magic.size()) != magic) fail(path, "is no .dapple file");
    const std::string found = head.substr(magic.size());
    if (found != padded_kind(kind)) fail(path, fmt::format("is of kind '{}', not '{}'", found, kind));
    const uint64_t format = read_word(in);
    if (in && format != state_format)
        fail(path, fmt::format("has format {}; this program reads format {}", format, state_format));
    const uint64_t size = fs::file_size(path, error);
    if (error || size < head_bytes + tail_bytes) fail(path, "is cut short");
    in.seekg(static_cast<std::streamoff>(size - tail_bytes));
    layout.fields = read_word(in);
    layout.body = read_word(in);
    if (!in || layout.fields > size || layout.body > size ||
        size != head_bytes + layout.fields + layout.body + tail_bytes)
        fail(path, "is cut short or damaged: its length is not what its end says");
    in.seekg(static_cast<std::streamoff>(head_bytes));
    return in;
}

void check_hash(const std::string& path)
{
    std::ifstream in(path, std::ios::binary);
    std::error_code error;
    uint64_t left = fs::file_size(path, error) - hash_bytes;
    ContentHash hash;
    std::vector<char> buffer(size_t{1} << 20);
    while (left > 0 && in) {
        const uint64_t piece = std::min<uint64_t>(left, buffer.size());
        in.read(buffer.data(), static_cast<std::streamsize>(piece));
        hash.add(buffer.data(), static_cast<size_t>(in.gcount()));
        left -= piece;
    }
    const std::array<uint64_t, 2> stored = {read_word(in), read_word(in)};
    if (!in || stored != hash.value()) fail(path, "is damaged: its checksum does not hold");
}

void sync_folder_of(const std::string& path)
{
    const std::string folder = fs::path(path).parent_path().string();
    const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return;
    ::fsync(descriptor);  // some file systems cannot; the file itself is whole by now
    ::close(descriptor);
}

}  // namespace

void write_state_file(const std::string& path, const std::string& kind, const StateFields& fields,
                      const std::function<void(std::ostream&)>& write_body)
{
    const auto cannot = [&](int cause) { fail(path, fmt::format("cannot be written: {}", std::strerror(cause))); };
    const std::string place = fmt::format("{}.new-{}", path, ::getpid());
    NewFile file(place);
    if (file.descriptor() < 0) cannot(errno);

    std::string text;
    for (const auto& [key, value] : fields) text.append(key).append(1, '\0').append(value).append(1, '\0');
    HashingOutput bytes(file.descriptor());
    std::ostream out(&bytes);
    out << magic << padded_kind(kind);
    write_word(out, state_format);
    out << text;
    bytes.flush();
    const uint64_t before_body = bytes.written();
    write_body(out);
    bytes.flush();
    const uint64_t body = bytes.written() - before_body;
    write_word(out, text.size());
    write_word(out, body);
    bytes.flush();
    for (const uint64_t word : bytes.hash().value()) write_word(out, word);
    if (!bytes.flush() || !out) cannot(bytes.error());
    if (::fsync(file.descriptor()) != 0) cannot(errno);
    if (::rename(place.c_str(), path.c_str()) != 0) cannot(errno);
    file.keep();
    sync_folder_of(path);
}

StateFields read_state_fields(const std::string& path, const std::string& kind)
{
    Layout layout;
    std::ifstream in = open_state(path, kind, layout);
    check_hash(path);
    std::string text(layout.fields, '\0');
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    StateFields fields;
    for (size_t at = 0; at < text.size();) {
        const size_t key_end = text.find('\0', at);
        const size_t end = key_end == std::string::npos ? std::string::npos : text.find('\0', key_end + 1);
        if (end == std::string::npos) fail(path, "is damaged: a field has no end");
        fields.emplace_back(text.substr(at, key_end - at), text.substr(key_end + 1, end - key_end - 1));
        at = end + 1;
    }
    return fields;
}

void read_state_body(const std::string& path, const std::string& kind,
                     const std::function<void(std::istream&)>& read_body)
{
    Layout layout;
    std::ifstream in = open_state(path, kind, layout);
    in.seekg(static_cast<std::streamoff>(layout.fields), std::ios::cur);
    read_body(in);
}

}  // namespace dapple
