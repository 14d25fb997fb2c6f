#include "dapple/integrators/technique_films.h"

#include <fmt/format.h>

namespace dapple {
namespace {

// Layers of the shorter paths: an edge count k has k + 1 joined and k - 1 merged techniques.
int first_layer(int edges) { return 1 + (edges - 1) * edges; }

std::vector<std::string> layer_names(int longest)
{
    std::vector<std::string> names = {"rest"};
    for (int edges = 1; edges <= longest; ++edges) {
        for (int s = 0; s <= edges; ++s) names.push_back(fmt::format("s{}t{}", s, edges + 1 - s));
        for (int s = 2; s <= edges; ++s) names.push_back(fmt::format("m{}t{}", s, edges + 2 - s));
    }
    return names;
}

}  // namespace

FilmSettings TechniqueFilms::film_settings(const FilmSettings& like, int longest)
{
    FilmSettings settings = like;
    settings.light_groups = layer_names(longest);
    settings.class_layers = settings.guide_layers = settings.photon_layers = settings.error_layer = false;
    return settings;
}

TechniqueFilms::TechniqueFilms(const FilmSettings& like, int longest)
    : longest_(longest),
      names_(layer_names(longest)),
      weighted_(film_settings(like, longest)),
      unweighted_(film_settings(like, longest))
{
}

LightGroup TechniqueFilms::layer(const Technique& technique) const
{
    const int edges = technique.edges();
    if (edges > longest_) return LightGroup(0u);
    const int place = technique.merged ? edges + 1 + technique.s - 2 : technique.s;
    return LightGroup(static_cast<uint32_t>(first_layer(edges) + place));
}

void TechniqueFilms::splat(const Vec2& raster, const Vec3& sensor_rgb, float weight, const Technique& technique)
{
    weighted_.splat(raster, sensor_rgb * weight, PathClass::direct, layer(technique));
    unweighted_.splat(raster, sensor_rgb, PathClass::direct, layer(technique));
}

void TechniqueFilms::end_pass()
{
    weighted_.end_pass();
    unweighted_.end_pass();
}

Image TechniqueFilms::layers(std::vector<std::string>& channel_names) const
{
    // The group layers of both films, one after the other: the first three channels of each are its beauty.
    const size_t count = names_.size() * 3;
    channel_names.clear();
    Image result;
    for (const Film* film : {&weighted_, &unweighted_}) {
        std::vector<std::string> names;
        const Image image = film->layers(names);
        const std::string prefix = film == &weighted_ ? "weighted." : "unweighted.";
        if (result.empty()) result = Image(image.width, image.height, static_cast<int>(2 * count));
        const size_t offset = film == &weighted_ ? 0 : count;
        const std::string group = "lightgroup_";
        size_t to = 0;
        for (size_t c = 0; c < names.size(); ++c) {
            if (names[c].compare(0, group.size(), group) != 0) continue;
            channel_names.push_back(prefix + names[c].substr(group.size()));
            for (size_t pixel = 0; pixel < size_t(image.width) * image.height; ++pixel)
                result.pixels[pixel * 2 * count + offset + to] =
                    image.pixels[pixel * static_cast<size_t>(image.channels) + c];
            ++to;
        }
    }
    return result;
}

TechniqueFilms::Sample::Sample(TechniqueFilms& films, Int2 pixel)
    : films_(films),
      pixel_(pixel),
      weighted_(static_cast<int>(films.names_.size())),
      unweighted_(static_cast<int>(films.names_.size()))
{
}

void TechniqueFilms::Sample::add(const Vec3& sensor_rgb, float weight, const Technique& technique)
{
    const LightGroup layer = films_.layer(technique);
    weighted_.add(sensor_rgb * weight, PathClass::direct, layer);
    unweighted_.add(sensor_rgb, PathClass::direct, layer);
}

TechniqueFilms::Sample::~Sample()
{
    films_.weighted_.add_pixel(pixel_, weighted_, 1);
    films_.unweighted_.add_pixel(pixel_, unweighted_, 1);
}

}  // namespace dapple
