// `dapple compare`: how far two images are apart, as numbers, as a picture, and as an exit status.
#include "commands.h"
#include "dapple/base/error.h"
#include "dapple/base/words.h"
#include "dapple/image/image_file.h"
#include "dapple/image/metrics.h"
#include "values.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>

namespace dapple::cli {
namespace {

struct Options {
    std::string test;
    std::string reference;
    float clamp = std::numeric_limits<float>::infinity();
    std::string layer;
    std::string difference;
    float difference_scale = 0;  // 0: by itself
    bool flip = false;
    bool exact = false;
    double mean_limit = -1;  // [percent]; negative: not asked for
    double relative_mse_limit = -1;
};

constexpr const char* examples =
    R"(Prints, per channel, the ratio of the means (A / B), and over all channels MSE, relMSE = mean((a-b)^2 / (b^2 + 0.01))
and MAE. With limits the exit status is 1 where one is exceeded.

Examples:
  dapple compare mine.exr reference.exr --diff diff.png
  dapple compare mine.exr reference.exr --clamp 10 --mean-within 1
  dapple compare one.exr two.exr --exact          every layer, bit by bit
  dapple compare one.exr two.exr --layer Albedo)";

// The three channels of a layer ("Albedo.R", ... or "N.X", ...), or its single one.
Image pick_layer(const ImageFile& file, const std::string& path, const std::string& layer)
{
    std::vector<int> channels;
    for (const char* component : {"R", "G", "B", "X", "Y", "Z"}) {
        const int channel = file.channel(layer + "." + component);
        if (channel >= 0) channels.push_back(channel);
    }
    if (channels.empty() && file.channel(layer) >= 0) channels.push_back(file.channel(layer));
    if (channels.empty()) {
        std::vector<std::string_view> known;
        for (const std::string& name : file.channel_names)
            known.push_back(std::string_view(name).substr(0, name.rfind('.')));
        throw UserError("image '" + path + "' has no layer '" + layer + "'" + did_you_mean(layer, known));
    }
    Image picked(file.image.width, file.image.height, static_cast<int>(channels.size()));
    for (int y = 0; y < picked.height; ++y)
        for (int x = 0; x < picked.width; ++x)
            for (int c = 0; c < picked.channels; ++c)
                picked.at(x, y, c) = file.image.at(x, y, channels[static_cast<size_t>(c)]);
    return picked;
}

// Colour alone: means of alpha say nothing about a picture.
Image without_alpha(const Image& image)
{
    if (image.channels != 2 && image.channels != 4) return image;
    Image color(image.width, image.height, image.channels - 1);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < color.channels; ++c) color.at(x, y, c) = image.at(x, y, c);
    return color;
}

Image read(const std::string& path, const std::string& layer)
{
    return layer.empty() ? without_alpha(read_image(path)) : pick_layer(read_image_file(path), path, layer);
}

int compare_exactly(const Options& options)
{
    const ImageFile a = read_image_file(options.test);
    const ImageFile b = read_image_file(options.reference);
    if (a.channel_names != b.channel_names || a.image.width != b.image.width || a.image.height != b.image.height) {
        fmt::print("different: the images have other sizes or layers\n");
        return exit_failure;
    }
    const size_t channels = a.channel_names.size();
    std::vector<size_t> differing(channels, 0);
    size_t total = 0;
    const auto bits = [](float value) { return std::bit_cast<uint32_t>(value); };
    for (size_t i = 0; i < a.image.pixels.size(); ++i)
        if (bits(a.image.pixels[i]) != bits(b.image.pixels[i])) ++differing[i % channels], ++total;
    if (total == 0) {
        fmt::print("the same bits in {}{}\n", channels > 1 ? "all " : "", counted(channels, "channel"));
        return 0;
    }
    for (size_t c = 0; c < channels; ++c)
        if (differing[c] > 0)
            fmt::print("different: {} of channel {}\n", counted(differing[c], "value"), a.channel_names[c]);
    return exit_failure;
}

// The picture of the difference, and what its colours mean.
void write_difference(const Options& options, const Image& test, const Image& reference, const CompareOptions& limits)
{
    const bool automatic = options.difference_scale <= 0;
    const float scale = automatic ? difference_scale(test, reference, limits) : options.difference_scale;
    write_image(options.difference, signed_difference(test, reference, scale, limits));
    fmt::print("wrote {}: red where A is brighter, blue where it is darker, full colour at a difference of {:g}{}\n",
               options.difference, scale, automatic ? " (99 % of the pixels differ less; --diff-scale sets it)" : "");
}

int compare(const Options& options)
{
    if (!options.difference.empty()) check_image_ending(options.difference);
    if (options.exact) return compare_exactly(options);
    const Image test = read(options.test, options.layer);
    const Image reference = read(options.reference, options.layer);
    const CompareOptions limits{options.clamp};
    ImageComparison comparison;
    try {
        comparison = compare_images(test, reference, limits);
    } catch (const UserError& error) {
        throw UserError(fmt::format("'{}' and '{}': {}", options.test, options.reference, error.what()));
    }

    bool good = true;
    for (size_t c = 0; c < comparison.mean_ratio.size(); ++c) {
        const double ratio = comparison.mean_ratio[c];
        fmt::print("mean ratio {}   {:.5f}   ({:.6g} / {:.6g})\n",
                   c < 3 && comparison.mean_ratio.size() >= 3 ? "RGB"[c] : 'Y', ratio, comparison.mean_test[c],
                   comparison.mean_reference[c]);
        const double percent = 100 * std::abs(ratio - 1);
        // A ratio that is not a number is a failure, too.
        if (options.mean_limit >= 0 && !(percent <= options.mean_limit)) good = false;
    }
    fmt::print("MSE            {:.6g}\nrelMSE         {:.6g}\nMAE            {:.6g}\nlargest error  {:.6g}\n",
               comparison.mse, comparison.relative_mse, comparison.mae, comparison.max_error);
    if (options.flip) fmt::print("FLIP           {:.5f}\n", flip(test, reference).mean);
    if (comparison.non_finite > 0) {
        fmt::print("not finite     {}\n", counted(comparison.non_finite, "pixel"));
        good = good && options.mean_limit < 0 && options.relative_mse_limit < 0;
    }
    if (options.relative_mse_limit >= 0 && !(comparison.relative_mse <= options.relative_mse_limit)) good = false;
    if (!options.difference.empty()) write_difference(options, test, reference, limits);
    if (!good) fmt::print("beyond the limits\n");
    return good ? 0 : exit_failure;
}

}  // namespace

Command add_compare(CLI::App& app)
{
    const auto options = std::make_shared<Options>();
    CLI::App* parser = app.add_subcommand("compare", "say how much two images differ");
    parser->footer(examples);
    Options& o = *options;
    parser->add_option("a", o.test, "the image to judge")->required();
    parser->add_option("b", o.reference, "the image to judge it by")->required();
    add_number(*parser, "--clamp", o.clamp, "> 0", "limit values of both images to this size first");
    parser->add_option("--layer", o.layer, "compare this layer instead of the beauty, such as Albedo, Z or caustic");
    parser->add_option("-o,--diff", o.difference, "write a picture of the signed difference");
    add_number(*parser, "--diff-scale", o.difference_scale, "> 0",
               "difference that gives full colour (default: what 99 % of the pixels stay below)");
    parser->add_flag("--flip", o.flip, "also the perceptual difference FLIP");
    parser->add_flag("--exact", o.exact, "exit status 1 unless all layers have the same bits");
    add_number(*parser, "--mean-within", o.mean_limit, ">= 0",
               "exit status 1 unless each channel's mean is this near [percent]");
    add_number(*parser, "--relmse-within", o.relative_mse_limit, ">= 0", "exit status 1 unless relMSE is at most this");
    return {parser, [options] { return compare(*options); }};
}

}  // namespace dapple::cli
