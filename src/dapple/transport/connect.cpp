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
    const Spectrum f = evaluate(vertex.bsdf, vertex.wo, wi, mode);
    if (f.is_black()) return {};
    return {f * abs_dot(wi, vertex.bsdf.frame.n), pdf(vertex.bsdf, vertex.wo, wi, mode)};
}

DirectLight direct_light(const World& world, const Walk& walk, const Vertex& vertex, bool weigh, RandomStream& random)
{
    const float u_light = random.next();
    const Vec2 u = random.next_2d();
    DirectLight result;
    if (world.lights.list.empty()) return result;
    const LightId id(world.light_choice.sample(u_light));
    const float probability = world.light_probability(id);
    DirectSample sample;
    if (!sample_direct(world.lights, world.spectra, id, vertex.at.position, vertex.at.time, u, walk.wavelengths(),
                       sample))
        return result;
    sample.radiance *= world.opacity(world.lights.list[id.value], sample.position, sample.normal, sample.uv);
    const Scattering scattering = evaluate_scattering(vertex, sample.wi, TransportMode::radiance);
    if (scattering.value.is_black() || sample.radiance.is_black()) return result;

    const Vec3 origin = leave(vertex, sample.wi);
    float t_max = infinity;
    Ray ray{origin, sample.wi, vertex.at.time};
    if (std::isfinite(sample.distance)) {
        const Vec3 target = sample.delta ? sample.position
                                         : offset_ray_origin(sample.position, sample.error, sample.normal, -sample.wi);
        ray = connection_ray(origin, target, vertex.at.time, t_max);
    }
    const Transmittance through = transmittance(world, ray, t_max, medium_towards(world, vertex, sample.wi),
                                                walk.wavelengths(), walk.kept_lane(), random);
    if (through.blocked()) return result;

    const float light_density = probability * sample.pdf;
    const Spectrum path_pdf = walk.path_pdf();
    Spectrum weight_denominator = path_pdf * through.light_pdf * light_density;
    if (weigh && !sample.delta) weight_denominator += path_pdf * through.path_pdf * scattering.pdf;
    const float denominator = weight_denominator.average();
    if (!(denominator > 0.0f)) return result;
    result.radiance =
        walk.source() * walk.throughput() * scattering.value * sample.radiance * through.value * (1.0f / denominator);
    result.group = world.lights.list[id.value].group;
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

bool connect_to_camera(const World& world, const Walk& walk, const Vertex& vertex, float margin, RandomStream& random,
                       SeenByCamera& seen)
{
    const Vec2 u_lens = random.next_2d();
    CameraConnection connection;
    if (!connect(world.camera, vertex.at.position, u_lens, vertex.at.time, margin, connection)) return false;
    const Scattering scattering = evaluate_scattering(vertex, connection.wi, TransportMode::importance);
    if (scattering.value.is_black()) return false;
    float t_max = 0.0f;
    const Ray ray = connection_ray(leave(vertex, connection.wi), connection.position, vertex.at.time, t_max);
    const Transmittance through = transmittance(world, ray, t_max, medium_towards(world, vertex, connection.wi),
                                                walk.wavelengths(), walk.kept_lane(), random);
    if (through.blocked()) return false;
    const float density = (walk.path_pdf() * through.light_pdf).average();
    seen.raster = connection.raster;
    seen.contribution =
        walk.source() * walk.throughput() * scattering.value * through.value * (connection.importance / density);
    return true;
}

}  // namespace dapple
