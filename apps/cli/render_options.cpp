// What `dapple render` can be asked for.
#include "render_options.h"

#include "dapple/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>

namespace dapple::cli {
namespace {

constexpr const char* examples = R"(Stopping:
  --passes N       exactly N passes (a pass is about one sample per pixel)
  --time 5m        as many passes as fit; the clock starts with the first pass, after the scene is loaded
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

std::string absolute(const std::string& path, const std::string& folder)
{
    return path.empty() ? path : (std::filesystem::path(folder) / path).lexically_normal().string();
}

}  // namespace

void add_stop_options(CLI::App& parser, RenderOptions& o)
{
    parser.add_option("-t,--time", o.time, "render time, such as 60s, 5m, 1h30m");
    parser.add_option("-p,--passes,--spp", o.passes, "number of passes")->check(CLI::Range(1u, 1u << 30));
    parser
        .add_option("--error", o.error,
                    "stop at this error, a part of the brightness: 0.02 (root of relMSE, estimated)")
        ->check(CLI::Range(1e-6, 1.0));
}

void add_look_options(CLI::App& parser, RenderOptions& o)
{
    parser.add_option("--threads", o.threads, "threads (default: all cores); the image does not depend on it")
        ->check(CLI::Range(1, 4096));
    parser.add_option("--checkpoint-every", o.checkpoint_every, "time between checkpoints (default 60s)");
    parser.add_option("--techniques", o.techniques,
                      "also write what each technique of bdpt or vcm brings, weighted and alone (.exr)");
    parser.add_option("--display-server", o.display_server, "HOST:PORT of the viewer tev, to watch the render");
    parser.add_flag("-q,--quiet", o.quiet, "print errors only");
    const std::map<std::string, ProgressKind> kinds = {
        {"bar", ProgressKind::bar}, {"json", ProgressKind::json}, {"none", ProgressKind::none}};
    parser.add_option("--progress", o.progress, "bar (default, stderr), json (lines on stdout) or none")
        ->transform(CLI::CheckedTransformer(kinds).description(""));
}

void add_render_options(CLI::App& parser, RenderOptions& o)
{
    parser.footer(examples);
    parser.add_option("scene", o.scene, "a pbrt-v4 scene file")->required();
    parser.add_option("-o,--output", o.outputs, "file (.exr, .png, .pfm, .hdr, .dapple); may be repeated")
        ->allow_extra_args(false);
    parser.add_option("-i,--integrator", o.integrator, "algorithm (dapple integrators lists them)");
    parser.add_option("-D", o.definitions, "a setting of the algorithm, name=value; may be repeated")
        ->allow_extra_args(false);
    add_stop_options(parser, o);
    parser.add_option("--first-pass", o.first_pass, "begin with this pass, for dapple merge (default 0)")
        ->check(CLI::Range(0u, 1u << 30));
    parser.add_option("--seed", o.seed, "another seed gives other noise; the same seed the same bits");
    parser.add_option("--memory", o.memory, "ceiling, such as 8G: photon maps keep to it; a scene above it is refused");
    parser.add_option("--crop", o.crop, "x0,x1,y0,y1: parts of the image, or pixels if any is above 1");
    parser.add_option("--resolution", o.resolution, "WIDTHxHEIGHT instead of the scene's");
    const std::map<std::string, ColorModel> models = {{"spectral", ColorModel::spectral}, {"rgb", ColorModel::rgb}};
    parser.add_option("--color-model", o.color_model, "spectral (default) or rgb (no colour noise, no dispersion)")
        ->transform(CLI::CheckedTransformer(models).description(""));
    parser.add_option("--layers", o.layers, "words of all,beauty,guides,classes,groups,photons,error (default all)");
    parser.add_flag("--pbrt-coats", o.pbrt_coats, "rough coats as bright as pbrt-v4's (up to a few percent more)");
    parser.add_flag("--half", o.half, "16-bit floats in .exr files");
    parser.add_option("--exposure", o.exposure, "stops added in .png files")->check(CLI::Range(-100.0f, 100.0f));
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
