// Two words, mixed in turn with splitmix64's finaliser over blocks of 16 bytes; the length goes in at the end.
#include "dapple/render/content_hash.h"

#include "dapple/math/hash.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>

namespace dapple {

void ContentHash::mix(const unsigned char* block)
{
    uint64_t low = 0, high = 0;
    std::memcpy(&low, block, sizeof low);
    std::memcpy(&high, block + sizeof low, sizeof high);
    a_ = mix64(a_ ^ low);
    b_ = mix64(b_ ^ high ^ std::rotl(a_, 23));
}

void ContentHash::add(const void* data, size_t bytes)
{
    const auto* next = static_cast<const unsigned char*>(data);
    const size_t waiting = length_ % rest_.size();
    length_ += bytes;
    if (waiting > 0) {
        const size_t taken = std::min(bytes, rest_.size() - waiting);
        std::memcpy(rest_.data() + waiting, next, taken);
        if (waiting + taken < rest_.size()) return;
        mix(rest_.data());
        next += taken;
        bytes -= taken;
    }
    for (; bytes >= rest_.size(); bytes -= rest_.size(), next += rest_.size()) mix(next);
    if (bytes > 0) std::memcpy(rest_.data(), next, bytes);
}

std::array<uint64_t, 2> ContentHash::value() const
{
    ContentHash last = *this;
    const size_t waiting = length_ % rest_.size();
    if (waiting > 0) {
        std::fill(last.rest_.begin() + static_cast<std::ptrdiff_t>(waiting), last.rest_.end(), 0);
        last.mix(last.rest_.data());
    }
    const uint64_t a = mix64(last.a_ ^ length_);
    return {a, mix64(last.b_ ^ a)};
}

std::string ContentHash::text() const
{
    const auto words = value();
    return fmt::format("{:016x}{:016x}", words[0], words[1]);
}

std::vector<HashedFile> hash_files(const std::vector<std::filesystem::path>& files)
{
    std::vector<HashedFile> hashed;
    std::vector<char> buffer(size_t{1} << 20);
    for (const std::filesystem::path& path : files) {
        std::ifstream in(path, std::ios::binary);
        std::error_code error;
        if (!in || !std::filesystem::is_regular_file(path, error)) {
            hashed.emplace_back(path.string(), "missing");
            continue;
        }
        ContentHash hash;
        while (in.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) || in.gcount() > 0)
            hash.add(buffer.data(), static_cast<size_t>(in.gcount()));
        hashed.emplace_back(path.string(), hash.text());
    }
    return hashed;
}

}  // namespace dapple
