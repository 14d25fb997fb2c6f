// What `dapple render` can be asked for.
#include "render_options.h"

#include "dapple/base/error.h"
#include "dapple/render/duration.h"
#include "values.h"

#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <system_error>

namespace dapple::cli {
namespace {

constexpr const char* examples = R"(Stopping:
  --passes N       exactly N passes (a pass is about one sample per pixel)
  --time 5m        that long, from the start of the command to its last file
  --error 0.02     when the estimated error of the image is 2 % of its brightness
  none of them     the samples per pixel that the scene asks for
  several          whichever comes first
  Ctrl-C           finishes the pass and writes the image; a second one stops at once and still writes

Files: .exr holds all layers and how the image was made; .png is sRGB, clipped, after --exposure stops;
.pfm and .hdr are linear; .dapple holds the render itself, for dapple merge and dapple resume.
A crop window writes only its pixels (an .exr knows where they belong).

Long renders: a render of more than 5 minutes keeps a checkpoint beside its first output, OUT.dapple, every
5 minutes; it is removed at the end. After a crash, a kill or Ctrl-C, dapple resume OUT.dapple goes on as if
nothing had happened. --checkpoint FILE writes one every minute and keeps it; --checkpoint none writes none.

Examples:
  dapple render scene.pbrt -o out.exr -o out.png --time 60s
  dapple render scene.pbrt -o out.exr --integrator photonmap -D kernel=cone -D photons=500k
  dapple render scene.pbrt -o eye.png --crop 0.4,0.6,0.2,0.4 --passes 256
  dapple render scene.pbrt -o out.exr --seed 7 --threads 2 --quiet
  dapple render scene.pbrt -o out.exr --error 0.05 --time 1h --checkpoint out.dapple
  dapple render scene.pbrt -o out.exr --integrator bdpt --techniques each.exr
  dapple render scene.pbrt -o part.dapple --first-pass 32 --passes 32     the second of several machines
  dapple render scene.pbrt -o out.exr --display-server 127.0.0.1:14158    watch it in the viewer tev)";

void add_duration(CLI::App& parser, const std::string& names, double& seconds, const std::string& help)
{
    add_value(parser, names, "TIME", help, [&seconds](const std::string& option, const std::string& text) {
        seconds = parse_duration(option, text);
    });
}

// All 64 bits, which a double could not hold.
uint64_t parse_seed(const std::string& option, const std::string& text)
{
    uint64_t seed = 0;
    const char* end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, seed);
    if (read.ec != std::errc() || read.ptr != end)
        throw UserError(fmt::format("{} takes a whole number of 0 or more (64 bits), not '{}'", option, text));
    return seed;
}

std::string absolute(const std::string& path, const std::string& folder)
{
    return path.empty() ? path : (std::filesystem::path(folder) / path).lexically_normal().string();
}

}  // namespace

void add_stop_options(CLI::App& parser, RenderOptions& o)
{
    add_duration(parser, "-t,--time", o.seconds, "time of the whole command, such as 60s, 5m, 1h30m");
    add_number(parser, "-p,--passes,--spp", o.passes, "integer 1 to 1000000000", "number of passes");
    add_number(parser, "--error", o.error, "0.000001 to 1",
               "stop at this error, a part of the brightness: 0.02 (root of relMSE, estimated)");
}

void add_look_options(CLI::App& parser, RenderOptions& o)
{
    add_number(parser, "--threads", o.threads, "integer 1 to 4096",
               "threads (default: all cores); the image does not depend on it");
    add_duration(parser, "--checkpoint-every", o.checkpoint_every, "time between checkpoints (default 60s)");
    parser.add_option("--techniques", o.techniques,
                      "also write what each technique of bdpt or vcm brings, weighted and alone (.exr)");
    parser.add_option("--display-server", o.display_server, "HOST:PORT of the viewer tev, to watch the render");
    parser.add_flag("-q,--quiet", o.quiet, "print errors only");
    add_word(parser, "--progress", o.progress,
             {{"bar", ProgressKind::bar}, {"json", ProgressKind::json}, {"none", ProgressKind::none}},
             "bar (default, stderr), json (lines on stdout) or none");
}

void add_render_options(CLI::App& parser, RenderOptions& o)
{
    parser.footer(examples);
    parser.add_option("scene", o.scene, "a pbrt-v4 scene file")->required();
    parser.add_option("-o,--output", o.outputs, "file (.exr, .png, .pfm, .hdr, .dapple); -o again for another")
        ->allow_extra_args(false);
    parser.add_option("-i,--integrator", o.integrator, "algorithm (dapple integrators lists them)");
    parser.add_option("-D", o.definitions, "a setting of the algorithm, name=value; may be repeated")
        ->allow_extra_args(false);
    add_stop_options(parser, o);
    add_number(parser, "--first-pass", o.first_pass, "integer 0 to 1000000000",
               "begin with this pass, for dapple merge (default 0)");
    add_value(parser, "--seed", "NUMBER", "another seed gives other noise; the same seed the same bits",
              [&o](const std::string& option, const std::string& text) { o.seed = parse_seed(option, text); });
    add_value(parser, "--memory", "SIZE", "ceiling, such as 8G: photon maps keep to it; a scene above it is refused",
              [&o](const std::string& option, const std::string& text) { o.memory = parse_size(option, text); });
    add_value(parser, "--crop", "X0,X1,Y0,Y1", "parts of the image, or pixels if any is above 1",
              [&o](const std::string&, const std::string& text) { o.crop = parse_crop(text); });
    add_value(parser, "--resolution", "WIDTHxHEIGHT", "instead of the scene's",
              [&o](const std::string&, const std::string& text) { o.resolution = parse_resolution(text); });
    add_word(parser, "--color-model", o.color_model, {{"spectral", ColorModel::spectral}, {"rgb", ColorModel::rgb}},
             "spectral (default) or rgb (no colour noise, no dispersion)");
    add_value(parser, "--layers", "WORDS", "words of all,beauty,guides,classes,groups,photons,error (default all)",
              [&o](const std::string&, const std::string& text) { o.layers = LayerChoice::parse(text); });
    parser.add_flag("--pbrt-coats", o.pbrt_coats, "rough coats as bright as pbrt-v4's (up to a few percent more)");
    parser.add_flag("--half", o.half, "16-bit floats in .exr files");
    add_number(parser, "--exposure", o.exposure, "-100 to 100", "stops added in .png files");
    parser.add_option("--checkpoint", o.checkpoint, "keep a checkpoint in this file, for dapple resume; or none");
    add_look_options(parser, o);
}

RenderOptions parse_render_options(const std::vector<std::string>& arguments)
{
    RenderOptions options;
    CLI::App parser;
    add_render_options(parser, options);
    std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
    try {
        parser.parse(std::move(reversed));
    } catch (const CLI::ParseError& error) {
        throw UserError(fmt::format("the options in the checkpoint are not known: {}", error.what()));
    }
    return options;
}

void make_absolute(RenderOptions& options, const std::string& folder)
{
    options.scene = absolute(options.scene, folder);
    for (std::string& output : options.outputs) output = absolute(output, folder);
    if (options.checkpoint != "none") options.checkpoint = absolute(options.checkpoint, folder);
}

std::vector<std::pair<std::string, std::string>> split_definitions(const std::vector<std::string>& texts)
{
    std::vector<std::pair<std::string, std::string>> definitions;
    for (const std::string& text : texts) {
        const size_t equals = text.find('=');
        if (equals == 0 || equals == std::string::npos) throw UserError("-D takes name=value, not '" + text + "'");
        definitions.emplace_back(text.substr(0, equals), text.substr(equals + 1));
    }
    return definitions;
}

}  // namespace dapple::cli
