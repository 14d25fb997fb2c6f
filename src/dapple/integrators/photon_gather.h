// What photon mapping and irradiance caching share: the way from the eye to the first surface that is no delta, the
// estimates from photon maps there, and gather rays.
// Jensen 1996, "Global illumination using photon maps".
//
// The light that leaves a vertex x is split into direct light (sampled), caustics (caustic map, kernel of a small
// radius) and indirect light. A gather ray from x asks the global map, or irradiance computed beforehand, at the first
// vertex y that is no delta; this gives all light that leaves y, but for what a coat mirrors, for which the ray goes
// on. Where y is nearer than estimates there are wide, or is rough glass or metal, it goes on, too: direct light and
// caustics are taken at y, and the next vertex is asked. What narrow lobes threw on x or y is shared with photons
// (transport/caustic_share.h, caustic_run.h). How wide estimates are is told by other light paths
// (density/surface_places.h), so that the choice favours neither dense photons nor sparse ones.
#pragma once

#include "dapple/density/estimate.h"
#include "dapple/integrators/caustic_run.h"
#include "dapple/integrators/photon_maps.h"
#include "dapple/integrators/pixel_loop.h"
#include "dapple/integrators/surface_coverage.h"
#include "dapple/transport/connect.h"

namespace dapple {

// How estimates and gather rays are made. See the table of settings for each (photon_maps.h).
struct GatherSettings {
    float radius_pixels = 2.5f;  // of caustic estimates in the first epoch, in pixel footprints
    float fixed_radius = 0.0f;   // the same [m]; 0: from the footprint
    int caustic_nearest = 8;     // fewer photons than that within the radius: it grows, up to so many times
    float caustic_growth = 3.0f;
    int nearest = 50;  // photons per estimate of the global map; 0: all within the caustic radius
    KernelKind kernel = KernelKind::epanechnikov;
    int max_depth = 100;

    GatherSettings() = default;
    explicit GatherSettings(const Settings& settings);

    // shrinkage: of radii, over those of the first epoch.
    Bandwidth global_bandwidth(float caustic_radius, float shrinkage) const
    {
        return {nearest, nearest == 0 ? caustic_radius : infinity, kernel, 0.0f, shrinkage};
    }
    Bandwidth caustic_bandwidth(float radius) const
    {
        if (caustic_nearest == 0) return {0, radius, kernel};
        return {caustic_nearest, radius * caustic_growth, kernel, radius};
    }
    // One line for reports.
    std::string describe(bool final_gather) const;
};

// Finds the photons of estimates. Uses scratch space of the thread, so that there is one finder per thread at a time.
class PhotonFinder {
public:
    // The photons of the map that take part in an estimate at the vertex are then in found(), with weights that allow
    // for edges of the surface. caustics_alone: those of that class.
    EstimateSupport find(const World& world, const Vertex& vertex, const PhotonMap& map, const Bandwidth& bandwidth,
                         bool caustics_alone = false);
    // The same for photons that have discs of their own.
    void find(const World& world, const SurfaceRegion& region, const PhotonMap& map, const PhotonDiscs& discs);
    const std::vector<WeightedPhoton>& found() const { return found_; }

private:
    static std::vector<WeightedPhoton>& scratch();
    std::vector<WeightedPhoton>& found_ = scratch();
};

// Which light a gather ray brings: all, or what comes from wide surfaces (is_wide) or from others. The first surface
// that is no delta decides. Lamps that are met before it are added to any part, unless left out (begin_at_diffuse).
enum class GatherPart { all, from_wide, from_narrow };

// Adds light to a sink, which has add(const Spectrum& radiance, PathClass, LightGroup): a pixel's sample, or a sum.
template <class Sink>
class PhotonGather {
public:
    // shrinkage: of radii, over those of the first epoch.
    PhotonGather(const GatherSettings& settings, const World& world, const PhotonMapSet& maps, float shrinkage,
                 bool light_groups, RandomStream& random, Sink& sink)
        : settings_(settings),
          world_(world),
          maps_(maps),
          random_(random),
          sink_(sink),
          shrinkage_(shrinkage),
          light_groups_(light_groups)
    {
    }

    // That of all paths, where shapes move.
    const std::optional<float>& time() const { return maps_.time; }

    // Way from the camera to the first D, which radii follow [m].
    void set_eye_distance(float distance) { eye_distance_ = distance; }
    // What one walk counts among those that are averaged.
    void set_share(float share) { share_ = share; }
    // Walks start at a D of their own, and what lights its first ray meets is left out: direct light of that D.
    void begin_at_diffuse()
    {
        diffuse_before_ = 1;
        skip_direct_ = true;
    }

    // part: what is left of the light to this walk (CausticRun).
    void add_emission(const Walk& walk, bool weigh, float part = 1.0f)
    {
        const LightId emitter = walk.vertex().emitter;
        if (emitter.valid())
            sink_.add(met_emission(world_, walk, weigh) * (share_ * part), classify(events(walk), {}),
                      world_.lights.list[emitter.value].group);
    }

    void add_escaped(const Walk& walk, bool weigh, float part = 1.0f)
    {
        if (!walk.escaped()) return;
        for (LightId light : world_.environments)
            sink_.add(met_environment(world_, walk, light, weigh) * (share_ * part), classify(events(walk), {}),
                      world_.lights.list[light.value].group);
    }

    // By light sampling, with the MIS weight against what follow() meets.
    void add_direct(const Walk& walk, const CausticRun& run = CausticRun())
    {
        const DirectLight direct = direct_light(world_, walk, walk.vertex(), true, random_);
        if (!direct.found) return;
        PathEvents met = events(walk);
        met.add_surface(false);
        const float part = run.of_direct(share_of_light(walk.vertex(), direct.wi));
        sink_.add(direct.radiance * (share_ * part), classify(met, {}), direct.group);
    }

    EstimateSupport add_caustics(const Walk& walk, const CausticRun& run = CausticRun())
    {
        const Vertex& vertex = walk.vertex();
        const bool wide = is_wide(vertex.bsdf);
        const EstimateSupport support =
            finder_.find(world_, vertex, maps_.caustic, settings_.caustic_bandwidth(caustic_radius()), !wide);
        add_photons(walk, maps_.caustic, [&](const Vec3& wi, PathClass photon) {
            return run.of_caustic(photon, share_of_light(vertex, wi),
                                  narrow_share(pdf(vertex.bsdf, vertex.wo, wi, TransportMode::radiance)), wide);
        });
        return support;
    }

    // Direct visualisation: all light but emission from the global map.
    EstimateSupport add_map(const Walk& walk)
    {
        const EstimateSupport support =
            finder_.find(world_, walk.vertex(), maps_.global, settings_.global_bandwidth(caustic_radius(), shrinkage_));
        add_photons(walk, maps_.global, [](const Vec3&, PathClass) { return 1.0f; });
        return support;
    }

    // All light that leaves the vertex of an eye path, emission apart: sampled, from the caustic map and by gather
    // rays.
    EstimateSupport gather(const Walk& walk, int rays)
    {
        add_direct(walk);
        const EstimateSupport support = add_caustics(walk);
        share_ = 1.0f / static_cast<float>(rays);
        for (int ray = 0; ray < rays; ++ray) follow(walk);
        return support;
    }

    // One gather ray from the vertex of `walk`, until the global map stands for a vertex. At a coat it goes on with
    // probability s, for what the coat mirrors. Returns the distance of the first surface that it meets [m].
    float follow(Walk walk, GatherPart part = GatherPart::all)
    {
        float first = infinity;
        float since_last = 0.0f;  // way since the last vertex that is no delta
        bool mapped = false;      // at the last vertex the map stood for all but what its coat mirrors
        bool wide = is_wide(walk.vertex().bsdf);
        CausticRun run(diffuse_before_ > 0);
        walk.keep_reverse_density();
        while (walk.leave(world_, random_)) {
            const float share = narrow_share(walk.pdf_reverse());
            if (mapped && walk.pdf_direction() > 0.0f) {
                if (!(share > 0.0f && random_.next() < share)) return first;
                since_last = 0.0f;
            }
            run.leave(walk.pdf_direction(), share, wide, mapped);
            const Vertex* vertex = walk.arrive(world_, random_);
            if (!vertex) break;
            if (!(first < infinity)) first = vertex->distance;
            since_last += vertex->distance;
            if (!counted_elsewhere(walk)) add_emission(walk, true, run.of_lights());
            if (walk.depth() + diffuse_before_ > settings_.max_depth) return first;
            if (!vertex->is_delta()) {
                wide = is_wide(vertex->bsdf);
                if (part != GatherPart::all && wide != (part == GatherPart::from_wide)) return first;
                part = GatherPart::all;
                mapped = events(walk).diffuse > 0 && wide && add_from_global_map(walk, since_last, run);
                if (mapped) {
                    if (vertex->bsdf.kind != BsdfKind::coated_diffuse) return first;
                } else {
                    add_direct(walk, run);
                    add_caustics(walk, run);
                    since_last = 0.0f;
                }
            }
            if (!walk.survive_roulette(random_)) return first;
        }
        if (!counted_elsewhere(walk)) add_escaped(walk, true, run.of_lights());
        return first;
    }

private:
    // s of light from wi.
    static float share_of_light(const Vertex& vertex, const Vec3& wi)
    {
        return vertex.bsdf.is_matte() ? 0.0f : narrow_share(reverse_pdf(vertex, wi, TransportMode::importance));
    }

    PathEvents events(const Walk& walk) const
    {
        PathEvents events = walk.events();
        events.diffuse = static_cast<uint16_t>(events.diffuse + diffuse_before_);
        return events;
    }

    // Light met through delta surfaces after a D is a caustic there: the caustic map has it.
    bool counted_elsewhere(const Walk& walk) const
    {
        const PathEvents met = events(walk);
        return met.diffuse > 0 && (met.specular_since_last || (skip_direct_ && met.diffuse == 1));
    }

    float caustic_radius() const
    {
        const float first = settings_.fixed_radius > 0.0f
                                ? settings_.fixed_radius
                                : settings_.radius_pixels * pixel_footprint(world_.camera, eye_distance_);
        return first * shrinkage_;
    }

    // Adds the light of the photons found; each under the class of its own path where the walk has met no D before.
    // part(wi, class): of the light of a photon; asked where the surface is not matte.
    template <class Part>
    void add_photons(const Walk& walk, const PhotonMap& map, const Part& part);

    // The light of the map. False: estimates are too wide there, the walk shall go on.
    bool add_from_global_map(const Walk& walk, float since_last, const CausticRun& run);

    const GatherSettings& settings_;
    const World& world_;
    const PhotonMapSet& maps_;
    RandomStream& random_;
    Sink& sink_;
    PhotonFinder finder_;
    const float shrinkage_;
    const bool light_groups_;
    float eye_distance_ = 0.0f;
    float share_ = 1.0f;
    int diffuse_before_ = 0;
    bool skip_direct_ = false;
};

template <class Sink>
template <class Part>
void PhotonGather<Sink>::add_photons(const Walk& walk, const PhotonMap& map, const Part& part)
{
    const Vertex& vertex = walk.vertex();
    const PathEvents met = events(walk);
    PhotonLight light(sink_, walk.arriving() * share_, light_groups_);
    const bool matte = vertex.bsdf.is_matte();
    for (const auto& [slot, weight] : finder_.found()) {
        const Vec3 wi = map.direction(slot);
        const Spectrum f = evaluate(vertex.bsdf, vertex.wo, wi, TransportMode::radiance);
        if (f.is_black()) continue;
        const float share = matte ? 1.0f : part(wi, static_cast<PathClass>(map.path_class(slot)));
        light.add(f * map.flux(slot) * (weight * share * shading_per_area(vertex.bsdf, wi)),
                  class_with_photon(met, map.path_class(slot)), LightGroup(map.light_group(slot)));
    }
    light.hand_over();
}

template <class Sink>
bool PhotonGather<Sink>::add_from_global_map(const Walk& walk, float since_last, const CausticRun& run)
{
    const Vertex& vertex = walk.vertex();
    if (vertex.bsdf.kind == BsdfKind::diffuse && !maps_.irradiance.empty()) {
        const IrradianceRecord* record = maps_.irradiance.nearest(
            maps_.places, vertex.at.position, face_forward(vertex.at.n_geometric, vertex.wo), since_last);
        if (record) {
            if (record->radius >= since_last) return false;
            const Spectrum radiance = vertex.bsdf.a * inv_pi * record->irradiance;
            sink_.add(walk.arriving() * share_ * radiance, PathClass::indirect, LightGroup(0u));
            return true;
        }
    }
    if (settings_.nearest == 0) {
        if (caustic_radius() >= since_last) return false;
        finder_.find(world_, vertex, maps_.global, settings_.global_bandwidth(caustic_radius(), shrinkage_));
    } else {
        const SurfaceRegion region = surface_region(vertex.at.position, vertex.bsdf, vertex.wo);
        if (maps_.places.radius_at(region, since_last) >= since_last) return false;
        finder_.find(world_, region, maps_.global, maps_.discs);
    }
    const bool goes_on = walk.depth() + diffuse_before_ < settings_.max_depth;
    add_photons(walk, maps_.global, [&](const Vec3& wi, PathClass photon) {
        return run.of_mapped(photon, share_of_light(vertex, wi), goes_on);
    });
    return true;
}

// Follows an eye path through delta surfaces, recording guides and emission. look(walk, distance) is called at each
// vertex that is no delta, with the way from the camera, and tells whether the path ends there; what a smooth coat
// mirrors is seen further on if not.
template <class Sink, class Look>
void follow_eye(const World& world, EyeSample& sample, int max_depth, PhotonGather<Sink>& gather, const Look& look)
{
    const PathStart start = path_start(sample.wavelengths, sample.random.next_2d(), gather.time());
    Walk eye = start_at_camera(world, sample.raster, start, sample.random);
    GuideRecorder guides(world, sample);
    float distance = 0.0f;
    while (const Vertex* vertex = eye.next(world, sample.random)) {
        if (eye.events().diffuse > 0) return;  // a coated surface was left by its diffuse part: the map had that
        guides.see(*vertex);
        distance += vertex->distance;
        gather.add_emission(eye, false);
        if (eye.depth() > max_depth) return;
        if (!vertex->is_delta()) {
            gather.set_eye_distance(distance);
            if (look(eye, distance) || !vertex->has_delta_lobe()) return;
        }
        if (eye.depth() > 1 && !eye.survive_roulette(sample.random)) return;
    }
    if (eye.events().diffuse == 0) gather.add_escaped(eye, false);
}

// Notes what the first estimate of an eye path rests on.
inline void note_support(EyeSample& sample, const EstimateSupport& support)
{
    if (sample.sums.radius > 0.0f) return;
    sample.sums.photon_density += support.density;
    sample.sums.radius += support.radius;
}

}  // namespace dapple
