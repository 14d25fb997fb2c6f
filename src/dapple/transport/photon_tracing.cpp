#include "dapple/transport/photon_tracing.h"

#include "dapple/base/parallel.h"
#include "dapple/transport/caustic_share.h"
#include "dapple/transport/emission.h"

namespace dapple {
namespace {

constexpr int64_t chunk_paths = 4096;

bool start_path(const World& world, const PhotonRequest& request, RandomStream& random, Walk& walk, bool& delta_light)
{
    Departure departure;
    const PathStart start = path_start(request.wavelengths, random.next_2d(), request.time);
    if (!emit(world, start, random, walk, departure)) return false;
    delta_light = !can_be_met(world.lights.list[departure.light.value]);
    return true;
}

void trace_one(const World& world, const PhotonRequest& request, int64_t index, std::vector<Photon>& out)
{
    RandomStream random = light_path_stream(request.seed, request.stream, index);
    Walk walk;
    bool delta_light = false;
    if (!start_path(world, request, random, walk, delta_light)) return;
    bool caustic = request.mark_caustics || request.caustic_only;  // true with the product of s so far
    for (;;) {
        if (!walk.leave(world, random)) return;
        if (caustic && walk.pdf_direction() > 0.0f) {
            const float share = narrow_share(walk.pdf_direction());
            caustic = share > 0.0f && random.next() < share;
        }
        if (request.caustic_only && !caustic) return;
        const Vertex* vertex = walk.arrive(world, random);
        if (!vertex) return;
        if (vertex->on_surface && !vertex->is_delta()) {
            PathEvents events = walk.events();
            events.add_surface(false);
            const PathClass path_class = classify({}, events);
            // On narrow surfaces, too: a disc round a place on a wide one beside them would lack theirs.
            const bool marked = caustic && path_class != PathClass::direct;
            if (request.caustic_only ? marked : request.keep_direct || path_class != PathClass::direct)
                out.push_back({vertex->at.position, vertex->wo, face_forward(vertex->at.n_geometric, vertex->wo),
                               walk.arriving(), static_cast<uint8_t>(walk.light_group.value),
                               static_cast<uint8_t>(path_class), delta_light, marked});
            if (request.caustic_only && vertex->bsdf.is_matte()) return;
        }
        if (walk.depth() >= request.max_depth || !walk.survive_roulette(random)) return;
    }
}

}  // namespace

std::vector<std::vector<Photon>> trace_photons(const World& world, const PhotonRequest& request)
{
    const int64_t chunks = (request.paths + chunk_paths - 1) / chunk_paths;
    std::vector<std::vector<Photon>> batches(static_cast<size_t>(chunks));
    parallel_for_ranges(request.paths, chunk_paths, [&](int64_t begin, int64_t end) {
        if (request.cancel && request.cancel->load(std::memory_order_relaxed)) return;
        std::vector<Photon>& batch = batches[static_cast<size_t>(begin / chunk_paths)];
        for (int64_t i = begin; i < end; ++i) trace_one(world, request, i, batch);
    });
    return batches;
}

void trace_photons(const World& world, const PhotonRequest& request, int64_t begin, int64_t end,
                   std::vector<Photon>& out)
{
    for (int64_t i = begin; i < end; ++i) trace_one(world, request, i, out);
}

}  // namespace dapple
