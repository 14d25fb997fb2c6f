// `dapple render`: reads a scene, compiles it, runs passes until the stop rule, writes the images. `dapple resume`
// comes here too, with a checkpoint to begin with.
#include "build_info.h"
#include "dapple/base/error.h"
#include "dapple/base/log.h"
#include "dapple/base/parallel.h"
#include "dapple/base/temp_folder.h"
#include "dapple/base/words.h"
#include "dapple/render/checkpointer.h"
#include "dapple/render/duration.h"
#include "dapple/render/film_settings.h"
#include "dapple/render/live_view.h"
#include "dapple/render/memory.h"
#include "dapple/render/output.h"
#include "dapple/render/pilot.h"
#include "dapple/render/progress.h"
#include "dapple/render/render_job.h"
#include "dapple/render/scene_defaults.h"
#include "dapple/render/technique_record.h"
#include "dapple/render/write_time.h"
#include "interrupts.h"
#include "render_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace dapple::cli {
namespace {

StopRule stop_rule(const RenderOptions& options, const scene::Description& description)
{
    StopRule rule;
    rule.passes = options.passes;
    rule.seconds = options.seconds;
    rule.error = options.error;
    if (rule.passes == 0 && rule.seconds == 0 && rule.error == 0)
        rule.passes = static_cast<uint32_t>(std::max(1, description.sampler.pixel_samples));
    return rule;
}

constexpr double much_writing = 0.2;  // of the time limit: said

// Of --time, which is that of the whole command: what loading took is over, and writing the files comes after.
class TimeLimit {
public:
    // seconds: 0: none.
    explicit TimeLimit(double seconds) : seconds_(seconds) {}
    bool any() const { return seconds_ > 0; }
    // From now on [s]; never 0, which would be no limit.
    double left() const
    {
        const std::chrono::duration<double> gone = std::chrono::steady_clock::now() - begin_ + loading_;
        return std::max(seconds_ - gone.count(), 1e-3);
    }

private:
    // Loading the program itself was work of its processor (0.25 s, OpenImageIO and what it brings).
    const std::chrono::duration<double> loading_{static_cast<double>(std::clock()) / CLOCKS_PER_SEC};
    const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
    double seconds_;
};

// Automatic numbers that --time has no room for become smaller ones. A render that goes on keeps those of its
// beginning.
std::vector<std::string> lower_efforts(const TimeLimit& limit, const RenderStart& start, IntegratorChoice& choice,
                                       const World& world, const FilmSettings& film, uint64_t seed,
                                       const WriteTime& writing)
{
    if (!limit.any() || !start.checkpoint.empty()) return {};
    std::vector<std::string> lines;
    const double left = std::max(limit.left() - writing.expected(), 0.0);
    for (const std::string& lowered : fit_to_time(choice, world, film, seed, left))
        lines.push_back("for --time: " + lowered);
    return lines;
}

void report_accidents(const Film& film)
{
    const uint64_t eye = film.accidents().eye_sample.load();
    const uint64_t splats = film.accidents().splat.load();
    if (eye + splats > 0)
        log_warning("{} that {} not finite left out ({} from eye paths, {} from light paths)",
                    counted(eye + splats, "sample"), eye + splats == 1 ? "was" : "were", eye, splats);
}

// Stopped by the user before any pixel had any light: no such image shall replace an older one.
bool shows_nothing(const RenderResult& result)
{
    return result.by_request && !result.incomplete.empty() &&
           std::all_of(result.image.pixels.begin(), result.image.pixels.end(), [](float v) { return v == 0.0f; });
}

// What the image lacks, and what to do about it.
void report_lacks(const RenderResult& result, const IntegratorChoice& choice)
{
    if (result.passes_lost > 0)
        log_warning("the image holds {}; {} more were lost by stopping at once", counted(result.passes, "pass"),
                    result.passes_lost);
    if (result.incomplete.empty()) return;
    if (result.by_request) return log_warning("{}", result.incomplete);
    std::string smaller = "--resolution";
    for (const std::string_view fewer : {"photons", "particles", "lightpaths", "cacherecords"})
        for (const SettingInfo& info : choice.entry->settings)
            if (info.name == fewer) smaller += fmt::format(", -D {}", fewer);
    log_warning("{}; what helps: a longer --time, or a smaller {}", result.incomplete, smaller);
}

// Said at the end, too: it is easily missed before the picture is there.
void report_missing_images(const std::vector<std::string>& files)
{
    if (files.empty()) return;
    log_warning("{} could not be read and {} magenta in this image: {}", counted(files.size(), "texture file"),
                files.size() == 1 ? "is" : "are", fmt::join(files, ", "));
}

// Where a render goes on.
std::string going_on(const RenderStart& start, const StopRule& stop)
{
    const CheckpointHeader& header = start.header;
    const auto passes = static_cast<uint32_t>(header.passes());
    const std::string holds = fmt::format("'{}' holds {} ({})", start.checkpoint, counted(passes, "pass"),
                                          format_duration(header.counters.seconds));
    if (!stop.another(passes, header.counters.seconds, 0.0)) {
        std::string why = ", all that is asked for";
        if (stop.passes > 0 && stop.passes < passes)
            why = fmt::format(", and --passes {} counts from the first", stop.passes);
        else if (stop.time_is_up(header.counters.seconds))
            why = fmt::format(", and --time {} counts from the beginning", format_duration(stop.seconds));
        return holds + why + ": the image of these is written";
    }
    return fmt::format("{}; going on with pass {}{}{}", holds, passes + 1,
                       stop.passes > 0 ? fmt::format(" of {}", stop.passes) : "",
                       stop.seconds > 0 ? fmt::format(", until {} in all", format_duration(stop.seconds)) : "");
}

// What can be wrong without the scene is said before it is read.
void check_options(const RenderOptions& options, const RenderStart& start)
{
    if (!options.integrator.empty()) choose_integrator({}, options.integrator, split_definitions(options.definitions));
    check_output_paths(options.outputs);
    if (!options.techniques.empty()) {
        if (!options.techniques.ends_with(".exr"))
            throw UserError("--techniques takes a file that ends in .exr, not '" + options.techniques + "'");
        check_output_paths({options.techniques});
    }
    if (options.checkpoint.empty() || options.checkpoint == "none" || !start.checkpoint.empty()) return;
    if (!is_state_path(options.checkpoint))
        throw UserError("--checkpoint takes a file that ends in .dapple, or none, not '" + options.checkpoint + "'");
    check_output_folder(options.checkpoint);
    if (std::filesystem::exists(options.checkpoint))
        throw UserError(
            fmt::format("'{0}' is there already: 'dapple resume {0}' goes on with it; remove it to begin anew",
                        options.checkpoint));
}

scene::Description read_changed_scene(const RenderOptions& options)
{
    scene::Description description = read_scene(options.scene);
    for (const std::string& warning : description.warnings) log_warning("{}", warning);
    if (options.resolution) set_resolution(description.film, *options.resolution);
    description.options.pbrt_coat_weights = options.pbrt_coats;
    if (options.crop) set_crop(description.film, *options.crop);
    return description;
}

// The files asked for, or the one that the scene names, in the folder of the command.
std::vector<std::string> outputs_of(const RenderOptions& options, const RenderStart& start,
                                    const scene::Description& description)
{
    if (!options.outputs.empty()) return options.outputs;
    const std::string stem = std::filesystem::path(description.film.filename).stem().string();
    const std::vector<std::string> outputs = {(std::filesystem::path(start.folder) / (stem + ".exr")).string()};
    check_output_paths(outputs);
    return outputs;
}

// Where checkpoints go; none if the path is empty.
CheckpointPlan checkpoint_plan(const RenderOptions& options, const RenderStart& start, const std::string& first_output)
{
    constexpr double automatic_seconds = 300;
    CheckpointPlan plan;
    if (options.checkpoint == "none") return plan;
    plan.path = start.checkpoint.empty() ? options.checkpoint : start.checkpoint;
    plan.automatic = start.checkpoint.empty() ? options.checkpoint.empty() : start.header.automatic;
    if (plan.automatic) plan.first = plan.every = automatic_seconds;
    if (options.checkpoint_every > 0) plan.first = plan.every = options.checkpoint_every;
    // An earlier render's is not lost.
    for (int number = 1; plan.path.empty() || (start.checkpoint.empty() && std::filesystem::exists(plan.path));
         ++number) {
        const std::string ending = number == 1 ? ".dapple" : fmt::format("-{}.dapple", number);
        plan.path = std::filesystem::path(first_output).replace_extension().string() + ending;
    }
    return plan;
}

// Writes images and states, and says what is missing in them. Returns what went wrong.
std::vector<std::string> write_results(const RenderOptions& options, const CheckpointHeader& identity, const Film& film,
                                       RenderResult& result, std::vector<std::string> outputs,
                                       Checkpointer* checkpointer, const StopRequests& requests, Progress& progress)
{
    std::vector<std::string> problems;
    if (result.failed)
        problems.push_back(fmt::format("{}; the image holds {}", result.reason, counted(result.passes, "pass")));
    if (!result.film_whole)
        std::erase_if(outputs, [&](const std::string& path) {
            if (!is_state_path(path)) return false;
            problems.push_back(fmt::format("'{}' is not written: the last pass was given up", path));
            return true;
        });
    if (checkpointer && !checkpointer->finish(film, result) && !checkpointer->automatic())
        problems.push_back(fmt::format("the checkpoint '{}' does not hold the last passes", checkpointer->path()));
    if (checkpointer && checkpointer->written() && (result.by_request || result.failed))
        progress.note(fmt::format("dapple resume {} goes on", checkpointer->path()));

    OutputOptions output;
    output.paths = std::move(outputs);
    output.half = options.half;
    output.exposure = options.exposure;
    output.crop_min = identity.film.crop_min;
    output.full_size = identity.film.resolution;
    output.rescue_folders = {".", temp_path().string()};
    output.requests = &requests;
    output.write_state = [&](const std::string& path) {
        CheckpointHeader header = identity;
        set_progress(header, film, {result.seconds, result.eye_paths, result.light_paths, result.photons, result.rays});
        write_checkpoint(path, header, film);
    };
    const std::string error = write_outputs(result, identity.record, output, progress);
    if (!error.empty()) problems.push_back(error);
    return problems;
}

uint64_t seed_of(const RenderOptions& options, const scene::Description& description)
{
    return options.seed.value_or(static_cast<uint64_t>(description.sampler.seed.value_or(description.options.seed)));
}

// What the image hangs on, and how it came about.
CheckpointHeader identify(const RenderOptions& options, const RenderStart& start, const scene::Description& description,
                          const IntegratorChoice& choice, const Integrator& integrator, const FilmSettings& film)
{
    CheckpointHeader identity;
    identity.files = hash_files(description.files);
    identity.pbrt_coats = options.pbrt_coats;
    identity.arguments = start.arguments;
    identity.folder = start.folder;
    identity.settings.assign(choice.settings.values().begin(), choice.settings.values().end());
    identity.film = film;
    identity.record = {fmt::format("{} ({})", build_info::version, build_info::commit),
                       start.command_line,
                       options.scene,
                       std::string(choice.entry->name),
                       integrator.report(),
                       seed_of(options, description),
                       thread_count()};
    return identity;
}

// Puts the passes of the checkpoint into the film; refuses when they are of another render.
void load_checkpoint(const RenderStart& start, const CheckpointHeader& identity, Film& film)
{
    if (start.checkpoint.empty()) return;
    if (const std::string reason = difference(start.header, identity); !reason.empty())
        throw UserError(fmt::format("'{}' cannot be continued: {}", start.checkpoint, reason));
    read_checkpoint_film(start.checkpoint, film);
}

}  // namespace

int render(const RenderOptions& options, const RenderStart& start)
{
    const TimeLimit limit(options.seconds);
    check_options(options, start);
    if (options.quiet) set_log_level(LogLevel::silent);
    set_thread_count(options.threads);
    const bool resumed = !start.checkpoint.empty();
    StopRequests requests;  // outlives the handler that counts into it
    Interrupts interrupts;

    scene::Description description = read_changed_scene(options);
    IntegratorChoice choice =
        resumed ? choose_integrator({}, start.header.record.integrator, start.header.settings)
                : choose_integrator(description.integrator, options.integrator, split_definitions(options.definitions));
    for (const std::string& note : choice.notes) log_warning("{}", note);

    const std::vector<std::string> outputs = outputs_of(options, start, description);
    const StopRule stop = stop_rule(options, description);

    CompileReport compiled;
    const std::unique_ptr<World> world = compile(description, &compiled);
    LayerChoice layers = options.layers;
    layers.error = layers.error || options.error > 0;
    FilmSettings settings =
        film_settings(description, *world, layers, choice.entry->photon_layers, options.color_model);
    settings.first_pass = options.first_pass;
    const uint64_t record = options.techniques.empty() ? 0 : TechniqueRecord::bytes(settings);
    check_memory(options.memory, memory_account(compiled, settings, *choice.entry, record, limit.any()), choice);
    const WriteTime writing = limit.any() ? time_to_write(outputs, settings, options.half) : WriteTime();
    std::vector<std::string> lowered =
        lower_efforts(limit, start, choice, *world, settings, seed_of(options, description), writing);
    if (writing.expected() > much_writing * options.seconds)
        lowered.push_back(fmt::format("for --time: {:.1f} s are left for writing the files (fewer --layers take less)",
                                      writing.expected()));
    const std::unique_ptr<Integrator> integrator = choice.entry->create(*world, choice.settings);
    describe_passes(settings, *integrator);
    Film film(settings);

    CheckpointHeader identity = identify(options, start, description, choice, *integrator, settings);
    identity.record.report.insert(identity.record.report.end(), lowered.begin(), lowered.end());
    load_checkpoint(start, identity, film);

    const std::unique_ptr<Progress> progress = make_progress(options.quiet ? ProgressKind::none : options.progress);
    interrupts.pass_to(requests);
    if (resumed) progress->note(going_on(start, stop));
    RenderJob job{*world, *integrator, film, identity.record.integrator, identity.record.seed, stop};
    job.before = start.header.counters;
    job.notes = lowered;

    const CheckpointPlan plan = checkpoint_plan(options, start, outputs.front());
    std::optional<Checkpointer> checkpointer;
    if (!plan.path.empty()) {
        checkpointer.emplace(plan, identity);
        job.observers.push_back(&*checkpointer);
    }
    std::optional<TechniqueRecord> techniques;
    if (!options.techniques.empty()) {
        techniques.emplace(settings, *integrator, choice.entry->name);
        job.observers.push_back(&*techniques);
    }
    job.keep_film_whole =
        techniques || (checkpointer && !plan.automatic) || std::any_of(outputs.begin(), outputs.end(), is_state_path);
    std::optional<LiveView> view;
    if (!options.display_server.empty()) {
        view.emplace(options.display_server, "dapple " + std::filesystem::path(outputs.front()).stem().string());
        job.observers.push_back(&*view);
    }

    job.writing = writing;
    if (limit.any()) job.stop.seconds = limit.left();
    RenderResult result = run(job, requests, *progress);
    report_accidents(film);
    if (shows_nothing(result)) {
        log_warning("stopped before there was anything to show: nothing is written");
        return interrupts.status();
    }
    report_lacks(result, choice);
    if (view && (result.film_whole || film.cut())) view->finish(film);
    std::vector<std::string> problems = write_results(options, identity, film, result, outputs,
                                                      checkpointer ? &*checkpointer : nullptr, requests, *progress);
    try {
        if (techniques && techniques->write(options.techniques, result)) progress->written(options.techniques);
    } catch (const UserError& error) {
        problems.emplace_back(error.what());
    }
    report_missing_images(compiled.missing_images);
    if (!problems.empty()) throw Failure(fmt::format("{}", fmt::join(problems, "; ")));
    return result.by_request && !result.incomplete.empty() ? interrupts.status() : 0;
}

Command add_render(CLI::App& app, const Invocation& invocation)
{
    const auto options = std::make_shared<RenderOptions>();
    CLI::App* parser = app.add_subcommand("render", "render a scene to image files");
    add_render_options(*parser, *options);
    return {parser, [options, invocation] {
                RenderStart start;
                start.command_line = invocation.command_line;
                start.arguments = invocation.arguments;
                start.folder = std::filesystem::current_path().string();
                return render(*options, start);
            }};
}

}  // namespace dapple::cli
