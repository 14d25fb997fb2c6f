#include "dapple/image/zip_time.h"

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <ctime>  // clock_gettime
#include <vector>

namespace dapple {
namespace {

constexpr int block_rows = 16;

double thread_seconds()
{
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Row by row, in each channel by channel.
void gather_block(const Image& image, int first, int rows, std::vector<uint8_t>& bytes)
{
    bytes.resize(sizeof(float) * static_cast<size_t>(rows) * static_cast<size_t>(image.width) *
                 static_cast<size_t>(image.channels));
    uint8_t* out = bytes.data();
    for (int y = first; y < first + rows; ++y)
        for (int c = 0; c < image.channels; ++c)
            for (int x = 0; x < image.width; ++x, out += sizeof(float)) {
                const float value = image.at(x, y, c);
                std::memcpy(out, &value, sizeof(float));
            }
}

// Bytes in even places before those in odd ones; then what each adds to the one before it.
void predict(const std::vector<uint8_t>& bytes, std::vector<uint8_t>& differences)
{
    const size_t half = (bytes.size() + 1) / 2;
    differences.resize(bytes.size());
    for (size_t i = 0; i < bytes.size(); ++i) differences[i / 2 + (i % 2) * half] = bytes[i];
    for (size_t i = differences.size(); i-- > 1;)
        differences[i] = static_cast<uint8_t>(differences[i] - differences[i - 1] + 128);
}

}  // namespace

double zip_seconds(const Image& image)
{
    std::vector<uint8_t> bytes, differences, compressed;
    const double start = thread_seconds();
    for (int y = 0; y < image.height; y += block_rows) {
        gather_block(image, y, std::min(block_rows, image.height - y), bytes);
        predict(bytes, differences);
        uLongf size = compressBound(static_cast<uLong>(differences.size()));
        compressed.resize(size);
        compress2(compressed.data(), &size, differences.data(), static_cast<uLong>(differences.size()), exr_zip_level);
    }
    return thread_seconds() - start;
}

}  // namespace dapple
