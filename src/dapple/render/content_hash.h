// A 128-bit hash of bytes: tells whether files are the same ones, and whether one was cut or damaged. Against
// accidents, not against people who want two files to look the same.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace dapple {

// Bytes may come in pieces of any size; the hash does not depend on how they were cut. About 3 GB/s.
class ContentHash {
public:
    void add(const void* data, size_t bytes);
    std::array<uint64_t, 2> value() const;
    // 32 hexadecimal digits.
    std::string text() const;

private:
    void mix(const unsigned char* block);

    uint64_t a_ = 0x6a09e667f3bcc908, b_ = 0xbb67ae8584caa73b;
    uint64_t length_ = 0;
    std::array<unsigned char, 16> rest_{};
};

// A file of a scene and the hash of its bytes; the hash of a file that cannot be read is "missing".
using HashedFile = std::pair<std::string, std::string>;
std::vector<HashedFile> hash_files(const std::vector<std::filesystem::path>& files);

}  // namespace dapple
