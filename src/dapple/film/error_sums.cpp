// Exact sums for error estimates. Integer products and sums are taken modulo 2^128, so that no overflow is undefined:
// luminance takes 8 bits of the headroom of exact_sum.h and weights take 10 more, which leaves sums of 5e14.
#include "dapple/film/error_sums.h"

#include "dapple/base/parallel.h"

#include <algorithm>
#include <cmath>
#include <istream>
#include <ostream>

namespace dapple {
namespace {

using Word128 = unsigned __int128;

constexpr int64_t grain = 4096;
constexpr int block_size = 16;
constexpr double luminance_unit = exact_sum_unit / 256;
constexpr double weight_unit = 1.0 / 1024;
constexpr uint32_t least_for_noise = 2, least_for_bias = 4;  // batches

Fixed128 times(Fixed128 value, uint64_t factor)
{
    return static_cast<Fixed128>(static_cast<Word128>(value) * static_cast<Word128>(factor));
}
Fixed128 plus(Fixed128 a, Fixed128 b)
{
    return static_cast<Fixed128>(static_cast<Word128>(a) + static_cast<Word128>(b));
}
Fixed128 minus(Fixed128 a, Fixed128 b)
{
    return static_cast<Fixed128>(static_cast<Word128>(a) - static_cast<Word128>(b));
}

double square(double x) { return x * x; }

template <class T>
void write_value(std::ostream& out, T value)
{
    out.write(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class T>
T read_value(std::istream& in)
{
    T value{};
    in.read(reinterpret_cast<char*>(&value), sizeof value);
    return value;
}

std::streamsize bytes(const std::vector<Fixed128>& plane)
{
    return static_cast<std::streamsize>(plane.size() * sizeof(Fixed128));
}
void write_plane(std::ostream& out, const std::vector<Fixed128>& plane)
{
    out.write(reinterpret_cast<const char*>(plane.data()), bytes(plane));
}
void read_plane(std::istream& in, std::vector<Fixed128>& plane)
{
    in.read(reinterpret_cast<char*>(plane.data()), bytes(plane));
}

}  // namespace

double ErrorEstimate::total() const { return std::hypot(noise, bias); }

Fixed128 ErrorSums::luminance(Fixed128 r, Fixed128 g, Fixed128 b)
{
    return plus(plus(times(r, 54), times(g, 183)), times(b, 19));
}

ErrorSums::ErrorSums(int width, int height, uint32_t batch, bool fading,
                     std::function<double(uint32_t pass)> bias_scale)
    : width_(width),
      height_(height),
      batch_(std::max(batch, 1u)),
      fading_(fading),
      bias_scale_(std::move(bias_scale)),
      start_(size_t(width) * static_cast<size_t>(height)),
      squares_(start_.size()),
      weighted_(fading ? start_.size() : 0)
{
}

uint64_t ErrorSums::weight_of(uint32_t pass) const
{
    if (!fading_ || !bias_scale_) return 0;
    return static_cast<uint64_t>(std::lround(std::clamp(bias_scale_(pass), 0.0, 1.0) / weight_unit));
}

void ErrorSums::absorb(size_t pixel, Fixed128 light, uint64_t weight)
{
    // A batch brighter than 4e6 counts as if it were that: its square must fit into the sums.
    const double mean = static_cast<double>(light) * luminance_unit / batch_;
    squares_[pixel] = plus(squares_[pixel], to_fixed(std::min(mean * mean, exact_sum_limit)));
    if (fading_) weighted_[pixel] = plus(weighted_[pixel], times(light, weight));
}

void ErrorSums::count(uint64_t weight)
{
    ++batches_;
    weights_ += weight;
    squared_weights_ += weight * weight;
}

void ErrorSums::close(uint32_t index, Open part)
{
    const auto [entry, fresh] = open_.try_emplace(index, std::move(part));
    Open& whole = entry->second;
    if (!fresh) {
        whole.passes += part.passes;
        for (size_t i = 0; i < pixels(); ++i) whole.light[i] = plus(whole.light[i], part.light[i]);
    }
    if (whole.passes < batch_) return;
    for (size_t i = 0; i < pixels(); ++i) absorb(i, whole.light[i], whole.weight);
    count(whole.weight);
    open_.erase(entry);
}

ErrorSums::Open ErrorSums::running(const Luminance& sums) const
{
    Open part{running_passes_, weight_of(running_index_ * batch_), std::vector<Fixed128>(pixels())};
    for (size_t i = 0; i < pixels(); ++i) part.light[i] = minus(sums(i), start_[i]);
    return part;
}

void ErrorSums::end_pass(uint32_t pass, const Luminance& sums)
{
    running_index_ = pass / batch_;
    ++running_passes_;
    if ((pass + 1) % batch_ != 0) return;
    if (running_passes_ == batch_) {
        const uint64_t weight = weight_of(pass);
        parallel_for(static_cast<int64_t>(pixels()), grain, [&](int64_t i) {
            const auto pixel = static_cast<size_t>(i);
            const Fixed128 now = sums(pixel);
            absorb(pixel, minus(now, start_[pixel]), weight);
            start_[pixel] = now;
        });
        count(weight);
    } else {
        Open part = running(sums);
        for (size_t i = 0; i < pixels(); ++i) start_[i] = plus(start_[i], part.light[i]);
        close(running_index_, std::move(part));
    }
    running_passes_ = 0;
}

void ErrorSums::merge(const ErrorSums& other, const Luminance& own_sums, const Luminance& other_sums)
{
    if (running_passes_ > 0) close(running_index_, running(own_sums));
    running_passes_ = 0;
    for (const auto& [index, part] : other.open_) close(index, part);
    if (other.running_passes_ > 0) close(other.running_index_, other.running(other_sums));
    for (size_t i = 0; i < pixels(); ++i) {
        start_[i] = plus(own_sums(i), other_sums(i));
        squares_[i] = plus(squares_[i], other.squares_[i]);
        if (fading_) weighted_[i] = plus(weighted_[i], other.weighted_[i]);
    }
    batches_ += other.batches_;
    weights_ += other.weights_;
    squared_weights_ += other.squared_weights_;
}

size_t ErrorSums::block_of(size_t pixel) const
{
    const auto width = static_cast<size_t>(width_);
    const size_t columns = (width + block_size - 1) / block_size;
    return pixel / width / block_size * columns + pixel % width / block_size;
}

double ErrorSums::mean(size_t pixel, uint32_t passes, const Luminance& sums) const
{
    return static_cast<double>(sums(pixel)) * luminance_unit / std::max(passes, 1u);
}

double ErrorSums::floor(uint32_t passes, const Luminance& sums) const
{
    double sum = 0;
    for (size_t i = 0; i < pixels(); ++i) sum += mean(i, passes, sums);
    return 0.1 * std::fabs(sum) / static_cast<double>(pixels());
}

ErrorSums::Fit ErrorSums::fit(size_t pixel, uint32_t passes) const
{
    Fit fit;
    const auto n = static_cast<double>(batches_);
    if (batches_ < least_for_noise) return fit;
    // Everything that was in complete batches: what came before the running one, but for the open ones.
    Fixed128 light = start_[pixel];
    for (const auto& [index, part] : open_) light = minus(light, part.light[pixel]);
    const double scale = luminance_unit / batch_;
    const double sum = static_cast<double>(light) * scale;
    const double variance = std::max(0.0, (from_fixed(squares_[pixel]) - sum * sum / n) / (n - 1));
    fit.variance = variance * batch_ / passes;
    if (!fading_ || batches_ < least_for_bias) return fit;
    const double x_sum = static_cast<double>(weights_) * weight_unit;
    const double x_spread = static_cast<double>(squared_weights_) * square(weight_unit) - x_sum * x_sum / n;
    if (!(x_spread > 0)) return fit;
    const double product = static_cast<double>(weighted_[pixel]) * scale * weight_unit - x_sum * sum / n;
    const double x_mean = x_sum / n;
    fit.bias = product / x_spread * x_mean;
    fit.bias_variance = variance / x_spread * square(x_mean);
    return fit;
}

std::vector<ErrorSums::Block> ErrorSums::blocks(uint32_t passes, const Luminance& sums) const
{
    std::vector<Block> blocks(block_of(pixels() - 1) + 1);
    std::vector<double> counts(blocks.size(), 0.0);
    for (size_t i = 0; i < pixels(); ++i) {
        const Fit of_pixel = fit(i, passes);
        Block& block = blocks[block_of(i)];
        block.mean += mean(i, passes, sums);
        block.bias += of_pixel.bias;
        block.bias_variance += of_pixel.bias_variance;
        counts[block_of(i)] += 1;
    }
    for (size_t i = 0; i < blocks.size(); ++i) {
        blocks[i].mean /= counts[i];
        blocks[i].bias /= counts[i];
        blocks[i].bias_variance /= square(counts[i]);
    }
    return blocks;
}

ErrorEstimate ErrorSums::estimate(uint32_t passes, const Luminance& sums) const
{
    ErrorEstimate result;
    result.batches = static_cast<uint32_t>(batches_);
    const double floor_squared = square(floor(passes, sums));
    if (batches_ < least_for_noise || !(floor_squared > 0)) return result;
    double noise = 0;
    for (size_t i = 0; i < pixels(); ++i)
        noise += fit(i, passes).variance / (square(mean(i, passes, sums)) + floor_squared);
    result.noise = std::sqrt(noise / static_cast<double>(pixels()));
    if (!fading_) return result;
    // What the noise of the slopes alone brings is taken off; what is left may be negative by chance.
    double bias = 0;
    const std::vector<Block> all = blocks(passes, sums);
    for (const Block& block : all)
        bias += (square(block.bias) - block.bias_variance) / (square(block.mean) + floor_squared);
    result.bias = std::sqrt(std::max(0.0, bias) / static_cast<double>(all.size()));
    return result;
}

Image ErrorSums::image(uint32_t passes, const Luminance& sums) const
{
    Image image(width_, height_, fading_ ? 2 : 1);
    const double floor_squared = square(floor(passes, sums));
    const auto relative = [&](double error, double mean) {
        const double scale = square(mean) + floor_squared;
        return scale > 0 ? static_cast<float>(error / std::sqrt(scale)) : 0.0f;
    };
    const std::vector<Block> all = fading_ ? blocks(passes, sums) : std::vector<Block>();
    float* out = image.pixels.data();
    for (size_t i = 0; i < pixels(); ++i) {
        const double error = std::sqrt(fit(i, passes).variance);
        *out++ = batches_ < least_for_noise ? 1.0f : relative(error, mean(i, passes, sums));
        if (!fading_) continue;
        const Block& block = all[block_of(i)];
        *out++ = relative(block.bias, block.mean);
    }
    return image;
}

void ErrorSums::write(std::ostream& out, const Luminance& sums) const
{
    write_value(out, batches_);
    write_value(out, weights_);
    write_value(out, squared_weights_);
    write_plane(out, squares_);
    write_plane(out, weighted_);
    const auto write_open = [&](uint32_t index, const Open& part) {
        write_value(out, index);
        write_value(out, part.passes);
        write_value(out, part.weight);
        write_plane(out, part.light);
    };
    // The running batch goes out as an open one; should an earlier part of it be open too, reading adds them.
    write_value<uint64_t>(out, open_.size() + (running_passes_ > 0 ? 1 : 0));
    for (const auto& [index, part] : open_) write_open(index, part);
    if (running_passes_ > 0) write_open(running_index_, running(sums));
}

void ErrorSums::read(std::istream& in, const Luminance& sums)
{
    batches_ = read_value<uint64_t>(in);
    weights_ = read_value<uint64_t>(in);
    squared_weights_ = read_value<uint64_t>(in);
    read_plane(in, squares_);
    read_plane(in, weighted_);
    open_.clear();
    running_passes_ = 0;
    const auto count = read_value<uint64_t>(in);
    for (uint64_t i = 0; i < count && in; ++i) {
        const auto index = read_value<uint32_t>(in);
        Open part{read_value<uint32_t>(in), 0, std::vector<Fixed128>(pixels())};
        part.weight = read_value<uint64_t>(in);
        read_plane(in, part.light);
        if (in) close(index, std::move(part));
    }
    for (size_t i = 0; i < pixels(); ++i) start_[i] = sums(i);
}

}  // namespace dapple
