#include "dapple/transport/emission.h"

namespace dapple {
namespace {

bool start(const World& world, LightId id, float probability, const Wavelengths& wavelengths, RandomStream& random,
           Walk& walk)
{
    const Vec2 u_position = random.next_2d();
    const Vec2 u_direction = random.next_2d();
    const Vec2 u = random.next_2d();
    EmissionSample sample;
    if (!sample_emission(world.lights, world.spectra, id, u_position, u_direction, u.x, wavelengths, sample))
        return false;
    const Light& light = world.lights.list[id.value];
    Ray ray = sample.ray;
    if (light.kind == Light::Kind::area) {
        sample.flux *= world.opacity(light, sample.ray.origin, sample.normal, sample.uv);
        ray.origin = offset_ray_origin(ray.origin, sample.error, sample.normal, ray.direction);
    }
    const int kept_lane = std::min(static_cast<int>(u.y * Spectrum::lanes), Spectrum::lanes - 1);
    const bool inwards = light.kind == Light::Kind::area && dot(ray.direction, sample.normal) < 0.0f;
    walk = Walk(ray, inwards ? light.medium_inside : light.medium, TransportMode::importance, wavelengths, kept_lane,
                sample.flux * (1.0f / probability));
    walk.light_group = light.group;
    return !walk.source().is_black() && walk.source().is_finite();
}

}  // namespace

bool emit(const World& world, const Wavelengths& wavelengths, RandomStream& random, Walk& walk)
{
    if (world.lights.list.empty()) return false;
    const LightId id(world.light_choice.sample(random.next()));
    return start(world, id, world.light_probability(id), wavelengths, random, walk);
}

bool emit_from(const World& world, LightId light, const Wavelengths& wavelengths, RandomStream& random, Walk& walk)
{
    return start(world, light, 1.0f, wavelengths, random, walk);
}

}  // namespace dapple
