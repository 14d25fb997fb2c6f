// The start of light paths: a ray per light, with the flux that it carries when the light was chosen with certainty,
//     flux = Le |cos| / (pdf_position pdf_direction)   [W]
// (Jensen 2001, "Realistic image synthesis using photon mapping", section 5.2; Pharr, Jakob, Humphreys 2023, 12.6).
// Directions are drawn in proportion to what the light emits, so that without an image the flux is one constant per
// light. Far lights start from the disc of the scene's bounding sphere that faces them.

#include "dapple/lights/emission_profile.h"

namespace dapple {

using namespace lights_detail;

namespace {

// Inverts F(t) = 2 t^3 - t^4, the distribution of t in [0,1] with the density 2 t^2 (3 - 2t) of a smoothstep. Newton's
// method kept within a shrinking bracket.
float sample_smoothstep(float u)
{
    float low = 0.0f, high = 1.0f, t = u;
    for (int i = 0; i < 12; ++i) {
        const float excess = t * t * t * (2.0f - t) - u;
        (excess < 0.0f ? low : high) = t;
        const float slope = 2.0f * t * t * (3.0f - 2.0f * t);
        const float next = slope > 0.0f ? t - excess / slope : -1.0f;
        t = next > low && next < high ? next : 0.5f * (low + high);
    }
    return t;
}

// A direction within the cone, with a density in proportion to the falloff.
Vec3 sample_spot(const Light& light, Vec2 u)
{
    const float core = spot_core(light);
    const float share = core / (core + spot_rim(light));
    if (u.x < share) {
        u.x = std::min(u.x / share, one_minus_epsilon);
        return sample_uniform_cone(u, light.cos_falloff);
    }
    const float t = sample_smoothstep(std::min((u.x - share) / (1.0f - share), one_minus_epsilon));
    const float cosine = lerp(t, light.cos_total, light.cos_falloff);
    return spherical_direction(safe_sqrt((1.0f - cosine) * (1.0f + cosine)), cosine, 2.0f * pi * u.y);
}

// A direction in light space, its density, and the intensity there relative to the light's spectrum.
bool sample_point_like(const Lights& lights, const SpectrumPool& pool, const Light& light, const Vec2& u,
                       const Wavelengths& wavelengths, Vec3& w, float& pdf, Spectrum& relative)
{
    if (light.kind == Light::Kind::point) {
        w = sample_uniform_sphere(u);
        pdf = pdf_uniform_sphere();
        relative = Spectrum(1.0f);
        return true;
    }
    if (light.kind == Light::Kind::spot) {
        w = sample_spot(light, u);
        const float falloff = spot_falloff(light, w.z);
        pdf = falloff / (spot_core(light) + spot_rim(light));
        relative = Spectrum(falloff);
        return falloff > 0.0f;
    }
    const LightImage& image = lights.images[light.image];
    float density = 0.0f;
    const Vec2 uv = image.distribution.sample(u, &density);
    if (!(density > 0.0f)) return false;
    relative = image_spectrum(image, pool, uv, wavelengths);
    if (light.kind == Light::Kind::goniometric) {
        w = equal_area_square_to_sphere(uv);
        pdf = density * pdf_uniform_sphere();
        return true;
    }
    // Projection: the plane z = 1 has dw = cos^3 dA.
    w = normalize(Vec3((2.0f * uv.x - 1.0f) * light.screen_half[0], (1.0f - 2.0f * uv.y) * light.screen_half[1], 1.0f));
    pdf = density / (4.0f * light.screen_half[0] * light.screen_half[1] * w.z * w.z * w.z);
    return true;
}

bool emit_area(const Lights& lights, const SpectrumPool& pool, const Light& light, const Vec2& u_position,
               Vec2 u_direction, const Wavelengths& wavelengths, EmissionSample& sample)
{
    const ShapeSample point = sample_area(light.shape, u_position);
    if (!(point.pdf > 0.0f)) return false;
    float side = 1.0f;
    if (light.two_sided) {
        side = u_direction.x < 0.5f ? 1.0f : -1.0f;
        u_direction.x =
            std::min(2.0f * (u_direction.x < 0.5f ? u_direction.x : u_direction.x - 0.5f), one_minus_epsilon);
    }
    const Vec3 w = sample_cosine_hemisphere(u_direction);
    if (!(w.z > 0.0f)) return false;
    const float sides = light.two_sided ? 2.0f : 1.0f;
    sample.ray.origin = point.position;
    sample.ray.direction = Frame(point.normal * side).to_world(w);
    sample.error = point.error;
    sample.normal = point.normal;
    sample.uv = point.uv;
    sample.pdf_position = point.pdf;
    sample.pdf_direction = pdf_cosine_hemisphere(w.z) / sides;
    // The cosine of the flux cancels that of the density.
    sample.flux = area_radiance(lights, pool, light, point.uv, wavelengths) * (pi * sides / point.pdf);
    if (light.alpha > 0.0f) sample.flux *= light.alpha;
    return !sample.flux.is_black();
}

// Starts at a point of the disc that faces the light, at the edge of the scene; to_light is a unit vector.
void start_far_ray(const Lights& lights, const Vec3& to_light, const Vec2& u, EmissionSample& sample)
{
    const Vec2 disc = sample_disk_concentric(u);
    sample.ray.origin =
        lights.scene_center + Frame(to_light).to_world(Vec3(disc.x, disc.y, 1.0f)) * lights.scene_radius;
    sample.ray.direction = -to_light;
    sample.pdf_position = pdf_disk() / sqr(lights.scene_radius);
}

bool emit_environment(const Lights& lights, const SpectrumPool& pool, const Light& light, const Vec2& u_position,
                      const Vec2& u_direction, const Wavelengths& wavelengths, EmissionSample& sample)
{
    Spectrum radiance = pool.evaluate(light.spectrum, wavelengths);
    Vec3 to_light;
    if (light.kind == Light::Kind::environment) {
        to_light = sample_uniform_sphere(u_direction);
        sample.pdf_direction = pdf_uniform_sphere();
    } else {
        const LightImage& image = lights.images[light.image];
        float density = 0.0f;
        const Vec2 uv = image.distribution.sample(u_direction, &density);
        if (!(density > 0.0f)) return false;
        to_light = LightAxes(light.world_from_light.start()).axes.to_world(equal_area_square_to_sphere(uv));
        sample.pdf_direction = density * pdf_uniform_sphere();
        radiance *= image_spectrum(image, pool, uv, wavelengths);
    }
    start_far_ray(lights, to_light, u_position, sample);
    sample.flux = radiance / (sample.pdf_position * sample.pdf_direction);
    return !sample.flux.is_black();
}

}  // namespace

bool sample_emission(const Lights& lights, const SpectrumPool& pool, LightId id, const Vec2& u_position,
                     const Vec2& u_direction, float time, const Wavelengths& wavelengths, EmissionSample& sample)
{
    const Light& light = lights.list[id.value];
    sample = EmissionSample{};
    sample.ray.time = time;
    switch (light.kind) {
        case Light::Kind::area: return emit_area(lights, pool, light, u_position, u_direction, wavelengths, sample);
        case Light::Kind::environment:
        case Light::Kind::environment_image:
            return emit_environment(lights, pool, light, u_position, u_direction, wavelengths, sample);
        case Light::Kind::distant:
            start_far_ray(lights, -LightAxes::of(light, time).axes.n, u_position, sample);
            sample.pdf_direction = 1.0f;
            sample.delta_direction = true;
            sample.flux = pool.evaluate(light.spectrum, wavelengths) / sample.pdf_position;
            return !sample.flux.is_black();
        default: break;
    }
    const LightAxes frame = LightAxes::of(light, time);
    Vec3 w;
    Spectrum relative;
    if (!sample_point_like(lights, pool, light, u_direction, wavelengths, w, sample.pdf_direction, relative))
        return false;
    sample.ray.origin = frame.origin;
    sample.ray.direction = frame.axes.to_world(w);
    sample.pdf_position = 1.0f;
    sample.delta_position = true;
    sample.flux = pool.evaluate(light.spectrum, wavelengths) * relative / sample.pdf_direction;
    return !sample.flux.is_black();
}

EmissionDensity emission_density(const Lights& lights, LightId id, float time, const Vec3& position, const Vec3& n,
                                 const Vec3& w)
{
    const Light& light = lights.list[id.value];
    const float disc = pdf_disk() / sqr(lights.scene_radius);
    switch (light.kind) {
        case Light::Kind::area: {
            const float cosine = light.two_sided ? std::fabs(dot(n, w)) : std::max(dot(n, w), 0.0f);
            return {pdf_area(light.shape, position), pdf_cosine_hemisphere(cosine) / (light.two_sided ? 2.0f : 1.0f)};
        }
        case Light::Kind::environment:
        case Light::Kind::environment_image: return {disc, direct_pdf_environment(lights, id, -w)};
        case Light::Kind::distant: return {disc, 1.0f};
        case Light::Kind::point: return {1.0f, pdf_uniform_sphere()};
        default: break;
    }
    const Vec3 local = LightAxes::of(light, time).axes.to_local(w);
    if (light.kind == Light::Kind::spot)
        return {1.0f, spot_falloff(light, local.z) / (spot_core(light) + spot_rim(light))};
    const LightImage& image = lights.images[light.image];
    if (light.kind == Light::Kind::goniometric)
        return {1.0f, image.distribution.density(equal_area_sphere_to_square(local)) * pdf_uniform_sphere()};
    Vec2 uv;
    if (!projection_uv(light, local, uv)) return {1.0f, 0.0f};
    return {1.0f, image.distribution.density(uv) /
                      (4.0f * light.screen_half[0] * light.screen_half[1] * local.z * local.z * local.z)};
}

}  // namespace dapple
