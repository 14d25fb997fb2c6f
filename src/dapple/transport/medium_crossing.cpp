#include "dapple/transport/medium_crossing.h"

namespace dapple {
namespace {

// A flight through one segment of constant majorant: moves t to the next collision, tentative or real, and returns
// true, or returns false where the segment ends first. `transmittance`, that of the majorant since the last event,
// takes the flight's factor. Flights are drawn for the lane of majorant `decided`; with 0 nothing is met.
bool fly(const MajorantSegment& segment, float decided, RandomStream& random, float& t, Spectrum& transmittance)
{
    const float flight = decided > 0.0f ? -std::log1p(-random.next()) / decided : infinity;
    const bool collides = t + flight < segment.t_max;
    transmittance *= exp(segment.majorant * -(collides ? flight : segment.t_max - t));
    t += flight;
    return collides;
}

// Multiplies a crossing's factors by those of one event of density pdf (of the deciding lane).
void apply(MediumEvent& event, const Spectrum& contribution, const Spectrum& light_density, float pdf)
{
    if (!(pdf > 0.0f)) {
        event.throughput = Spectrum(0.0f);
        return;
    }
    const float scale = 1.0f / pdf;
    event.throughput *= contribution * scale;
    event.path_pdf *= contribution * scale;
    event.light_pdf *= light_density * scale;
}

}  // namespace

MediumEvent cross_medium(const World& world, MediumId medium_id, const Ray& ray, float t_max,
                         const Wavelengths& wavelengths, int kept_lane, const Spectrum& path_pdf, RandomStream& random)
{
    const Medium& medium = world.media.list[medium_id.value];
    MediumEvent event;
    Spectrum majorant_transmittance(1.0f);  // since the last event
    MajorantTracker tracker(world.media, world.spectra, medium, ray, t_max, wavelengths);
    MajorantSegment segment;
    while (tracker.next_segment(segment)) {
        float t = segment.t_min;
        const float decided = segment.majorant[kept_lane];
        while (fly(segment, decided, random, t, majorant_transmittance)) {
            const MediumPoint point = evaluate(world.media, world.spectra, medium, ray.at(t), wavelengths);
            const float transmitted = majorant_transmittance[kept_lane];
            if (!point.emission.is_black()) {
                const Spectrum emission_pdf = path_pdf * event.path_pdf * segment.majorant * majorant_transmittance *
                                              (1.0f / (transmitted * decided));
                event.emission += event.throughput * majorant_transmittance * point.emission *
                                  (1.0f / (transmitted * decided * emission_pdf.average()));
            }
            const float absorbed = point.sigma_a[kept_lane];
            const float scattered = point.sigma_s[kept_lane];
            const float choice = random.next() * decided;
            if (choice < absorbed) {
                event.kind = MediumEvent::Kind::absorb;
                event.throughput = Spectrum(0.0f);
                return event;
            }
            if (choice < absorbed + scattered) {
                const Spectrum contribution = majorant_transmittance * point.sigma_s;
                apply(event, contribution, contribution, transmitted * scattered);
                event.kind = MediumEvent::Kind::scatter;
                event.t = t;
                return event;
            }
            const Spectrum null = clamp_zero(segment.majorant - point.sigma_a - point.sigma_s);
            apply(event, majorant_transmittance * null, majorant_transmittance * segment.majorant,
                  transmitted * null[kept_lane]);
            if (event.throughput.is_black()) return event;
            majorant_transmittance = Spectrum(1.0f);
        }
    }
    // Light sampling knows the transmittance of a homogeneous medium exactly: it crosses with density 1.
    const Spectrum light_density = medium.kind == Medium::Kind::homogeneous ? Spectrum(1.0f) : majorant_transmittance;
    apply(event, majorant_transmittance, light_density, majorant_transmittance[kept_lane]);
    return event;
}

namespace {

// Ratio tracking through one medium, up to t_max.
void attenuate(Transmittance& result, const World& world, MediumId medium_id, const Ray& ray, float t_max,
               const Wavelengths& wavelengths, int kept_lane, RandomStream& random)
{
    const Medium& medium = world.media.list[medium_id.value];
    Spectrum majorant_transmittance(1.0f);
    MajorantTracker tracker(world.media, world.spectra, medium, ray, t_max, wavelengths);
    MajorantSegment segment;
    while (tracker.next_segment(segment)) {
        float t = segment.t_min;
        // A homogeneous medium needs no tracking: its transmittance is known.
        const float decided = medium.kind == Medium::Kind::homogeneous ? 0.0f : segment.majorant[kept_lane];
        while (fly(segment, decided, random, t, majorant_transmittance)) {
            const MediumPoint point = evaluate(world.media, world.spectra, medium, ray.at(t), wavelengths);
            const Spectrum null = clamp_zero(segment.majorant - point.sigma_a - point.sigma_s);
            const float scale = 1.0f / (majorant_transmittance[kept_lane] * decided);
            result.value *= majorant_transmittance * null * scale;
            result.path_pdf *= majorant_transmittance * null * scale;
            result.light_pdf *= majorant_transmittance * segment.majorant * scale;
            majorant_transmittance = Spectrum(1.0f);
            const float mean = result.value.average() / (result.path_pdf + result.light_pdf).average();
            if (mean < 0.025f) {  // the rest is worth little: end it or raise it
                constexpr float survival = 0.25f;
                if (random.next() >= survival) {
                    result.value = Spectrum(0.0f);
                    return;
                }
                result.value /= survival;
            }
            if (result.value.is_black()) return;
        }
    }
    if (medium.kind == Medium::Kind::homogeneous) {
        result.value *= majorant_transmittance;  // exact, no lane decided anything
        result.path_pdf *= majorant_transmittance;
        return;
    }
    const float transmitted = majorant_transmittance[kept_lane];
    if (!(transmitted > 0.0f)) {
        result.value = Spectrum(0.0f);
        return;
    }
    const Spectrum rest = majorant_transmittance * (1.0f / transmitted);
    result.value *= rest;
    result.path_pdf *= rest;
    result.light_pdf *= rest;
}

}  // namespace

Transmittance transmittance(const World& world, Ray ray, float t_max, MediumId medium, const Wavelengths& wavelengths,
                            int kept_lane, RandomStream& random)
{
    Transmittance result;
    if (!world.has_interfaces && !medium.valid()) {
        if (world.occluded(ray, t_max)) result.value = Spectrum(0.0f);
        return result;
    }
    for (;;) {
        Hit hit;
        const bool met = world.intersect(ray, t_max, hit);
        SurfacePoint at;
        if (met) {
            at = world.surface_point(ray, hit);
            const MaterialId material = resolve_mix(world.materials, world.geometries[hit.geometry].material, at);
            if (world.materials.list[material.value].kind != Material::Kind::interface) {
                result.value = Spectrum(0.0f);
                return result;
            }
        }
        if (medium.valid()) attenuate(result, world, medium, ray, met ? hit.t : t_max, wavelengths, kept_lane, random);
        if (!met || result.value.is_black()) return result;
        medium = world.medium_beyond(hit.geometry, dot(ray.direction, at.n_geometric) > 0.0f, medium);
        const Vec3 origin = offset_ray_origin(at.position, at.error, at.n_geometric, ray.direction);
        if (t_max != infinity) t_max -= length(origin - ray.origin);
        ray.origin = origin;
        if (!(t_max > 0.0f)) return result;
    }
}

}  // namespace dapple
