#include "dapple/transport/connect.h"

namespace dapple {
namespace {

// The medium that a connection from the vertex towards wi travels in.
MediumId medium_towards(const World& world, const Vertex& vertex, const Vec3& wi)
{
    if (!vertex.on_surface) return vertex.medium;
    return world.medium_beyond(vertex.geometry, dot(wi, vertex.at.n_geometric) > 0.0f, vertex.medium);
}

Vec3 leave(const Vertex& vertex, const Vec3& wi)
{
    if (!vertex.on_surface) return vertex.at.position;
    return offset_ray_origin(vertex.at.position, vertex.at.error, vertex.at.n_geometric, wi);
}

// A connection ray between two points that are already offset from their surfaces. The small margin keeps float
// rounding of the length from meeting the far end.
Ray connection_ray(const Vec3& from, const Vec3& to, float time, float& t_max)
{
    const Vec3 d = to - from;
    const float distance = length(d);
    t_max = distance * (1.0f - 1e-6f);
    return Ray{from, d * (1.0f / distance), time};
}

}  // namespace

Scattering evaluate_scattering(const Vertex& vertex, const Vec3& wi, TransportMode mode)
{
    if (!vertex.on_surface) {
        const float p = evaluate_phase(vertex.phase_g, vertex.wo, wi);
        return {Spectrum(p), p};
    }
    const BsdfValue scattered = evaluate_with_pdf(vertex.bsdf, vertex.wo, wi, mode);
    if (scattered.f.is_black()) return {};
    return {scattered.f * abs_dot(wi, vertex.bsdf.frame.n), scattered.pdf};
}

float reverse_pdf(const Vertex& vertex, const Vec3& wi, TransportMode mode)
{
    return vertex.on_surface ? pdf(vertex.bsdf, wi, vertex.wo, mode) : evaluate_phase(vertex.phase_g, wi, vertex.wo);
}

Transmittance between(const World& world, const Vertex& from, const Vec3& to, const PathStart& start,
                      RandomStream& random)
{
    const Vec3 towards = to - from.at.position;
    float t_max = 0.0f;
    const Ray ray = connection_ray(leave(from, towards), to, start.time, t_max);
    return transmittance(world, ray, t_max, medium_towards(world, from, towards), start.wavelengths, start.kept_lane,
                         random);
}

bool connect_to_light(const World& world, const Carried& carried, const Vertex& vertex, RandomStream& random,
                      LightConnection& connection)
{
    if (world.lights.list.empty()) return false;
    Vec2 u = random.next_2d();
    const LightId id = world.choose_light(random, u.x);
    DirectSample& sample = connection.sample;
    if (!sample_direct(world.lights, world.spectra, id, vertex.at.position, vertex.at.time, u,
                       carried.start.wavelengths, sample))
        return false;
    const Light& light = world.lights.list[id.value];
    sample.radiance *= world.opacity(light, sample.position, sample.normal, sample.uv);
    connection.scattering = evaluate_scattering(vertex, sample.wi, TransportMode::radiance);
    if (connection.scattering.value.is_black() || sample.radiance.is_black()) return false;

    const Vec3 origin = leave(vertex, sample.wi);
    float t_max = infinity;
    Ray ray{origin, sample.wi, vertex.at.time};
    if (std::isfinite(sample.distance)) {
        const Vec3 target = sample.delta ? sample.position
                                         : offset_ray_origin(sample.position, sample.error, sample.normal, -sample.wi);
        ray = connection_ray(origin, target, vertex.at.time, t_max);
    }
    connection.through = transmittance(world, ray, t_max, medium_towards(world, vertex, sample.wi),
                                       carried.start.wavelengths, carried.start.kept_lane, random);
    if (connection.through.blocked()) return false;
    connection.light = id;
    connection.probability = world.light_probability(id);
    connection.value = carried.throughput * connection.scattering.value * sample.radiance * connection.through.value;
    return true;
}

DirectLight direct_light(const World& world, const Walk& walk, const Vertex& vertex, bool weigh, RandomStream& random)
{
    DirectLight result;
    LightConnection connection;
    if (!connect_to_light(world, walk.carried(), vertex, random, connection)) return result;
    const Spectrum path_pdf = walk.path_pdf();
    Spectrum density = connection.density(path_pdf);
    if (weigh && !connection.sample.delta)
        density += path_pdf * connection.through.path_pdf * connection.scattering.pdf;
    const float denominator = density.average();
    if (!(denominator > 0.0f)) return result;
    result.radiance = connection.value * (1.0f / denominator);
    result.group = world.lights.list[connection.light.value].group;
    result.wi = connection.sample.wi;
    result.found = true;
    return result;
}

Spectrum met_emission(const World& world, const Walk& walk, bool weigh)
{
    const Vertex& vertex = walk.vertex();
    const Spectrum radiance = emitted_area(world.lights, world.spectra, vertex.emitter, vertex.at.uv,
                                           vertex.at.n_geometric, vertex.wo, walk.wavelengths());
    if (radiance.is_black()) return radiance;
    Spectrum denominator = walk.path_pdf();
    if (weigh && walk.pdf_direction() > 0.0f) {
        const float density = world.light_probability(vertex.emitter) *
                              direct_pdf_area(world.lights, vertex.emitter, walk.previous_position(), -vertex.wo,
                                              vertex.at.position, vertex.at.n_geometric);
        denominator += walk.light_pdf() * density;
    }
    return walk.source() * walk.throughput() * radiance * (1.0f / denominator.average());
}

Spectrum met_environment(const World& world, const Walk& walk, LightId light, bool weigh)
{
    const Vec3 d = walk.ray().direction;
    const Spectrum radiance = emitted_environment(world.lights, world.spectra, light, d, walk.wavelengths());
    if (radiance.is_black()) return radiance;
    Spectrum denominator = walk.path_pdf();
    if (weigh && walk.pdf_direction() > 0.0f)
        denominator +=
            walk.light_pdf() * (world.light_probability(light) * direct_pdf_environment(world.lights, light, d));
    return walk.source() * walk.throughput() * radiance * (1.0f / denominator.average());
}

bool connect_to_camera(const World& world, const Carried& carried, const Vertex& vertex, float margin,
                       RandomStream& random, SeenByCamera& seen)
{
    const Vec2 u_lens = random.next_2d();
    CameraConnection& camera = seen.camera;
    if (!connect(world.camera, vertex.at.position, u_lens, vertex.at.time, margin, camera)) return false;
    seen.scattering = evaluate_scattering(vertex, camera.wi, TransportMode::importance);
    if (seen.scattering.value.is_black()) return false;
    float t_max = 0.0f;
    const Ray ray = connection_ray(leave(vertex, camera.wi), camera.position, vertex.at.time, t_max);
    const Transmittance through = transmittance(world, ray, t_max, medium_towards(world, vertex, camera.wi),
                                                carried.start.wavelengths, carried.start.kept_lane, random);
    if (through.blocked()) return false;
    const float density = (carried.path_pdf * through.light_pdf).average();
    seen.contribution = carried.throughput * seen.scattering.value * through.value * (camera.importance / density);
    return true;
}

}  // namespace dapple
