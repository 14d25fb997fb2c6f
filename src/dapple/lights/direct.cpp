// Direct light: samples towards each kind of light, and their densities for multiple importance sampling (Veach and
// Guibas 1995). Point-like and distant lights are deltas; area lights are sampled by solid angle (shapes/primitive.h),
// environments by their image. Nothing here knows of visibility. Cost: constant, but for images a binary search.

#include "dapple/lights/emission_profile.h"

namespace dapple {

using namespace lights_detail;

namespace {

bool sample_point_like(const Lights& lights, const SpectrumPool& pool, const Light& light, const Vec3& reference,
                       float time, const Wavelengths& wavelengths, DirectSample& sample)
{
    const LightAxes frame = LightAxes::of(light, time);
    const Vec3 to_light = frame.origin - reference;
    const float distance2 = length_squared(to_light);
    if (!(distance2 > 0.0f)) return false;
    sample.distance = std::sqrt(distance2);
    sample.wi = to_light / sample.distance;
    sample.position = frame.origin;
    sample.delta = true;
    sample.pdf = 1.0f;
    sample.radiance = pool.evaluate(light.spectrum, wavelengths) *
                      relative_intensity(lights, pool, light, frame.axes.to_local(-sample.wi), wavelengths) / distance2;
    return !sample.radiance.is_black();
}

bool sample_area_light(const Lights& lights, const SpectrumPool& pool, const Light& light, const Vec3& reference,
                       const Vec2& u, const Wavelengths& wavelengths, DirectSample& sample)
{
    ShapeSample point;
    if (!sample_solid_angle(light.shape, reference, u, point) || !(point.pdf > 0.0f)) return false;
    const Vec3 to_light = point.position - reference;
    const float distance2 = length_squared(to_light);
    if (!(distance2 > 0.0f)) return false;
    sample.distance = std::sqrt(distance2);
    sample.wi = to_light / sample.distance;
    if (!light.two_sided && !(dot(point.normal, sample.wi) < 0.0f)) return false;
    sample.position = point.position;
    sample.error = point.error;
    sample.normal = point.normal;
    sample.uv = point.uv;
    sample.pdf = point.pdf;
    sample.radiance = has_image(light) ? area_radiance(lights, pool, light, point.uv, wavelengths)
                                       : pool.evaluate(light.spectrum, wavelengths);
    if (light.alpha > 0.0f) {
        sample.radiance *= light.alpha;
    } else {
        // No ray can meet it, so no other technique may be given weight.
        sample.delta = true;
        sample.radiance /= sample.pdf;
        sample.pdf = 1.0f;
    }
    return !sample.radiance.is_black();
}

bool sample_environment(const Lights& lights, const SpectrumPool& pool, const Light& light, const Vec2& u,
                        const Wavelengths& wavelengths, DirectSample& sample)
{
    sample.distance = infinity;
    sample.radiance = pool.evaluate(light.spectrum, wavelengths);
    if (light.kind == Light::Kind::environment) {
        sample.wi = sample_uniform_sphere(u);
        sample.pdf = pdf_uniform_sphere();
        return !sample.radiance.is_black();
    }
    const LightImage& image = lights.images[light.image];
    float density = 0.0f;
    const Vec2 uv = image.distribution.sample(u, &density);
    if (!(density > 0.0f)) return false;
    sample.wi = LightAxes(light.world_from_light.start()).axes.to_world(equal_area_square_to_sphere(uv));
    sample.pdf = density * pdf_uniform_sphere();
    sample.radiance *= image_spectrum(image, pool, uv, wavelengths);
    return !sample.radiance.is_black();
}

// Where an environment's image is seen in direction d (world).
Vec2 environment_uv(const Light& light, const Vec3& d)
{
    return equal_area_sphere_to_square(LightAxes(light.world_from_light.start()).axes.to_local(d));
}

}  // namespace

bool sample_direct(const Lights& lights, const SpectrumPool& pool, LightId id, const Vec3& reference, float time,
                   const Vec2& u, const Wavelengths& wavelengths, DirectSample& sample)
{
    const Light& light = lights.list[id.value];
    sample = DirectSample{};
    switch (light.kind) {
        case Light::Kind::area: return sample_area_light(lights, pool, light, reference, u, wavelengths, sample);
        case Light::Kind::environment:
        case Light::Kind::environment_image: return sample_environment(lights, pool, light, u, wavelengths, sample);
        case Light::Kind::distant:
            sample.wi = -LightAxes::of(light, time).axes.n;
            sample.distance = infinity;
            sample.radiance = pool.evaluate(light.spectrum, wavelengths);
            sample.pdf = 1.0f;
            sample.delta = true;
            return !sample.radiance.is_black();
        default: return sample_point_like(lights, pool, light, reference, time, wavelengths, sample);
    }
}

float direct_pdf_area(const Lights& lights, LightId id, const Vec3& reference, const Vec3& wi, const Vec3& at,
                      const Vec3& n)
{
    const Light& light = lights.list[id.value];
    if (!light.two_sided && !(dot(n, wi) < 0.0f)) return 0.0f;
    return pdf_solid_angle(light.shape, reference, wi, at, n);
}

float direct_pdf_environment(const Lights& lights, LightId id, const Vec3& wi)
{
    const Light& light = lights.list[id.value];
    if (light.kind == Light::Kind::environment) return pdf_uniform_sphere();
    return lights.images[light.image].distribution.density(environment_uv(light, wi)) * pdf_uniform_sphere();
}

Spectrum emitted_area(const Lights& lights, const SpectrumPool& pool, LightId id, const Vec2& uv, const Vec3& n,
                      const Vec3& w, const Wavelengths& wavelengths)
{
    const Light& light = lights.list[id.value];
    if (!light.two_sided && !(dot(n, w) > 0.0f)) return Spectrum(0.0f);
    return area_radiance(lights, pool, light, uv, wavelengths);
}

Spectrum emitted_environment(const Lights& lights, const SpectrumPool& pool, LightId id, const Vec3& d,
                             const Wavelengths& wavelengths)
{
    const Light& light = lights.list[id.value];
    const Spectrum radiance = pool.evaluate(light.spectrum, wavelengths);
    if (light.kind == Light::Kind::environment) return radiance;
    return radiance * image_spectrum(lights.images[light.image], pool, environment_uv(light, d), wavelengths);
}

}  // namespace dapple
