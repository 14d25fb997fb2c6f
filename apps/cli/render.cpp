// `dapple render`: reads a scene, compiles it, runs passes until the stop rule, writes the images.
#include "build_info.h"
#include "commands.h"
#include "dapple/base/error.h"
#include "dapple/base/log.h"
#include "dapple/base/parallel.h"
#include "dapple/render/duration.h"
#include "dapple/render/film_settings.h"
#include "dapple/render/memory.h"
#include "dapple/render/output.h"
#include "dapple/render/progress.h"
#include "dapple/render/render_job.h"
#include "dapple/render/scene_defaults.h"

#include <fmt/format.h>

#include <csignal>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace dapple::cli {
namespace {

struct Options {
    std::string scene;
    std::vector<std::string> outputs;
    std::string integrator;
    std::vector<std::string> definitions;
    std::string time;
    uint32_t passes = 0;
    std::optional<uint64_t> seed;
    int threads = 0;
    std::string memory;
    std::string crop;
    std::string resolution;
    ColorModel color_model = ColorModel::spectral;
    std::string layers = "all";
    bool half = false;
    bool pbrt_coats = false;
    float exposure = 0;
    bool quiet = false;
    ProgressKind progress = ProgressKind::bar;
};

constexpr const char* examples = R"(Stopping:
  --passes N       exactly N passes (a pass is about one sample per pixel)
  --time 5m        as many passes as fit; the clock starts with the first pass, after the scene is loaded
  neither          the samples per pixel that the scene asks for
  both             whichever comes first
  Ctrl-C           finishes the pass and writes the image; a second one stops at once and still writes

Files: .exr holds all layers and how the image was made; .png is sRGB, clipped, after --exposure stops;
.pfm and .hdr are linear. A crop window writes only its pixels (an .exr knows where they belong).

Examples:
  dapple render scene.pbrt -o out.exr -o out.png --time 60s
  dapple render scene.pbrt -o out.exr --integrator photonmap -D kernel=cone -D photons=500k
  dapple render scene.pbrt -o eye.png --crop 0.4,0.6,0.2,0.4 --passes 256
  dapple render scene.pbrt -o out.exr --seed 7 --threads 2 --quiet)";

StopRequests* stop_requests = nullptr;

void on_interrupt(int) { stop_requests->add(); }

// Ctrl-C and SIGTERM ask to stop for as long as this lives; a reader of our progress that goes away is no reason to
// end.
class InterruptHandler {
public:
    explicit InterruptHandler(StopRequests& requests)
    {
        stop_requests = &requests;
        struct sigaction action = {};
        action.sa_handler = on_interrupt;
        sigaction(SIGINT, &action, &old_interrupt_);
        sigaction(SIGTERM, &action, &old_terminate_);
        action.sa_handler = SIG_IGN;
        sigaction(SIGPIPE, &action, &old_pipe_);
    }
    ~InterruptHandler()
    {
        sigaction(SIGINT, &old_interrupt_, nullptr);
        sigaction(SIGTERM, &old_terminate_, nullptr);
        sigaction(SIGPIPE, &old_pipe_, nullptr);
        stop_requests = nullptr;
    }
    InterruptHandler(const InterruptHandler&) = delete;
    InterruptHandler& operator=(const InterruptHandler&) = delete;

private:
    struct sigaction old_interrupt_ = {};
    struct sigaction old_terminate_ = {};
    struct sigaction old_pipe_ = {};
};

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

StopRule stop_rule(const Options& options, const scene::Description& description)
{
    StopRule rule;
    rule.passes = options.passes;
    if (!options.time.empty()) rule.seconds = parse_duration("--time", options.time);
    if (rule.passes == 0 && rule.seconds == 0)
        rule.passes = static_cast<uint32_t>(std::max(1, description.sampler.pixel_samples));
    return rule;
}

void report_accidents(const Film& film)
{
    const uint64_t eye = film.accidents().eye_sample.load();
    const uint64_t splats = film.accidents().splat.load();
    if (eye + splats > 0)
        log_warning("{} samples were not finite and were left out ({} from eye paths, {} from light paths)",
                    eye + splats, eye, splats);
}

int render(const Options& options, const std::string& command_line)
{
    // What can be wrong without the scene is said before it is read.
    const auto definitions = split_definitions(options.definitions);
    const LayerChoice layers = LayerChoice::parse(options.layers);
    if (!options.integrator.empty()) choose_integrator({}, options.integrator, definitions);
    if (!options.time.empty()) parse_duration("--time", options.time);
    const uint64_t memory_limit = options.memory.empty() ? 0 : parse_size("--memory", options.memory);
    check_output_paths(options.outputs);
    if (options.quiet) set_log_level(LogLevel::silent);
    set_thread_count(options.threads);

    scene::Description description = read_scene(options.scene);
    for (const std::string& warning : description.warnings) log_warning("{}", warning);
    if (!options.resolution.empty()) set_resolution(description.film, options.resolution);
    description.options.pbrt_coat_weights = options.pbrt_coats;
    if (!options.crop.empty()) set_crop(description.film, options.crop);
    IntegratorChoice choice = choose_integrator(description.integrator, options.integrator, definitions);
    for (const std::string& note : choice.notes) log_warning("{}", note);

    std::vector<std::string> outputs = options.outputs;
    if (outputs.empty()) {
        outputs = {std::filesystem::path(description.film.filename).stem().string() + ".exr"};
        check_output_paths(outputs);
    }
    const StopRule stop = stop_rule(options, description);
    const int scene_seed = description.sampler.seed.value_or(description.options.seed);
    const uint64_t seed = options.seed.value_or(static_cast<uint64_t>(scene_seed));

    CompileReport compiled;
    const std::unique_ptr<World> world = compile(description, &compiled);
    const FilmSettings settings =
        film_settings(description, *world, layers, choice.entry->photon_layers, options.color_model);
    check_memory(memory_limit, compiled, settings, choice);
    if (world->has_scattering_media && !choice.entry->media)
        log_warning(
            "integrator '{}' does not handle scattering media, and this scene has some: their light is missing; "
            "'path' and 'lightpath' have it",
            choice.entry->name);
    Film film(settings);
    const std::unique_ptr<Integrator> integrator = choice.entry->create(*world, choice.settings);
    const std::unique_ptr<Progress> progress = make_progress(options.quiet ? ProgressKind::none : options.progress);

    StopRequests requests;
    const InterruptHandler handler(requests);
    const RenderResult result =
        run(RenderJob{*world, *integrator, film, std::string(choice.entry->name), seed, stop}, requests, *progress);
    report_accidents(film);
    if (result.incomplete)
        log_warning("no pass was completed: the image is a part of the first one, black where it was not reached");
    if (result.passes_lost > 0)
        log_warning("the image holds {} passes; {} more were lost by stopping at once", result.passes,
                    result.passes_lost);
    if (result.failed) log_warning("{}", result.reason);

    RenderRecord record{std::string(build_info::version),
                        command_line,
                        options.scene,
                        std::string(choice.entry->name),
                        integrator->report(),
                        seed,
                        thread_count()};
    OutputOptions output{
        outputs,           options.half,        options.exposure,
        settings.crop_min, settings.resolution, {".", std::filesystem::temp_directory_path().string()}};
    const bool written = write_outputs(result, record, output, *progress);
    return written && !result.failed ? 0 : exit_failure;
}

}  // namespace

Command add_render(CLI::App& app, const std::string& command_line)
{
    const auto options = std::make_shared<Options>();
    CLI::App* parser = app.add_subcommand("render", "render a scene to image files");
    parser->footer(examples);
    Options& o = *options;
    parser->add_option("scene", o.scene, "a pbrt-v4 scene file")->required();
    parser->add_option("-o,--output", o.outputs, "image file (.exr, .png, .pfm, .hdr); may be repeated")
        ->allow_extra_args(false);
    parser->add_option("-i,--integrator", o.integrator, "algorithm (dapple integrators lists them)");
    parser->add_option("-D", o.definitions, "a setting of the algorithm, name=value; may be repeated")
        ->allow_extra_args(false);
    parser->add_option("-t,--time", o.time, "render time, such as 60s, 5m, 1h30m");
    parser->add_option("-p,--passes,--spp", o.passes, "number of passes")->check(CLI::Range(1u, 1u << 30));
    parser->add_option("--seed", o.seed, "another seed gives other noise; the same seed the same bits");
    parser->add_option("--threads", o.threads, "threads (default: all cores); the image does not depend on it")
        ->check(CLI::Range(1, 4096));
    parser->add_option("--memory", o.memory,
                       "ceiling, such as 8G: photon maps keep to it; a scene above it is refused");
    parser->add_option("--crop", o.crop, "x0,x1,y0,y1: parts of the image, or pixels if any is above 1");
    parser->add_option("--resolution", o.resolution, "WIDTHxHEIGHT instead of the scene's");
    const std::map<std::string, ColorModel> models = {{"spectral", ColorModel::spectral}, {"rgb", ColorModel::rgb}};
    parser->add_option("--color-model", o.color_model, "spectral (default) or rgb (no colour noise, no dispersion)")
        ->transform(CLI::CheckedTransformer(models).description(""));
    parser->add_option("--layers", o.layers, "all, or words of beauty,guides,classes,groups,photons");
    parser->add_flag("--pbrt-coats", o.pbrt_coats, "rough coats as bright as pbrt-v4's (up to a few percent more)");
    parser->add_flag("--half", o.half, "16-bit floats in .exr files");
    parser->add_option("--exposure", o.exposure, "stops added in .png files")->check(CLI::Range(-100.0f, 100.0f));
    parser->add_flag("-q,--quiet", o.quiet, "print errors only");
    const std::map<std::string, ProgressKind> kinds = {
        {"bar", ProgressKind::bar}, {"json", ProgressKind::json}, {"none", ProgressKind::none}};
    parser->add_option("--progress", o.progress, "bar (default, stderr), json (lines on stdout) or none")
        ->transform(CLI::CheckedTransformer(kinds).description(""));
    return {parser, [options, command_line] { return render(*options, command_line); }};
}

}  // namespace dapple::cli
