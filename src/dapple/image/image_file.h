// Image files in and out: .exr .png .jpg .tga .hdr .pfm .tif and what else OpenImageIO reads; writes .exr .pfm .hdr
// .png.
#pragma once

#include "dapple/image/image.h"

#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace dapple {

// How a file's numbers stand for linear values. Alpha is always linear.
struct ColorEncoding {
    enum class Kind : uint8_t {
        automatic,  // srgb for 8-bit files and for every PNG, else linear
        srgb,       // IEC 61966-2-1
        linear,
        gamma,  // linear = value^gamma
    };
    Kind kind = Kind::automatic;
    float gamma = 2.2f;
};

// The sRGB transfer function and its inverse (IEC 61966-2-1), extended to values above 1; negative values give 0.
float srgb_to_linear(float encoded);
float linear_to_srgb(float linear);

struct ReadOptions {
    ColorEncoding encoding;
};

// A value in a file's header.
using ImageAttribute = std::variant<std::string, int, double>;
using ImageMetadata = std::vector<std::pair<std::string, ImageAttribute>>;

// An image file with the names of its channels and its header.
struct ImageFile {
    Image image;
    std::vector<std::string> channel_names;  // as in the file, "R", "Albedo.R", ...
    ImageMetadata metadata;                  // strings and numbers of the header, in no particular order

    // The index of a channel, or -1.
    int channel(const std::string& name) const;
};

// The pixels as linear floats, 1 to 4 channels, alpha not multiplied in. A file with more channels gives those named R,
// G, B and, if there, A. Throws UserError, naming the file, if it is missing, cannot be decoded or has more channels
// without these names.
Image read_image(const std::string& path, const ReadOptions& options = {});
// As read_image, with all channels and the header.
ImageFile read_image_file(const std::string& path, const ReadOptions& options = {});

struct WriteOptions {
    // Names for .exr; by default Y, YA, RGB or RGBA. Other formats take R, G and B (and A for .png) by these names, or
    // the first channels if there are no such names.
    std::vector<std::string> channel_names;
    ImageMetadata metadata;  // .exr and .png
    bool half = false;       // .exr: 16-bit floats instead of 32-bit
    float exposure = 0.0f;   // .png: stops added before encoding
    Int2 data_origin{0, 0};  // .exr: where the image lies in the full image, for crop windows
    Int2 full_size{0, 0};    // .exr: size of the full image; 0: that of the image
};

// Throws UserError, saying what there is, if the ending of the path is none that write_image takes. The caller may name
// another ending that it takes itself, and what for.
void check_image_ending(const std::string& path, std::string_view other = {}, std::string_view use = {});

// Writes an image; the ending of the path says the format. .png: 8 bits with the sRGB curve, clipped to [0, 1], rounded
// to nearest, no dither. The file appears whole or not at all: it is written beside its place, synced, and renamed.
// Throws UserError, naming the file and the cause, if anything fails; an older file is then still as it was.
void write_image(const std::string& path, const Image& image, const WriteOptions& options = {});

}  // namespace dapple
