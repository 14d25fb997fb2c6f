#include "dapple/film/film_sums.h"

#include <sys/mman.h>

#include <cstdlib>
#include <new>

namespace dapple {
namespace {

std::vector<std::string> suffixed(const std::string& prefix, std::string_view letters)
{
    std::vector<std::string> names;
    for (const char letter : letters) names.push_back(prefix.empty() ? std::string(1, letter) : prefix + '.' + letter);
    return names;
}

}  // namespace

Plane::Plane(std::vector<std::string> channel_names, size_t pixels)
    : channel_names_(std::move(channel_names)),
      size_(pixels * channel_names_.size()),
      sums_(static_cast<Fixed128*>(std::calloc(size_, sizeof(Fixed128))), &std::free)
{
    if (!sums_) throw std::bad_alloc();
    // Splats go to random places: large pages save most of the address translation. Only a wish, hence unchecked.
    void* page = sums_.get();
    size_t left = size_ * sizeof(Fixed128);
    if (std::align(4096, 1, page, left)) madvise(page, left, MADV_HUGEPAGE);
}

Film::Sums::Sums(const FilmSettings& settings)
    : crop_min(settings.crop_min), crop_size(settings.crop_max - settings.crop_min)
{
    first_radiance = 0;
    if (settings.class_layers)
        for (const std::string_view name : path_class_names) add_plane(suffixed(std::string(name), "RGB"));
    else
        add_plane(suffixed("", "RGB"));
    radiance_planes = static_cast<int>(planes.size());
    first_group = radiance_planes;
    groups = settings.light_groups.size();
    for (const std::string& name : settings.light_groups)
        add_plane(suffixed("lightgroup_" + light_group_label(name), "RGB"));
    if (settings.guide_layers) {
        albedo = add_plane(suffixed("Albedo", "RGB"));
        normal = add_plane(suffixed("N", "XYZ"));
        depth = add_plane({"Z"});
        position = add_plane(suffixed("P", "XYZ"));
    }
    if (settings.photon_layers) {
        photon_density = add_plane({"photons.density"});
        photon_radius = add_plane({"photons.radius"});
    }
}

int Film::Sums::add_plane(std::vector<std::string> channel_names)
{
    planes.emplace_back(std::move(channel_names), pixels());
    return static_cast<int>(planes.size()) - 1;
}

}  // namespace dapple
