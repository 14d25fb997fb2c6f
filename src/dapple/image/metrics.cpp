// Sums run in pixel order in double precision, so that results do not depend on the machine's thread count.
#include "dapple/image/metrics.h"

#include "dapple/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dapple {

namespace {

// Colours outside of the gamut are negative, and may be as large.
float limited(float value, const CompareOptions& options) { return std::clamp(value, -options.clamp, options.clamp); }

void check_alike(const Image& a, const Image& b)
{
    if (a.width != b.width || a.height != b.height || a.channels != b.channels)
        throw UserError(fmt::format("images of {} x {} x {} and {} x {} x {} cannot be compared", a.width, a.height,
                                    a.channels, b.width, b.height, b.channels));
    if (a.empty()) throw UserError("images without pixels cannot be compared");
}

bool pixel_is_finite(const Image& image, size_t pixel)
{
    const float* values = &image.pixels[pixel * image.channels];
    return std::all_of(values, values + image.channels, [](float v) { return std::isfinite(v); });
}

// Of the channel means of a pixel that is finite in both images.
double mean_difference(const Image& test, const Image& reference, size_t pixel, const CompareOptions& options)
{
    double difference = 0.0;
    for (int c = 0; c < test.channels; ++c) {
        const size_t i = pixel * test.channels + c;
        difference += double(limited(test.pixels[i], options)) - limited(reference.pixels[i], options);
    }
    return difference / test.channels;
}

// Calls body(block_x, block_y, x, y) for every pixel, row by row.
template <class Body>
void for_each_in_blocks(const Image& image, int block_size, const Body& body)
{
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) body(x / block_size, y / block_size, x, y);
}

int block_area(const Image& image, int block_size, int bx, int by)
{
    return std::min(block_size, image.width - bx * block_size) * std::min(block_size, image.height - by * block_size);
}

}  // namespace

ImageComparison compare_images(const Image& test, const Image& reference, const CompareOptions& options)
{
    check_alike(test, reference);
    ImageComparison result;
    result.mean_test.resize(test.channels);
    result.mean_reference.resize(test.channels);
    size_t pixels = 0;
    for (size_t pixel = 0; pixel < size_t(test.width) * test.height; ++pixel) {
        if (!pixel_is_finite(test, pixel) || !pixel_is_finite(reference, pixel)) {
            ++result.non_finite;
            continue;
        }
        ++pixels;
        for (int c = 0; c < test.channels; ++c) {
            const size_t i = pixel * test.channels + c;
            const double t = limited(test.pixels[i], options);
            const double r = limited(reference.pixels[i], options);
            const double error = t - r;
            result.mean_test[c] += t;
            result.mean_reference[c] += r;
            result.mse += error * error;
            result.relative_mse += error * error / (r * r + 0.01);
            result.mae += std::fabs(error);
            result.max_error = std::max(result.max_error, std::fabs(error));
        }
    }
    const double per_pixel = pixels > 0 ? 1.0 / static_cast<double>(pixels) : std::nan("");
    for (int c = 0; c < test.channels; ++c) {
        result.mean_test[c] *= per_pixel;
        result.mean_reference[c] *= per_pixel;
        result.mean_ratio.push_back(result.mean_reference[c] != 0.0 ? result.mean_test[c] / result.mean_reference[c]
                                                                    : std::nan(""));
    }
    for (double* value : {&result.mse, &result.relative_mse, &result.mae}) *value *= per_pixel / test.channels;
    return result;
}

Image absolute_difference(const Image& test, const Image& reference, const CompareOptions& options)
{
    check_alike(test, reference);
    Image result(test.width, test.height, test.channels);
    for (size_t i = 0; i < result.pixels.size(); ++i)
        result.pixels[i] = std::fabs(limited(test.pixels[i], options) - limited(reference.pixels[i], options));
    return result;
}

float difference_scale(const Image& test, const Image& reference, const CompareOptions& options)
{
    check_alike(test, reference);
    std::vector<double> differences;
    for (size_t pixel = 0; pixel < size_t(test.width) * test.height; ++pixel)
        if (pixel_is_finite(test, pixel) && pixel_is_finite(reference, pixel))
            differences.push_back(std::fabs(mean_difference(test, reference, pixel, options)));
    std::sort(differences.begin(), differences.end());
    if (differences.empty() || differences.back() <= 0.0) return 0.1f;
    const double most = differences[static_cast<size_t>(0.99 * static_cast<double>(differences.size() - 1))];
    const double covered = most > 0.0 ? most : differences.back();
    const double power = std::pow(10.0, std::floor(std::log10(covered)));
    const double digit = covered / power;
    return static_cast<float>(power * (digit <= 1.0 ? 1.0 : digit <= 2.0 ? 2.0 : digit <= 5.0 ? 5.0 : 10.0));
}

Image signed_difference(const Image& test, const Image& reference, float full_scale, const CompareOptions& options)
{
    check_alike(test, reference);
    Image result(test.width, test.height, 3);
    for (size_t pixel = 0; pixel < size_t(test.width) * test.height; ++pixel) {
        float* rgb = &result.pixels[pixel * 3];
        if (!pixel_is_finite(test, pixel) || !pixel_is_finite(reference, pixel)) {
            rgb[0] = rgb[2] = 1.0f;
            continue;
        }
        const float strength = static_cast<float>(mean_difference(test, reference, pixel, options)) / full_scale;
        rgb[strength > 0.0f ? 0 : 2] = std::min(std::fabs(strength), 1.0f);
    }
    return result;
}

Image block_means(const Image& image, int block_size)
{
    if (block_size < 1) throw UserError(fmt::format("the block size {} is not positive", block_size));
    Image result((image.width + block_size - 1) / block_size, (image.height + block_size - 1) / block_size,
                 image.channels);
    std::vector<double> sums(result.pixels.size());
    for_each_in_blocks(image, block_size, [&](int bx, int by, int x, int y) {
        for (int c = 0; c < image.channels; ++c)
            sums[(size_t(by) * result.width + bx) * image.channels + c] += image.at(x, y, c);
    });
    for (int by = 0; by < result.height; ++by)
        for (int bx = 0; bx < result.width; ++bx)
            for (int c = 0; c < image.channels; ++c)
                result.at(bx, by, c) = static_cast<float>(sums[(size_t(by) * result.width + bx) * image.channels + c] /
                                                          block_area(image, block_size, bx, by));
    return result;
}

Image block_variances(const Image& image, int block_size)
{
    const Image means = block_means(image, block_size);
    Image result(means.width, means.height, means.channels);
    std::vector<double> sums(result.pixels.size());
    for_each_in_blocks(image, block_size, [&](int bx, int by, int x, int y) {
        for (int c = 0; c < image.channels; ++c)
            sums[(size_t(by) * result.width + bx) * image.channels + c] +=
                sqr(double(image.at(x, y, c)) - means.at(bx, by, c));
    });
    for (int by = 0; by < result.height; ++by)
        for (int bx = 0; bx < result.width; ++bx)
            for (int c = 0; c < image.channels; ++c)
                result.at(bx, by, c) = static_cast<float>(sums[(size_t(by) * result.width + bx) * image.channels + c] /
                                                          std::max(1, block_area(image, block_size, bx, by) - 1));
    return result;
}

}  // namespace dapple
