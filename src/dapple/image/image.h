// Pixel arrays, and image files in and out (OpenImageIO is hidden in image_file.cpp).
#pragma once

#include "dapple/math/vec.h"

#include <cstdint>
#include <string>
#include <vector>

namespace dapple {

// Float pixels, row by row from the top left, channels interleaved.
struct Image {
    int width = 0;
    int height = 0;
    int channels = 0;
    std::vector<float> pixels;

    Image() = default;
    Image(int w, int h, int c) : width(w), height(h), channels(c), pixels(size_t(w) * h * c, 0.0f) {}

    float at(int x, int y, int c) const { return pixels[(size_t(y) * width + x) * channels + c]; }
    float& at(int x, int y, int c) { return pixels[(size_t(y) * width + x) * channels + c]; }
    bool empty() const { return pixels.empty(); }
};

}  // namespace dapple
