// Fills an irradiance cache before the image is rendered, coarse pixels first, so that records lie where the camera
// needs them and wide ones come before narrow ones (the overture of Krivanek and Gautron 2009, "Practical global
// illumination with irradiance caching").
//
// Deterministic and parallel: pixels go in waves. All pixels of a wave ask the cache as the waves before left it, then
// records are made for those without an answer, both in parallel; these are added in the order of the pixels. The waves
// are the pixels of grids 32, 16, 8, ... pixels wide, each in four parts, so that a record seldom stands beside one of
// its own wave; down to where a record would take more rays than the pixels that it serves, which then gather for
// themselves (4 pixels with default settings), or to a given number of records: the last wave is thinned out evenly.
// Every record is a pure function of (world, seed, epoch, pixel).
#pragma once

#include "dapple/density/irradiance_cache.h"
#include "dapple/integrators/photon_gather.h"

namespace dapple {

struct OvertureSettings {
    int rays = 256;         // per record, all wavelength sets together
    int pixel_rays = 32;    // that a pixel without a record gathers in an epoch
    float accuracy = 0.2f;  // radius of a record over what limits it
    int64_t most = 0;       // records; 0: as many as are wanted

    // Whether a record of a grid `stride` pixels wide takes no more rays than its pixels would.
    bool pays(int stride) const { return stride * stride * pixel_rays >= rays; }
};

// About as many records as a picture can want: a place in every cell of all grids.
int64_t places_of_records(const FilmSettings& film, const OvertureSettings& settings);

// The cache for the surfaces that eye paths meet in the film's crop window, with one set of irradiance for each of the
// epoch's maps. Empty if cancelled.
IrradianceCache make_irradiance_cache(const PassContext& context, const Film& film, const PhotonEpoch& epoch,
                                      const GatherSettings& gathering, const OvertureSettings& settings,
                                      const MovingShapes& moving);

// Whether a vertex takes its indirect light from the cache: matte reflection alone, of surfaces that stay where their
// records are.
inline bool is_cached(const Vertex& vertex, const MovingShapes& moving)
{
    return vertex.on_surface && vertex.bsdf.kind == BsdfKind::diffuse && !moving.has(vertex.geometry);
}
// The side and normal that its irradiance belongs to.
inline Vec3 cache_normal(const Vertex& vertex) { return face_forward(vertex.bsdf.frame.n, vertex.wo); }

}  // namespace dapple
