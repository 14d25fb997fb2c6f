#include "dapple/integrators/photon_gather.h"

#include "dapple/base/error.h"

#include <fmt/format.h>

namespace dapple {

GatherSettings::GatherSettings(const Settings& settings)
    : radius_pixels(static_cast<float>(settings.number("radius"))),
      fixed_radius(static_cast<float>(settings.number_or("fixedradius", 0.0))),
      caustic_nearest(static_cast<int>(settings.integer("spread"))),
      nearest(static_cast<int>(settings.integer("nearest"))),
      kernel(kernel_named(settings.word("kernel"))),
      max_depth(static_cast<int>(settings.integer("maxdepth")))
{
    if (caustic_nearest == 1) throw UserError("setting 'spread' needs 0 or at least 2 photons");
    if (nearest == 1) throw UserError("setting 'nearest' needs 0 or at least 2 photons");
}

std::string GatherSettings::describe(bool final_gather) const
{
    const std::string caustic =
        fixed_radius > 0.0f ? fmt::format("{} scene units", fixed_radius) : fmt::format("{} px", radius_pixels);
    std::string_view used = kernel_names[static_cast<size_t>(kernel)];
    if (!final_gather)
        return nearest > 0 ? fmt::format(
                                 "photons: the {} nearest in the first epoch, narrower discs from epoch to epoch; "
                                 "{} kernel",
                                 nearest, used)
                           : fmt::format("photons within {} in the first epoch; {} kernel", caustic, used);
    return fmt::format("caustics: photons within {} in the first epoch; other light: {}; {} kernel", caustic,
                       nearest > 0 ? fmt::format("discs of about {}, narrower from epoch to epoch", nearest)
                                   : std::string("those within that radius, too"),
                       used);
}

std::vector<WeightedPhoton>& PhotonFinder::scratch()
{
    thread_local std::vector<WeightedPhoton> scratch;
    return scratch;
}

EstimateSupport PhotonFinder::find(const World& world, const Vertex& vertex, const PhotonMap& map,
                                   const Bandwidth& bandwidth, bool caustics_alone)
{
    const SurfaceRegion region = surface_region(vertex.at.position, vertex.bsdf, vertex.wo);
    return find_covered_photons(world, map, region, bandwidth, thread_nearest_points(bandwidth.nearest), found_,
                                vertex.at.time, caustics_alone);
}

void PhotonFinder::find(const World& world, const SurfaceRegion& region, const PhotonMap& map, const PhotonDiscs& discs)
{
    discs.find(world, map, region, found_);
}

}  // namespace dapple
