#include "dapple/transport/emission.h"

namespace dapple {
namespace {

// A homogeneous medium without bounds lets nothing through from a light infinitely far away.
bool lost_on_the_way(const World& world, const Light& light, const Wavelengths& wavelengths)
{
    const bool far = light.kind == Light::Kind::distant || light.kind == Light::Kind::environment ||
                     light.kind == Light::Kind::environment_image;
    if (!far || !light.medium.valid()) return false;
    const Medium& medium = world.media.list[light.medium.value];
    if (medium.kind != Medium::Kind::homogeneous) return false;
    const MediumPoint point = evaluate(world.media, world.spectra, medium, Vec3(0.0f), wavelengths);
    return !(point.sigma_a + point.sigma_s).is_black();
}

}  // namespace

bool emit(const World& world, const PathStart& start, RandomStream& random, Walk& walk, Departure& departure)
{
    if (world.lights.list.empty()) return false;
    Vec2 u_position = random.next_2d();
    departure.light = world.choose_light(random, u_position.x);
    departure.probability = world.light_probability(departure.light);
    EmissionSample& sample = departure.sample;
    const Vec2 u_direction = random.next_2d();
    if (!sample_emission(world.lights, world.spectra, departure.light, u_position, u_direction, start.time,
                         start.wavelengths, sample))
        return false;
    const Light& light = world.lights.list[departure.light.value];
    if (lost_on_the_way(world, light, start.wavelengths)) return false;
    Ray ray = sample.ray;
    if (light.kind == Light::Kind::area) {
        sample.flux *= world.opacity(light, sample.ray.origin, sample.normal, sample.uv);
        ray.origin = offset_ray_origin(ray.origin, sample.error, sample.normal, ray.direction);
    }
    const bool inwards = light.kind == Light::Kind::area && dot(ray.direction, sample.normal) < 0.0f;
    walk = Walk(ray, inwards ? light.medium_inside : light.medium, TransportMode::importance, start.wavelengths,
                start.kept_lane, sample.flux * (1.0f / departure.probability));
    walk.light_group = light.group;
    return !walk.source().is_black() && walk.source().is_finite();
}

}  // namespace dapple
