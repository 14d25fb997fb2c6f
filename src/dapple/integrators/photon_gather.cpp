#include "dapple/integrators/photon_gather.h"

#include "dapple/base/error.h"

#include <fmt/format.h>

namespace dapple {

GatherSettings::GatherSettings(const Settings& settings)
    : radius_pixels(static_cast<float>(settings.number("radius"))),
      fixed_radius(settings.is_auto("fixedradius") ? 0.0f : static_cast<float>(settings.number("fixedradius"))),
      nearest(static_cast<int>(settings.integer("nearest"))),
      kernel(kernel_named(settings.word("kernel"))),
      max_depth(static_cast<int>(settings.integer("maxdepth")))
{
    if (nearest == 1) throw UserError("setting 'nearest' needs 0 or at least 2 photons");
}

std::string GatherSettings::describe() const
{
    return fmt::format(
        "caustic radius {} in the first epoch, {} nearest photons, {} kernel",
        fixed_radius > 0.0f ? fmt::format("{} m", fixed_radius) : fmt::format("{} pixel footprints", radius_pixels),
        nearest, kernel_names[static_cast<size_t>(kernel)]);
}

std::vector<WeightedPhoton>& PhotonFinder::scratch()
{
    thread_local std::vector<WeightedPhoton> scratch;
    return scratch;
}

EstimateSupport PhotonFinder::find(const Vertex& vertex, const PhotonMap& map, const Bandwidth& bandwidth)
{
    thread_local NearestPoints nearest(2);
    if (bandwidth.nearest != 0 && nearest.k() != bandwidth.nearest) nearest = NearestPoints(bandwidth.nearest);
    const SurfaceRegion region{vertex.at.position, face_forward(vertex.at.n_geometric, vertex.wo),
                               vertex.bsdf.transmits() ? PhotonSide::both : PhotonSide::same};
    found_.clear();
    return visit_photons(map, region, bandwidth, nearest, [&](uint32_t slot, float weight) {
        found_.push_back({slot, weight});
    });
}

}  // namespace dapple
