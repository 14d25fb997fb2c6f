// The film of a scene description: resolution, crop, filter, sensor and layers.
#include "dapple/render/film_settings.h"

#include "dapple/base/error.h"
#include "dapple/scene/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string_view>

namespace dapple {
namespace {

constexpr int largest_resolution = 65536;

Filter make_filter(const scene::Filter& filter)
{
    static constexpr std::array kinds = {Filter::Kind::box, Filter::Kind::triangle, Filter::Kind::gaussian,
                                         Filter::Kind::mitchell, Filter::Kind::sinc};
    FilterShape shape;
    shape.kind = kinds[static_cast<size_t>(filter.kind)];
    shape.radius = filter.radius;
    shape.sigma = filter.sigma;
    shape.b = filter.b;
    shape.c = filter.c;
    shape.tau = filter.tau;
    return Filter(shape);
}

// Reads `count` numbers separated by `separator`; false when the text is anything else.
template <size_t count>
bool read_numbers(const std::string& text, char separator, std::array<double, count>& numbers)
{
    std::istringstream in(text);
    for (size_t i = 0; i < count; ++i) {
        if (i > 0 && in.get() != separator) return false;
        if (!(in >> numbers[i]) || !std::isfinite(numbers[i])) return false;
    }
    return in.peek() == std::istringstream::traits_type::eof();
}

// pbrt's rounding of crop windows: pixels from ceil(size * part) on, so that neighbouring windows never share a pixel.
int crop_pixel(double pixel, int size) { return static_cast<int>(std::clamp(std::ceil(pixel), 0.0, double(size))); }
int crop_edge(double part, int size) { return crop_pixel(size * part, size); }

// "; 'classes' has the layer 'caustic'" where a layer is named instead of the word that brings it.
std::string whose_layer(const std::string& word)
{
    static constexpr std::array<std::string_view, 4> guides = {"Albedo", "N", "Z", "P"};
    if (word.empty()) return "";
    std::string_view choice = "classes", layer = nearest_word(word, path_class_names);
    if (layer.empty()) choice = "guides", layer = nearest_word(word, guides);
    return layer.empty() ? "" : "; '" + std::string(choice) + "' has the layer '" + std::string(layer) + "'";
}

}  // namespace

LayerChoice LayerChoice::parse(const std::string& text)
{
    static constexpr std::array<std::string_view, 7> words = {"all",    "beauty",  "guides", "classes",
                                                              "groups", "photons", "error"};
    LayerChoice choice{false, false, false, false, false};
    std::istringstream in(text + ",");
    for (std::string word; std::getline(in, word, ',');) {
        if (word == "all")
            choice.guides = choice.classes = choice.groups = choice.photons = true;
        else if (word == "error")
            choice.error = true;
        else if (word == "guides")
            choice.guides = true;
        else if (word == "classes")
            choice.classes = true;
        else if (word == "groups")
            choice.groups = true;
        else if (word == "photons")
            choice.photons = true;
        else if (word != "beauty")
            throw UserError("--layers takes words of all,beauty,guides,classes,groups,photons,error, not '" + word +
                            "'" + whose_layer(word) + did_you_mean(word, words));
    }
    return choice;
}

FilmSettings film_settings(const scene::Description& description, const World& world, const LayerChoice& layers,
                           bool has_photon_layers, ColorModel color_model)
{
    const scene::Film& film = description.film;
    FilmSettings settings;
    settings.resolution = film.resolution;
    settings.crop_min = film.crop_min;
    settings.crop_max = film.crop_max;
    settings.filter = make_filter(description.filter);
    settings.sensor = make_sensor(film.sensor, std::string(scene::color_space_name(film.color_space)),
                                  film.white_balance, film.imaging_ratio(description.camera));
    const bool fixed = color_model == ColorModel::spectral && description.options.disable_wavelength_jitter;
    settings.color_model = fixed ? ColorModel::fixed_spectral : color_model;
    settings.pixel_centers = description.options.disable_pixel_jitter;
    if (layers.groups && world.light_group_names.size() > 1) settings.light_groups = world.light_group_names;
    settings.class_layers = layers.classes;
    settings.guide_layers = layers.guides;
    settings.guides_in_camera_space = film.kind == scene::Film::Kind::gbuffer && film.guides_in_camera_space;
    settings.photon_layers = layers.photons && has_photon_layers;
    settings.error_layer = layers.error;
    return settings;
}

void describe_passes(FilmSettings& settings, const Integrator& integrator)
{
    settings.correlated_passes = integrator.correlated_passes();
    settings.fading_bias = integrator.bias_scale(0) > 0.0;
    settings.bias_scale = [&integrator](uint32_t pass) { return integrator.bias_scale(pass); };
}

Int2 parse_resolution(const std::string& text)
{
    std::array<double, 2> size{};
    const auto valid = [](double side) { return std::floor(side) == side && side >= 1 && side <= largest_resolution; };
    if (!read_numbers(text, 'x', size) || !valid(size[0]) || !valid(size[1]))
        throw UserError("--resolution takes WIDTHxHEIGHT such as 640x480, each from 1 to " +
                        std::to_string(largest_resolution) + ", not '" + text + "'");
    return {static_cast<int>(size[0]), static_cast<int>(size[1])};
}

void set_resolution(scene::Film& film, Int2 resolution)
{
    const Int2 old = film.resolution;
    film.resolution = resolution;
    for (int axis = 0; axis < 2; ++axis) {
        const auto scaled = [&](int edge) {
            return crop_pixel(static_cast<double>(edge) * film.resolution[axis] / old[axis], film.resolution[axis]);
        };
        film.crop_min[axis] = std::min(scaled(film.crop_min[axis]), film.resolution[axis] - 1);
        film.crop_max[axis] = std::max(scaled(film.crop_max[axis]), film.crop_min[axis] + 1);
    }
}

CropEdges parse_crop(const std::string& text)
{
    CropEdges edges{};
    const bool numbers = read_numbers(text, ',', edges) && *std::min_element(edges.begin(), edges.end()) >= 0;
    if (!numbers || edges[0] >= edges[1] || edges[2] >= edges[3])
        throw UserError(
            "--crop takes x0,x1,y0,y1 with x0 < x1 and y0 < y1, as parts of the image such as 0.25,0.75,0,1 or as "
            "pixels, not '" +
            text + "'");
    return edges;
}

void set_crop(scene::Film& film, const CropEdges& edges)
{
    const bool parts = *std::max_element(edges.begin(), edges.end()) <= 1;
    for (int axis = 0; axis < 2; ++axis) {
        const int size = film.resolution[axis];
        // Pixels are not taken as parts of the image, whose rounding could go past a whole number.
        const auto edge = [&](double value) { return parts ? crop_edge(value, size) : crop_pixel(value, size); };
        film.crop_min[axis] = edge(edges[static_cast<size_t>(2 * axis)]);
        film.crop_max[axis] = edge(edges[static_cast<size_t>(2 * axis + 1)]);
        if (film.crop_min[axis] >= film.crop_max[axis])
            throw UserError(fmt::format("--crop {:g},{:g},{:g},{:g} holds no pixel of an image of {}x{}", edges[0],
                                        edges[1], edges[2], edges[3], film.resolution.x, film.resolution.y));
    }
}

}  // namespace dapple
