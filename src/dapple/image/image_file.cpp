// Reading and writing by way of OpenImageIO; .pfm is written here (Debevec's format: rows from the bottom up, a
// negative scale for little endian).
#include "dapple/image/image_file.h"

#include "dapple/base/error.h"
#include "dapple/image/zip_time.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace dapple {

namespace {

namespace fs = std::filesystem;

std::string lower_extension(const std::string& path)
{
    std::string extension = fs::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

[[noreturn]] void fail(const char* verb, const std::string& path, std::string cause)
{
    while (!cause.empty() && std::isspace(static_cast<unsigned char>(cause.back()))) cause.pop_back();
    std::replace(cause.begin(), cause.end(), '\n', ' ');
    throw UserError(fmt::format("cannot {} image '{}': {}", verb, path, cause.empty() ? "unknown cause" : cause));
}

// "; there is 'wood.JPG'" where a file of this name exists with other capitals or another ending.
std::string similar_file(const std::string& path)
{
    const auto stem = [](const fs::path& file) {
        std::string name = file.stem().string();
        std::transform(name.begin(), name.end(), name.begin(),
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        return name;
    };
    const fs::path folder = fs::path(path).parent_path();
    std::string similar;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder.empty() ? "." : folder, error)) {
        const std::string name = entry.path().filename().string();
        if (stem(name) == stem(path) && (similar.empty() || name < similar)) similar = name;
    }
    return similar.empty() ? "" : fmt::format("; there is '{}'", similar);
}

ColorEncoding resolve(const ColorEncoding& encoding, bool eight_bits, const std::string& format)
{
    if (encoding.kind != ColorEncoding::Kind::automatic) return encoding;
    return {eight_bits || format == "png" ? ColorEncoding::Kind::srgb : ColorEncoding::Kind::linear, 1.0f};
}

// Turns encoded values to linear ones in place, alpha aside.
void decode(Image& image, const ColorEncoding& encoding, bool eight_bits, int alpha_channel)
{
    if (encoding.kind == ColorEncoding::Kind::linear) return;
    const auto decode_value = [&](float v) {
        return encoding.kind == ColorEncoding::Kind::srgb ? srgb_to_linear(v)
                                                          : std::pow(std::max(v, 0.0f), encoding.gamma);
    };
    std::array<float, 256> table;
    for (int i = 0; i < 256; ++i) table[i] = decode_value(static_cast<float>(i) / 255.0f);
    for (size_t i = 0; i < image.pixels.size(); ++i) {
        if (static_cast<int>(i % image.channels) == alpha_channel) continue;
        float& v = image.pixels[i];
        v = eight_bits ? table[std::clamp(static_cast<int>(std::lround(v * 255.0f)), 0, 255)] : decode_value(v);
    }
}

ImageMetadata read_metadata(const OIIO::ImageSpec& spec)
{
    ImageMetadata metadata;
    for (const OIIO::ParamValue& value : spec.extra_attribs) {
        const std::string name = value.name().string();
        if (value.type() == OIIO::TypeDesc::STRING)
            metadata.emplace_back(name, value.get_string());
        else if (value.type() == OIIO::TypeDesc::INT)
            metadata.emplace_back(name, value.get_int());
        else if (value.type() == OIIO::TypeDesc::FLOAT || value.type() == OIIO::TypeDesc::DOUBLE)
            metadata.emplace_back(name, value.type() == OIIO::TypeDesc::FLOAT
                                            ? static_cast<double>(*static_cast<const float*>(value.data()))
                                            : *static_cast<const double*>(value.data()));
    }
    return metadata;
}

// A copy with only the given channels.
Image select_channels(const Image& image, const std::vector<int>& channels)
{
    Image result(image.width, image.height, static_cast<int>(channels.size()));
    float* out = result.pixels.data();
    for (size_t pixel = 0; pixel < size_t(image.width) * image.height; ++pixel)
        for (const int c : channels) *out++ = image.pixels[pixel * image.channels + c];
    return result;
}

// The indices of R, G, B and, if there is one, A; empty if one of the first three is missing.
std::vector<int> color_channels(const std::vector<std::string>& names)
{
    std::vector<int> channels;
    for (const char* name : {"R", "G", "B", "A"}) {
        const auto found = std::find(names.begin(), names.end(), name);
        if (found != names.end())
            channels.push_back(static_cast<int>(found - names.begin()));
        else if (*name != 'A')
            return {};
    }
    return channels;
}

std::vector<std::string> default_channel_names(int channels)
{
    switch (channels) {
        case 1: return {"Y"};
        case 2: return {"Y", "A"};
        case 3: return {"R", "G", "B"};
        case 4: return {"R", "G", "B", "A"};
        default: break;
    }
    throw UserError(fmt::format("an image of {} channels needs channel names", channels));
}

// The image as a format of at most `most` channels can hold it.
Image reduce_channels(const Image& image, const std::vector<std::string>& names, int most)
{
    std::vector<int> channels = color_channels(names);
    if (channels.empty())
        for (int c = 0; c < std::min(image.channels, image.channels == 2 ? 1 : most); ++c) channels.push_back(c);
    if (static_cast<int>(channels.size()) > most) channels.resize(most);
    return select_channels(image, channels);
}

void encode_srgb(Image& image, float exposure)
{
    const float scale = std::exp2(exposure);
    for (size_t i = 0; i < image.pixels.size(); ++i) {
        float& v = image.pixels[i];
        if (!(v > 0.0f)) v = 0.0f;  // NaN too
        if (i % image.channels != 3) v = linear_to_srgb(v * scale);
        v = std::min(v, 1.0f);
    }
}

void write_pfm(const std::string& place, const std::string& path, const Image& image)
{
    std::ofstream out(place, std::ios::binary);
    out << (image.channels == 1 ? "Pf" : "PF") << '\n' << image.width << ' ' << image.height << "\n-1.0\n";
    const size_t row = size_t(image.width) * image.channels;
    for (int y = image.height - 1; y >= 0; --y)
        out.write(reinterpret_cast<const char*>(&image.pixels[y * row]),
                  static_cast<std::streamsize>(row * sizeof(float)));
    out.close();
    if (!out) fail("write", path, std::strerror(errno));
}

OIIO::ImageSpec output_spec(const Image& image, const std::vector<std::string>& names, const WriteOptions& options,
                            const std::string& format)
{
    const OIIO::TypeDesc type = format == "png"                   ? OIIO::TypeDesc::UINT8
                                : options.half && format == "exr" ? OIIO::TypeDesc::HALF
                                                                  : OIIO::TypeDesc::FLOAT;
    OIIO::ImageSpec spec(image.width, image.height, image.channels, type);
    if (format == "exr") {
        spec.channelnames = names;
        spec.attribute("compression", fmt::format("zip:{}", exr_zip_level));
        spec.x = options.data_origin.x;
        spec.y = options.data_origin.y;
        if (options.full_size.x > 0 && options.full_size.y > 0) {
            spec.full_width = options.full_size.x;
            spec.full_height = options.full_size.y;
        }
    } else if (format == "png") {
        spec.attribute("oiio:ColorSpace", "sRGB");
        spec.attribute("oiio:UnassociatedAlpha", 1);
    }
    for (const auto& [name, value] : options.metadata) {
        if (const auto* text = std::get_if<std::string>(&value)) spec.attribute(name, *text);
        if (const auto* number = std::get_if<int>(&value)) spec.attribute(name, *number);
        if (const auto* number = std::get_if<double>(&value)) spec.attribute(name, OIIO::TypeDesc::DOUBLE, number);
    }
    return spec;
}

void write_with_library(const std::string& place, const std::string& path, const Image& image, OIIO::ImageSpec spec,
                        const std::string& format)
{
    const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(format);
    if (!out) fail("write", path, OIIO::geterror());
    // OpenImageIO 2.4 does not notice when a .png cannot be written to the disk.
    const bool in_memory = format == "png";
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput proxy(bytes);
    OIIO::Filesystem::IOProxy* proxy_address = &proxy;
    if (in_memory) spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy_address);
    if (!out->open(place, spec) || !out->write_image(OIIO::TypeDesc::FLOAT, image.pixels.data()) || !out->close())
        fail("write", path, out->geterror());
    if (in_memory) {
        std::ofstream file(place, std::ios::binary);
        file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        file.close();
        if (!file) fail("write", path, std::strerror(errno));
    }
}

// Flushes a file or a folder to the disk; returns false and sets errno if that fails.
bool sync_path(const std::string& path)
{
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) return false;
    const bool synced = ::fsync(file) == 0;
    const int cause = errno;
    ::close(file);
    errno = cause;
    return synced;
}

}  // namespace

float srgb_to_linear(float encoded)
{
    if (!(encoded > 0.0f)) return 0.0f;
    return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

float linear_to_srgb(float linear)
{
    if (!(linear > 0.0f)) return 0.0f;
    return linear <= 0.0031308f ? linear * 12.92f : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

int ImageFile::channel(const std::string& name) const
{
    const auto found = std::find(channel_names.begin(), channel_names.end(), name);
    return found == channel_names.end() ? -1 : static_cast<int>(found - channel_names.begin());
}

ImageFile read_image_file(const std::string& path, const ReadOptions& options)
{
    std::error_code error;
    if (!fs::exists(path, error)) fail("read", path, "no such file" + similar_file(path));
    OIIO::ImageSpec hints;
    hints.attribute("oiio:UnassociatedAlpha", 1);
    const std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::open(path, &hints);
    if (!in) fail("read", path, OIIO::geterror());
    const OIIO::ImageSpec spec = in->spec();
    if (spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0 || spec.depth > 1)
        fail("read", path, "not a two-dimensional image");

    ImageFile file;
    file.image = Image(spec.width, spec.height, spec.nchannels);
    file.channel_names = spec.channelnames;
    file.metadata = read_metadata(spec);
    if (!in->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, file.image.pixels.data()))
        fail("read", path, in->geterror());
    const bool eight_bits = spec.format == OIIO::TypeDesc::UINT8;
    decode(file.image, resolve(options.encoding, eight_bits, in->format_name()), eight_bits, spec.alpha_channel);
    return file;
}

Image read_image(const std::string& path, const ReadOptions& options)
{
    ImageFile file = read_image_file(path, options);
    if (file.image.channels <= 4) return std::move(file.image);
    const std::vector<int> channels = color_channels(file.channel_names);
    if (channels.empty())
        fail("read", path, fmt::format("it has {} channels, and none named R, G and B", file.image.channels));
    return select_channels(file.image, channels);
}

void check_image_ending(const std::string& path, std::string_view other, std::string_view use)
{
    std::vector<std::string_view> known = {".exr", ".png", ".hdr", ".pfm"};
    const std::string ending = lower_extension(path);
    if (std::find(known.begin(), known.end(), ending) != known.end()) return;
    if (!other.empty()) known.push_back(other);
    const std::string meant = did_you_mean(ending, known);
    fail("write", path,
         fmt::format("an image ends in .exr (linear, all layers), .png (8-bit sRGB), .hdr or .pfm (linear){}{}",
                     other.empty() ? "" : fmt::format(", or in {} ({})", other, use),
                     !meant.empty() || ending.empty()
                         ? meant
                         : fmt::format("; others are made of a .png: 'oiiotool {} -o {}'",
                                       fs::path(path).filename().replace_extension(".png").string(),
                                       fs::path(path).filename().string())));
}

void write_image(const std::string& path, const Image& image, const WriteOptions& options)
{
    check_image_ending(path);
    if (image.empty()) fail("write", path, "the image has no pixels");
    const std::string format = lower_extension(path).substr(1);

    const std::vector<std::string> names =
        options.channel_names.empty() ? default_channel_names(image.channels) : options.channel_names;
    if (static_cast<int>(names.size()) != image.channels)
        fail("write", path, fmt::format("{} names for {} channels", names.size(), image.channels));

    // The process id keeps two programs that write to one place apart.
    const std::string place = fmt::format("{}.{}.part", path, ::getpid());
    try {
        if (format == "exr") {
            write_with_library(place, path, image, output_spec(image, names, options, format), format);
        } else {
            Image reduced = reduce_channels(image, names, format == "png" ? 4 : 3);
            if (format == "png") encode_srgb(reduced, options.exposure);
            if (format == "pfm")
                write_pfm(place, path, reduced);
            else
                write_with_library(place, path, reduced, output_spec(reduced, names, options, format), format);
        }
        if (!sync_path(place)) fail("write", path, std::strerror(errno));
        if (::rename(place.c_str(), path.c_str()) != 0) fail("write", path, std::strerror(errno));
    } catch (...) {
        ::unlink(place.c_str());
        throw;
    }
    // Some file systems cannot sync a folder; the file itself is whole by now.
    const std::string folder = fs::path(path).parent_path().string();
    sync_path(folder.empty() ? "." : folder);
}

}  // namespace dapple
