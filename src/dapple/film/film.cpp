// The film's sums, in one plane per layer. Planes come as zero pages from the system and are only touched by what is
// not zero: a layer nothing contributes to (caustics, volumes, most light groups) takes no memory. A touched plane of
// three channels takes 48 bytes a pixel. The beauty is the exact sum of the path classes where those are kept.
// Measured at 1280 x 720, default filter (9 pixels): a splat takes 0.27 us where memory is warm and 0.42 us at random
// places, as much again for its light group; a pixel's sums 0.2 us.
#include "dapple/film/film.h"

#include "dapple/base/error.h"
#include "dapple/film/exact_sum.h"

#include <fmt/format.h>
#include <sys/mman.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <istream>
#include <new>
#include <ostream>

namespace dapple {
namespace {

// One layer: its channels' names in the file and its sums, channels interleaved.
class Layer {
public:
    Layer(std::vector<std::string> channel_names, size_t pixels)
        : channel_names_(std::move(channel_names)),
          size_(pixels * channel_names_.size()),
          sums_(static_cast<AtomicExactSum*>(std::calloc(size_, sizeof(AtomicExactSum))), &std::free)
    {
        if (!sums_) throw std::bad_alloc();
        // Splats go to random places: large pages save most of the address translation. Only a wish, hence unchecked.
        void* page = sums_.get();
        size_t left = size_ * sizeof(AtomicExactSum);
        if (std::align(4096, 1, page, left)) madvise(page, left, MADV_HUGEPAGE);
    }

    int channels() const { return static_cast<int>(channel_names_.size()); }
    const std::vector<std::string>& channel_names() const { return channel_names_; }
    size_t size() const { return size_; }
    AtomicExactSum* pixel(size_t index) { return &sums_[index * channel_names_.size()]; }
    const AtomicExactSum* pixel(size_t index) const { return &sums_[index * channel_names_.size()]; }
    AtomicExactSum* data() { return sums_.get(); }
    const AtomicExactSum* data() const { return sums_.get(); }
    std::streamsize bytes() const { return static_cast<std::streamsize>(size_ * sizeof(AtomicExactSum)); }

private:
    std::vector<std::string> channel_names_;
    size_t size_;
    std::unique_ptr<AtomicExactSum[], decltype(&std::free)> sums_;
};

std::vector<std::string> suffixed(const std::string& prefix, std::string_view letters)
{
    std::vector<std::string> names;
    for (const char letter : letters) names.push_back(prefix.empty() ? std::string(1, letter) : prefix + '.' + letter);
    return names;
}

bool accepted(const Vec3& v) { return exact_sum_accepts(v.x) && exact_sum_accepts(v.y) && exact_sum_accepts(v.z); }

void add_term(AtomicExactSum& sum, double term)
{
    if (term != 0.0) sum.add(to_fixed(term));
}

void add_rgb(AtomicExactSum* sums, const Vec3& rgb, double factor)
{
    for (int c = 0; c < 3; ++c) add_term(sums[c], rgb[c] * factor);
}

// Asks for the cache lines of [first, end), to be written.
void prefetch(const AtomicExactSum* first, const AtomicExactSum* end)
{
    constexpr int per_line = 64 / sizeof(AtomicExactSum);
    for (; first < end; first += per_line) __builtin_prefetch(first, 1);
    __builtin_prefetch(end - 1, 1);
}

void write_word(std::ostream& out, uint64_t word) { out.write(reinterpret_cast<const char*>(&word), sizeof word); }

uint64_t read_word(std::istream& in)
{
    uint64_t word = 0;
    in.read(reinterpret_cast<char*>(&word), sizeof word);
    return word;
}

}  // namespace

struct Film::Sums {
    static constexpr int none = -1;

    Int2 crop_min, crop_size;
    std::vector<Layer> layers;
    int first_radiance = none;  // one layer per path class, or one for all
    int radiance_layers = 0;
    int first_group = none;
    int albedo = none, normal = none, depth = none, position = none;
    int photon_density = none, photon_radius = none;

    size_t pixels() const { return size_t(crop_size.x) * crop_size.y; }
    // Index of a pixel, which must be inside of the crop window.
    size_t index(int x, int y) const { return size_t(y - crop_min.y) * crop_size.x + (x - crop_min.x); }
    int add_layer(const std::string& prefix, std::string_view letters)
    {
        layers.emplace_back(suffixed(prefix, letters), pixels());
        return static_cast<int>(layers.size()) - 1;
    }
    int radiance_layer(PathClass path_class) const
    {
        return radiance_layers == 1 ? first_radiance : first_radiance + static_cast<int>(path_class);
    }
    // The luminance of a pixel, for error estimates.
    ErrorSums::Luminance luminance() const
    {
        return
            [this](size_t pixel) { return ErrorSums::luminance(beauty(pixel, 0), beauty(pixel, 1), beauty(pixel, 2)); };
    }
    Fixed128 beauty(size_t pixel, int channel) const
    {
        Fixed128 sum = 0;
        for (int i = 0; i < radiance_layers; ++i) sum += layers[first_radiance + i].pixel(pixel)[channel].fixed();
        return sum;
    }
};

void PixelSample::clear()
{
    guides = Guides{};
    photon_density = 0.0f;
    radius = 0.0f;
    class_rgb_.fill(Vec3(0));
    std::fill(group_rgb_.begin(), group_rgb_.end(), Vec3(0));
    dropped_ = 0;
}

Film::Film(FilmSettings settings) : settings_(std::move(settings)), sums_(std::make_unique<Sums>())
{
    const Int2 low = settings_.crop_min, high = settings_.crop_max, size = settings_.resolution;
    if (low.x < 0 || low.y < 0 || high.x > size.x || high.y > size.y || low.x >= high.x || low.y >= high.y)
        throw UserError(fmt::format("the crop window {}..{} x {}..{} is empty or leaves the image of {} x {} pixels",
                                    low.x, high.x, low.y, high.y, size.x, size.y));
    std::vector<std::string> groups = settings_.light_groups;
    for (std::string& group : groups)
        if (group.empty()) group = "default";
    for (size_t i = 0; i < groups.size(); ++i)
        if (std::count(groups.begin(), groups.end(), groups[i]) > 1)
            throw UserError(fmt::format("two light groups are named '{}'", groups[i]));

    Sums& s = *sums_;
    s.crop_min = low;
    s.crop_size = high - low;
    reached_.resize(s.pixels());
    s.first_radiance = 0;
    if (settings_.class_layers)
        for (const std::string_view name : path_class_names) s.add_layer(std::string(name), "RGB");
    else
        s.add_layer("", "RGB");
    s.radiance_layers = static_cast<int>(s.layers.size());
    s.first_group = s.radiance_layers;
    for (const std::string& group : groups) s.add_layer("lightgroup_" + group, "RGB");
    if (settings_.guide_layers) {
        s.albedo = s.add_layer("Albedo", "RGB");
        s.normal = s.add_layer("N", "XYZ");
        s.depth = s.add_layer("", "Z");
        s.position = s.add_layer("P", "XYZ");
    }
    if (settings_.photon_layers) {
        s.layers.emplace_back(std::vector<std::string>{"photons.density"}, s.pixels());
        s.photon_density = static_cast<int>(s.layers.size()) - 1;
        s.layers.emplace_back(std::vector<std::string>{"photons.radius"}, s.pixels());
        s.photon_radius = static_cast<int>(s.layers.size()) - 1;
    }
    if (settings_.error_layer)
        errors_ = std::make_unique<ErrorSums>(s.crop_size.x, s.crop_size.y, settings_.correlated_passes,
                                              settings_.fading_bias, settings_.bias_scale);
}

Film::~Film() = default;

void Film::prefetch_pixel(Int2 pixel) const
{
    const size_t index = sums_->index(pixel.x, pixel.y);
    for (const Layer& layer : sums_->layers) prefetch(layer.pixel(index), layer.pixel(index) + layer.channels());
}

void Film::add_pixel(Int2 pixel, const PixelSample& sample, int samples)
{
    Sums& s = *sums_;
    const Int2 local = pixel - s.crop_min;
    if (samples <= 0 || local.x < 0 || local.y < 0 || local.x >= s.crop_size.x || local.y >= s.crop_size.y) return;
    const size_t index = s.index(pixel.x, pixel.y);
    const double factor = 1.0 / samples;
    reached_[index] = 1;

    // Radiance goes in as a whole or not at all: classes and groups must both sum to the beauty.
    uint64_t dropped = sample.dropped_;
    const bool valid = std::all_of(sample.class_rgb_.begin(), sample.class_rgb_.end(), accepted) &&
                       std::all_of(sample.group_rgb_.begin(), sample.group_rgb_.end(), accepted);
    if (valid) {
        for (int i = 0; i < path_class_count; ++i)
            add_rgb(s.layers[s.radiance_layer(static_cast<PathClass>(i))].pixel(index), sample.class_rgb_[i], factor);
        const size_t groups = std::min(sample.group_rgb_.size(), settings_.light_groups.size());
        for (size_t i = 0; i < groups; ++i)
            add_rgb(s.layers[s.first_group + i].pixel(index), sample.group_rgb_[i], factor);
    } else {
        ++dropped;
    }
    // No one else writes to these layers of this pixel: splats have radiance alone.
    const auto add_guide = [&](int layer, const Vec3& v) {
        if (layer == Sums::none) return;
        if (!accepted(v)) {
            ++dropped;
            return;
        }
        for (int c = 0; c < s.layers[layer].channels(); ++c)
            if (v[c] != 0.0f) s.layers[layer].pixel(index)[c].add_alone(to_fixed(v[c] * factor));
    };
    add_guide(s.albedo, sample.guides.albedo);
    add_guide(s.normal, sample.guides.normal);
    add_guide(s.depth, Vec3(sample.guides.depth));
    add_guide(s.position, sample.guides.position);
    add_guide(s.photon_density, Vec3(sample.photon_density));
    add_guide(s.photon_radius, Vec3(sample.radius));
    if (dropped != 0) accidents_.eye_sample.fetch_add(dropped, std::memory_order_relaxed);
}

void Film::splat(const Vec2& raster, const Vec3& sensor_rgb, PathClass path_class, LightGroup group)
{
    Sums& s = *sums_;
    const Filter& filter = settings_.filter;
    if (!accepted(sensor_rgb) || !std::isfinite(raster.x) || !std::isfinite(raster.y)) {
        accidents_.splat.fetch_add(1, std::memory_order_relaxed);
        return;
    }
    // Pixels whose support, centre - radius <= position < centre + radius as seen from the pixel, holds the position.
    const Vec2 radius = filter.radius();
    const float x_low = std::floor(raster.x - 0.5f - radius.x), x_high = std::floor(raster.x - 0.5f + radius.x);
    const float y_low = std::floor(raster.y - 0.5f - radius.y), y_high = std::floor(raster.y - 0.5f + radius.y);
    const Int2 last = s.crop_min + s.crop_size - Int2(1);
    if (x_high < s.crop_min.x || y_high < s.crop_min.y || x_low > last.x || y_low > last.y) return;
    const int x0 = std::max(static_cast<int>(x_low), s.crop_min.x), x1 = std::min(static_cast<int>(x_high), last.x);
    const int y0 = std::max(static_cast<int>(y_low), s.crop_min.y), y1 = std::min(static_cast<int>(y_high), last.y);

    constexpr int max_width = 2 * static_cast<int>(Filter::max_radius) + 2;
    std::array<float, max_width> x_weight;
    for (int x = x0; x <= x1; ++x) x_weight[x - x0] = filter.evaluate_axis(0, raster.x - (x + 0.5f));

    Layer& radiance = s.layers[s.radiance_layer(path_class)];
    Layer* group_layer = group.value < settings_.light_groups.size() ? &s.layers[s.first_group + group.value] : nullptr;
    // Locked additions wait for memory one after another: ask for all rows first.
    for (int y = y0; y <= y1; ++y) {
        prefetch(radiance.pixel(s.index(x0, y)), radiance.pixel(s.index(x1, y)) + 3);
        if (group_layer) prefetch(group_layer->pixel(s.index(x0, y)), group_layer->pixel(s.index(x1, y)) + 3);
    }
    for (int y = y0; y <= y1; ++y) {
        const float y_weight = filter.evaluate_axis(1, raster.y - (y + 0.5f));
        if (y_weight == 0.0f) continue;
        for (int x = x0; x <= x1; ++x) {
            const double weight = double(x_weight[x - x0]) * y_weight;
            if (weight == 0.0) continue;
            const size_t index = s.index(x, y);
            add_rgb(radiance.pixel(index), sensor_rgb, weight);
            if (group_layer) add_rgb(group_layer->pixel(index), sensor_rgb, weight);
        }
    }
}

void Film::add_to_pixel(Int2 pixel, const Vec3& sensor_rgb, PathClass path_class, LightGroup group)
{
    Sums& s = *sums_;
    if (!accepted(sensor_rgb)) {
        accidents_.splat.fetch_add(1, std::memory_order_relaxed);
        return;
    }
    const Int2 local = pixel - s.crop_min;
    if (local.x < 0 || local.y < 0 || local.x >= s.crop_size.x || local.y >= s.crop_size.y) return;
    const size_t index = s.index(pixel.x, pixel.y);
    add_rgb(s.layers[s.radiance_layer(path_class)].pixel(index), sensor_rgb, 1.0);
    if (group.value < settings_.light_groups.size())
        add_rgb(s.layers[s.first_group + group.value].pixel(index), sensor_rgb, 1.0);
}

void Film::end_pass()
{
    if (errors_) errors_->end_pass(settings_.first_pass + passes_, sums_->luminance());
    ++passes_;
    std::fill(reached_.begin(), reached_.end(), uint8_t{0});
}

ErrorEstimate Film::error() const { return errors_ ? errors_->estimate(passes_, sums_->luminance()) : ErrorEstimate(); }

Image Film::beauty() const
{
    const Sums& s = *sums_;
    Image image(s.crop_size.x, s.crop_size.y, 3);
    for (size_t pixel = 0; pixel < s.pixels(); ++pixel)
        for (int c = 0; c < 3; ++c)
            image.pixels[pixel * 3 + c] = static_cast<float>(from_fixed(s.beauty(pixel, c)) * image_factor(pixel));
    return image;
}

Image Film::layers(std::vector<std::string>& channel_names) const
{
    const Sums& s = *sums_;
    channel_names = {"R", "G", "B"};
    // Without class layers the only radiance layer is the beauty itself.
    const size_t first = s.radiance_layers == 1 ? 1 : 0;
    for (size_t i = first; i < s.layers.size(); ++i)
        channel_names.insert(channel_names.end(), s.layers[i].channel_names().begin(),
                             s.layers[i].channel_names().end());
    Image errors;
    if (errors_) {
        errors = errors_->image(passes_, s.luminance());
        channel_names.push_back("error.noise");
        if (errors_->fading()) channel_names.push_back("error.bias");
    }

    Image image(s.crop_size.x, s.crop_size.y, static_cast<int>(channel_names.size()));
    float* out = image.pixels.data();
    for (size_t pixel = 0; pixel < s.pixels(); ++pixel) {
        const double factor = image_factor(pixel);
        for (int c = 0; c < 3; ++c) *out++ = static_cast<float>(from_fixed(s.beauty(pixel, c)) * factor);
        for (size_t i = first; i < s.layers.size(); ++i)
            for (int c = 0; c < s.layers[i].channels(); ++c)
                *out++ = static_cast<float>(from_fixed(s.layers[i].pixel(pixel)[c].fixed()) * factor);
        for (int c = 0; c < errors.channels; ++c) *out++ = errors.pixels[pixel * errors.channels + c];
    }
    return image;
}

// What a state must begin with to belong to such a film.
std::string Film::state_header() const
{
    const Sums& s = *sums_;
    std::string header =
        fmt::format("dapple film state 2\n{} {} {} {}", s.crop_min.x, s.crop_min.y, s.crop_size.x, s.crop_size.y);
    for (const Layer& layer : s.layers)
        for (const std::string& name : layer.channel_names()) header += ' ' + name;
    if (errors_) header += fmt::format(" error/{}{}", settings_.correlated_passes, errors_->fading() ? "/fading" : "");
    return header + '\n';
}

void Film::merge(const Film& other)
{
    Sums& s = *sums_;
    const Sums& o = *other.sums_;
    if (state_header() != other.state_header())
        throw UserError("films of different layers or crop windows cannot be merged");
    if (errors_) errors_->merge(*other.errors_, s.luminance(), o.luminance());
    for (size_t i = 0; i < s.layers.size(); ++i)
        for (size_t j = 0; j < s.layers[i].size(); ++j)
            if (const Fixed128 sum = o.layers[i].data()[j].fixed(); sum != 0) s.layers[i].data()[j].add(sum);
    passes_ += other.passes_;
    accidents_.eye_sample += other.accidents_.eye_sample;
    accidents_.splat += other.accidents_.splat;
}

void Film::write_state(std::ostream& out) const
{
    const std::string header = state_header();
    out.write(header.data(), static_cast<std::streamsize>(header.size()));
    write_word(out, passes_);
    write_word(out, accidents_.eye_sample);
    write_word(out, accidents_.splat);
    for (const Layer& layer : sums_->layers) {
        const bool touched = std::any_of(layer.data(), layer.data() + layer.size(),
                                         [](const AtomicExactSum& sum) { return sum.fixed() != 0; });
        write_word(out, touched);
        if (touched) out.write(reinterpret_cast<const char*>(layer.data()), layer.bytes());
    }
    if (errors_) errors_->write(out, sums_->luminance());
}

void Film::read_state(std::istream& in)
{
    const std::string header = state_header();
    std::string found(header.size(), '\0');
    in.read(found.data(), static_cast<std::streamsize>(found.size()));
    if (!in || found != header) throw UserError("not the state of a film with these layers and this crop window");

    // Everything is read before anything is kept: a damaged file leaves this film as it was.
    Film fresh(settings_);
    fresh.passes_ = static_cast<uint32_t>(read_word(in));
    fresh.accidents_.eye_sample = read_word(in);
    fresh.accidents_.splat = read_word(in);
    for (Layer& layer : fresh.sums_->layers)
        if (read_word(in) != 0) in.read(reinterpret_cast<char*>(layer.data()), layer.bytes());
    if (fresh.errors_) fresh.errors_->read(in, fresh.sums_->luminance());
    if (!in) throw UserError("the film state ends too early");
    sums_ = std::move(fresh.sums_);
    errors_ = std::move(fresh.errors_);
    passes_ = fresh.passes_;
    accidents_.eye_sample = fresh.accidents_.eye_sample.load();
    accidents_.splat = fresh.accidents_.splat.load();
}

}  // namespace dapple
