// Pixels of an image at texture coordinates (s, t): s to the right, t upwards, pixel centres at half integers. The taps
// and weights are found once and serve all channels.
#pragma once

#include "dapple/materials/texture.h"

namespace dapple {

class ImageLookup {
public:
    ImageLookup(const Image& image, const Vec2& st, ImageFilter filter, ImageWrap wrap) : image_(image)
    {
        // Coordinates that are not finite or too large to have fractional pixels read the first column or row.
        const auto in_pixels = [](float x, int n) {
            x *= static_cast<float>(n);
            return std::fabs(x) < 1e8f ? x : 0.0f;
        };
        const float x = in_pixels(st.x, image.width);
        const float y = in_pixels(1.0f - st.y, image.height);
        if (filter == ImageFilter::nearest) {
            add(static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y)), 1.0f, wrap);
            return;
        }
        const float left = std::floor(x - 0.5f), top = std::floor(y - 0.5f);
        const float dx = x - 0.5f - left, dy = y - 0.5f - top;
        const int ix = static_cast<int>(left), iy = static_cast<int>(top);
        add(ix, iy, (1.0f - dx) * (1.0f - dy), wrap);
        add(ix + 1, iy, dx * (1.0f - dy), wrap);
        add(ix, iy + 1, (1.0f - dx) * dy, wrap);
        add(ix + 1, iy + 1, dx * dy, wrap);
    }

    float channel(int c) const
    {
        float sum = 0.0f;
        for (int i = 0; i < taps_; ++i) sum += weight_[i] * image_.at(x_[i], y_[i], c);
        return sum;
    }

private:
    // False if the pixel is outside and outside is black.
    static bool wrap_index(int& i, int n, ImageWrap wrap)
    {
        if (i >= 0 && i < n) return true;
        if (wrap == ImageWrap::black) return false;
        if (wrap == ImageWrap::clamp) {
            i = std::clamp(i, 0, n - 1);
        } else {
            i %= n;
            if (i < 0) i += n;
        }
        return true;
    }

    void add(int x, int y, float weight, ImageWrap wrap)
    {
        if (!wrap_index(x, image_.width, wrap) || !wrap_index(y, image_.height, wrap)) return;
        x_[taps_] = x;
        y_[taps_] = y;
        weight_[taps_++] = weight;
    }

    const Image& image_;
    int taps_ = 0;
    int x_[4], y_[4];
    float weight_[4];
};

}  // namespace dapple
