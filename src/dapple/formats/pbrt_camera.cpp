// Camera, film, filter, sampler, integrator, accelerator and options of pbrt-v4.
#include "dapple/formats/pbrt_builder.h"
#include "dapple/formats/pbrt_legacy.h"
#include "dapple/scene/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>

namespace dapple {
namespace {

constexpr int largest_resolution = 65536;

void read_lens_and_window(PbrtParameters& parameters, scene::Camera& camera)
{
    camera.lens_radius = parameters.number("lensradius", 0.0f, PbrtRange::not_negative);
    camera.focal_distance = parameters.number("focaldistance", camera.focal_distance, PbrtRange::positive);
    camera.frame_aspect_ratio = parameters.optional_number("frameaspectratio", PbrtRange::positive);
    const std::vector<float> window = parameters.numbers("screenwindow");
    if (window.empty()) return;
    if (window.size() != 4)
        throw UserError(parameters.where("screenwindow"),
                        fmt::format("parameter 'screenwindow' takes 4 numbers, got {}", window.size()));
    if (window[0] == window[1] || window[2] == window[3])
        throw UserError(parameters.where("screenwindow"), "parameter 'screenwindow' is empty");
    camera.screen_window = {window[0], window[1], window[2], window[3]};
}

void read_shutter(PbrtParameters& parameters, scene::Camera& camera)
{
    camera.shutter_open = parameters.number("shutteropen", 0.0f);
    camera.shutter_close = parameters.number("shutterclose", 1.0f);
    if (camera.shutter_close <= camera.shutter_open)
        throw UserError(parameters.at(), fmt::format("the shutter never opens: 'shutteropen' {} is not before "
                                                     "'shutterclose' {}",
                                                     camera.shutter_open, camera.shutter_close));
}

float angle_between_0_and_180(PbrtParameters& parameters, std::string_view name, float fallback)
{
    const float angle = parameters.number(name, fallback, PbrtRange::positive);
    if (angle >= 180.0f)
        throw UserError(parameters.where(name),
                        fmt::format("parameter '{}' must be less than 180, got {}", name, angle));
    return angle;
}

// Pixel bounds from "pixelbounds" (pixels) or "cropwindow" (fractions), as x min, x max, y min, y max; the latter wins.
void read_crop(PbrtParameters& parameters, scene::Film& film)
{
    const std::vector<int> bounds = parameters.integers("pixelbounds");
    const std::vector<float> window = parameters.numbers("cropwindow");
    const auto check_four = [&](std::string_view name, size_t count) {
        if (count != 0 && count != 4)
            throw UserError(parameters.where(name), fmt::format("parameter '{}' takes 4 numbers, got {}", name, count));
    };
    check_four("pixelbounds", bounds.size());
    check_four("cropwindow", window.size());

    film.crop_min = {0, 0};
    film.crop_max = film.resolution;
    if (!window.empty()) {
        if (!bounds.empty())
            parameters.context().warn(parameters.where("pixelbounds"),
                                      "'pixelbounds' is ignored: 'cropwindow' is given too");
        for (int axis = 0; axis < 2; ++axis) {
            const auto [low, high] = std::minmax(window[2 * axis], window[2 * axis + 1]);
            film.crop_min[axis] = static_cast<int>(std::ceil(film.resolution[axis] * clamp01(low)));
            film.crop_max[axis] = static_cast<int>(std::ceil(film.resolution[axis] * clamp01(high)));
        }
    } else if (!bounds.empty()) {
        for (int axis = 0; axis < 2; ++axis) {
            film.crop_min[axis] = std::max(0, bounds[2 * axis]);
            film.crop_max[axis] = std::min(film.resolution[axis], bounds[2 * axis + 1]);
            if (film.crop_min[axis] != bounds[2 * axis] || film.crop_max[axis] != bounds[2 * axis + 1])
                parameters.context().warn(parameters.where("pixelbounds"),
                                          "'pixelbounds' reaches beyond the image: cut");
        }
    }
    if (film.crop_min.x >= film.crop_max.x || film.crop_min.y >= film.crop_max.y)
        throw UserError(parameters.where(window.empty() ? "pixelbounds" : "cropwindow"), "the crop window is empty");
}

std::string plain_text(const PbrtParameter& parameter)
{
    if (parameter.integers.size() == 1) return fmt::format("{}", parameter.integers[0]);
    if (parameter.numbers.size() == 1) return fmt::format("{}", parameter.numbers[0]);
    if (parameter.booleans.size() == 1) return parameter.booleans[0] ? "true" : "false";
    if (parameter.strings.size() == 1) return parameter.strings[0];
    throw UserError(parameter.where(), fmt::format("parameter '{}' takes one value", shown(parameter.name)));
}

}  // namespace

scene::Camera read_camera(const std::string& type, PbrtParameters& parameters)
{
    constexpr std::string_view types[] = {"perspective", "orthographic", "spherical", "realistic"};
    scene::Camera camera;
    camera.at = parameters.at();
    read_shutter(parameters, camera);
    if (type == "perspective" || type == "orthographic") {
        camera.kind = type == "perspective" ? scene::Camera::Kind::perspective : scene::Camera::Kind::orthographic;
        read_lens_and_window(parameters, camera);
        if (type == "perspective") camera.fov = angle_between_0_and_180(parameters, "fov", 90.0f);
    } else if (type == "spherical") {
        constexpr std::string_view mappings[] = {"equalarea", "equirectangular"};
        camera.kind = scene::Camera::Kind::spherical;
        camera.mapping = static_cast<scene::Camera::SphericalMapping>(parameters.word("mapping", 0, mappings));
        camera.focal_distance = 1e30f;
        read_lens_and_window(parameters, camera);
    } else if (type == "realistic") {
        camera.fov = 40.0f;
        parameters.context().warn(parameters.at(),
                                  "camera 'realistic' is not supported: a perspective camera of fov 40 "
                                  "stands in for it");
        parameters.ignore_rest();
    } else {
        const bool was_v3 = type == "environment";
        fail_type("camera", type, types, parameters.at(),
                  was_v3 ? "; pbrt-v3's camera 'environment' is now 'spherical'" : "");
    }
    return camera;
}

scene::Film read_film(const std::string& type, PbrtParameters& parameters)
{
    constexpr std::string_view types[] = {"rgb", "gbuffer", "spectral"};
    scene::Film film;
    film.at = parameters.at();
    if (type == "gbuffer") {
        constexpr std::string_view spaces[] = {"camera", "world"};
        film.kind = scene::Film::Kind::gbuffer;
        film.guides_in_camera_space = parameters.word("coordinatesystem", 0, spaces) == 0;
    } else if (type == "spectral") {
        parameters.context().warn(parameters.at(), "film 'spectral' is not supported: film 'rgb' stands in for it");
        for (std::string_view name : {"nbuckets", "lambdamin", "lambdamax"}) parameters.has(name);
    } else if (type != "rgb") {
        fail_type("film", type, types, parameters.at(), legacy_hint(LegacyKind::film, type));
    }
    film.resolution.x = parameters.integer("xresolution", 1280, 1, largest_resolution);
    film.resolution.y = parameters.integer("yresolution", 720, 1, largest_resolution);
    read_crop(parameters, film);
    film.filename = parameters.string("filename", film.filename);
    film.half_precision = parameters.boolean("savefp16", true);
    film.diagonal = parameters.number("diagonal", 35.0f, PbrtRange::positive);
    film.sensor = scene::sensor_names()[parameters.word("sensor", 0, scene::sensor_names())];
    film.iso = parameters.number("iso", 100.0f, PbrtRange::positive);
    film.white_balance = parameters.number("whitebalance", 0.0f, PbrtRange::not_negative);
    parameters.ignore("maxcomponentvalue", "samples are never clamped");
    return film;
}

scene::Filter read_filter(const std::string& type, PbrtParameters& parameters)
{
    constexpr std::string_view types[] = {"box", "triangle", "gaussian", "mitchell", "sinc"};
    constexpr float radii[] = {0.5f, 2.0f, 1.5f, 2.0f, 4.0f};
    const auto found = std::find(std::begin(types), std::end(types), type);
    if (found == std::end(types)) fail_type("filter", type, types, parameters.at());

    scene::Filter filter;
    filter.at = parameters.at();
    filter.kind = static_cast<scene::Filter::Kind>(found - std::begin(types));
    const float radius = radii[found - std::begin(types)];
    filter.radius.x = parameters.number("xradius", radius, PbrtRange::positive);
    filter.radius.y = parameters.number("yradius", radius, PbrtRange::positive);
    constexpr float largest_radius = 64.0f;
    if (std::max(filter.radius.x, filter.radius.y) > largest_radius)
        throw UserError(parameters.at(), fmt::format("the filter's radius exceeds {} pixels", largest_radius));
    switch (filter.kind) {
        case scene::Filter::Kind::gaussian: filter.sigma = parameters.number("sigma", 0.5f, PbrtRange::positive); break;
        case scene::Filter::Kind::mitchell:
            filter.b = parameters.number("B", 1.0f / 3.0f);
            filter.c = parameters.number("C", 1.0f / 3.0f);
            break;
        case scene::Filter::Kind::sinc: filter.tau = parameters.number("tau", 3.0f, PbrtRange::positive); break;
        default: break;
    }
    return filter;
}

scene::Sampler read_sampler(const std::string& type, PbrtParameters& parameters)
{
    constexpr std::string_view types[] = {"halton",  "sobol",       "paddedsobol", "zsobol",
                                          "pmj02bn", "independent", "stratified"};
    constexpr int most_samples = 1 << 30;
    if (std::find(std::begin(types), std::end(types), type) == std::end(types))
        fail_type("sampler", type, types, parameters.at(), legacy_hint(LegacyKind::sampler, type));
    scene::Sampler sampler;
    sampler.at = parameters.at();
    sampler.name = type;
    if (type == "stratified") {
        const int x = parameters.integer("xsamples", 4, 1, 1 << 15);
        const int y = parameters.integer("ysamples", 4, 1, 1 << 15);
        sampler.pixel_samples = x * y;
        parameters.boolean("jitter", true);
    } else {
        sampler.pixel_samples = parameters.integer("pixelsamples", type == "independent" ? 4 : 16, 1, most_samples);
        parameters.string("randomization", "");
    }
    if (parameters.has("seed"))
        sampler.seed = parameters.integer("seed", 0, std::numeric_limits<int>::min(), std::numeric_limits<int>::max());
    return sampler;
}

scene::Integrator read_integrator(const std::string& type, PbrtParameters& parameters)
{
    scene::Integrator integrator;
    integrator.at = parameters.at();
    integrator.name = type;
    for (const PbrtParameter& parameter : parameters.own())
        integrator.parameters.push_back({parameter.name, plain_text(parameter), parameter.where()});
    parameters.ignore_rest();  // whoever knows the integrators checks their names
    return integrator;
}

void PbrtBuilder::camera(const std::string& type, PbrtParameters parameters)
{
    scene_.camera = read_camera(type, parameters);
    parameters.finish();
    const SourceLocation& at = parameters.at();
    const TransformPair world_from_camera{inverse_or_throw(state_.transform.start, at, "the camera's transform"),
                                          inverse_or_throw(state_.transform.end, at, "the camera's transform")};
    coordinate_systems_["camera"] = world_from_camera;
    scene_.camera.world_from_camera = {world_from_camera.start, world_from_camera.end, state_.start_time,
                                       state_.end_time};
    scene_.camera.medium = state_.outside;
}

void PbrtBuilder::film(const std::string& type, PbrtParameters parameters)
{
    scene_.film = read_film(type, parameters);
    scene_.film.color_space = state_.color_space;
    parameters.finish();
}

void PbrtBuilder::filter(const std::string& type, PbrtParameters parameters)
{
    scene_.filter = read_filter(type, parameters);
    parameters.finish();
}

void PbrtBuilder::sampler(const std::string& type, PbrtParameters parameters)
{
    scene_.sampler = read_sampler(type, parameters);
    parameters.finish();
}

void PbrtBuilder::integrator(const std::string& type, PbrtParameters parameters)
{
    scene_.integrator = read_integrator(type, parameters);
}

void PbrtBuilder::accelerator(const std::string& type, PbrtParameters parameters)
{
    constexpr std::string_view types[] = {"bvh", "kdtree"};
    if (std::find(std::begin(types), std::end(types), type) == std::end(types))
        fail_type("accelerator", type, types, parameters.at());
    context_.warn(parameters.at(), "Accelerator is ignored: rays are always traced with Embree");
}

void PbrtBuilder::option(const std::string& name, const PbrtToken& value, const SourceLocation& at)
{
    constexpr std::string_view known[] = {"seed",
                                          "disablepixeljitter",
                                          "disablewavelengthjitter",
                                          "forcediffuse",
                                          "disabletexturefiltering",
                                          "displacementedgescale",
                                          "msereferenceimage",
                                          "msereferenceout",
                                          "rendercoordsys",
                                          "pixelstats",
                                          "wavefront"};
    std::string plain;  // pbrt takes any case, with or without '_' and '-'; "bool x" is its old form
    for (char c : name.substr(name.rfind(' ') + 1))
        if (c != '_' && c != '-') plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (!scene::contains(known, plain)) fail_type("option", name, known, at);

    const auto boolean = [&] {
        if (value.text != "true" && value.text != "false")
            throw UserError(at, fmt::format("option '{}' must be true or false, got '{}'", plain, shown(value.text)));
        return value.text == "true";
    };
    if (plain == "seed") {
        const char* end = value.text.data() + value.text.size();
        const auto result = std::from_chars(value.text.data(), end, scene_.options.seed);
        if (result.ec != std::errc{} || result.ptr != end)
            throw UserError(at, fmt::format("option 'seed' must be an integer, got '{}'", shown(value.text)));
    } else if (plain == "disablepixeljitter") {
        scene_.options.disable_pixel_jitter = boolean();
    } else if (plain == "disablewavelengthjitter") {
        scene_.options.disable_wavelength_jitter = boolean();
    } else if (plain == "forcediffuse") {
        scene_.options.force_diffuse = boolean();
    } else {
        context_.warn(at, fmt::format("option '{}' has no meaning here: ignored", plain));
    }
}

}  // namespace dapple
