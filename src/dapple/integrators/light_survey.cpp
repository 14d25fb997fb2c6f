#include "dapple/integrators/light_survey.h"

#include "dapple/integrators/wavelength_sets.h"
#include "dapple/transport/emission.h"
#include "dapple/transport/photon_tracing.h"

namespace dapple {

CausticShare caustic_share(const World& world)
{
    constexpr int64_t paths = 8192;
    constexpr int most_deltas = 100;
    double all = 0.0;
    CausticShare caustic;
    for (int64_t path = 0; path < paths; ++path) {
        RandomStream random = light_path_stream(0, static_cast<uint64_t>(StreamPurpose::photon), path);
        const Wavelengths wavelengths = choose_wavelengths(ColorModel::spectral, random.next());
        Walk walk;
        Departure departure;
        if (!emit(world, path_start(wavelengths, random.next_2d()), random, walk, departure)) continue;
        while (const Vertex* vertex = walk.next(world, random)) {
            if (walk.events().diffuse > 0) break;
            if (!vertex->is_delta()) {
                const double light = walk.arriving().average();
                all += light;
                if (walk.events().specular_before_first) {
                    caustic.all += light;
                    if (!can_be_met(world.lights.list[departure.light.value])) caustic.of_points += light;
                }
            }
            if (!vertex->has_delta_lobe() || walk.depth() >= most_deltas) break;
        }
    }
    if (all == 0.0) return {};
    return {caustic.all / all, caustic.of_points / all};
}

}  // namespace dapple
