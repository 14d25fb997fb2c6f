// What must hold for every kind of light: the mean flux of its particles is its power, and particles and direct samples
// bring the same irradiance to a patch.

#include "light_fixtures.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

using namespace testing_support;

float alpha_factor(const Light& light) { return light.alpha > 0.0f ? light.alpha : 1.0f; }

TEST(EveryLight, MeanFluxIsThePower)
{
    LightScene scene;
    Numbers numbers(1);
    for (const NamedLight& named : all_lights(scene)) {
        const Light& light = scene[named.id];
        Series flux;
        for (int i = 0; i < 30000; ++i) {
            EmissionSample sample;
            const bool emitted = scene.emit(named.id, numbers, sample);
            flux.add(emitted ? luminance_of(sample.flux) : 0.0);
        }
        // On a disk (u, v) is not in proportion to area, so the mean of the image is not that of the light.
        if (named.name == "disk with image") continue;
        const double expected = 3.0 * power_factor(light, scene.lights) * alpha_factor(light);
        EXPECT_NEAR(flux.mean(), expected, 3.5 * flux.error() + 2e-5 * expected) << named.name;
        EXPECT_NEAR(power(scene.lights, scene.pool, named.id), expected, 1e-4 * expected) << named.name;
        // All but images are sampled in exact proportion.
        if (light.image == Id<int>::none_value) {
            EXPECT_LT(flux.error(), 1e-5 * expected) << named.name;
        }
    }
}

TEST(EveryLight, FluxIsRadianceOverDensity)
{
    LightScene scene;
    Numbers numbers(2);
    for (const NamedLight& named : all_lights(scene)) {
        const Light& light = scene[named.id];
        for (int i = 0; i < 200; ++i) {
            EmissionSample sample;
            if (!scene.emit(named.id, numbers, sample)) continue;
            const Vec3& w = sample.ray.direction;
            EXPECT_NEAR(length(w), 1.0f, 1e-5f) << named.name;
            const EmissionDensity density =
                emission_density(scene.lights, named.id, sample.ray.time, sample.ray.origin, sample.normal, w);
            EXPECT_NEAR(density.position, sample.pdf_position, 2e-3f * sample.pdf_position) << named.name;
            EXPECT_NEAR(density.direction, sample.pdf_direction, 2e-3f * sample.pdf_direction) << named.name;
            Spectrum expected;
            if (light.kind == Light::Kind::area) {
                EXPECT_NEAR(sample.pdf_position, pdf_area(light.shape, sample.ray.origin), 1e-3f * sample.pdf_position);
                if (light.image != Id<int>::none_value) continue;
                expected =
                    emitted_area(scene.lights, scene.pool, named.id, Vec2(0, 0), sample.normal, w, scene.wavelengths) *
                    (abs_dot(sample.normal, w) * alpha_factor(light));
            } else if (light.kind == Light::Kind::environment || light.kind == Light::Kind::environment_image) {
                expected = emitted_environment(scene.lights, scene.pool, named.id, -w, scene.wavelengths);
                // At a distance of one radius from the scene's centre, on the disc.
                EXPECT_NEAR(dot(sample.ray.origin - scene.lights.scene_center, -w), scene.lights.scene_radius, 1e-4f);
                EXPECT_NEAR(sample.pdf_direction, direct_pdf_environment(scene.lights, named.id, -w),
                            2e-3f * sample.pdf_direction);
            } else if (light.kind == Light::Kind::distant) {
                EXPECT_TRUE(sample.delta_direction);
                expected = Spectrum(3.0f);
            } else {
                // The intensity, read off a direct sample one metre down the ray.
                EXPECT_TRUE(sample.delta_position);
                DirectSample direct;
                ASSERT_TRUE(scene.direct(named.id, sample.ray.at(1.0f), numbers, direct)) << named.name;
                expected = direct.radiance * sqr(direct.distance);
            }
            const float pdf = sample.pdf_position * sample.pdf_direction;
            for (int lane = 0; lane < Spectrum::lanes; ++lane)
                EXPECT_NEAR(sample.flux[lane], expected[lane] / pdf, 2e-3f * expected[lane] / pdf) << named.name;
        }
    }
}

// A round patch and the irradiance on its front.
struct Patch {
    Vec3 center{0, 0, 0};
    Vec3 normal{0, 0, 1};
    float radius = 0.4f;

    double area() const { return M_PI * radius * radius; }
    bool hit_by(const Ray& ray) const
    {
        const float slope = dot(ray.direction, normal);
        if (!(slope < 0.0f)) return false;
        const float t = dot(center - ray.origin, normal) / slope;
        return t > 0.0f && length(ray.at(t) - center) < radius;
    }
    Vec3 point(const Vec2& u) const
    {
        const float r = radius * std::sqrt(u.x);
        return center + Frame(normal).to_world(Vec3(r * std::cos(2 * pi * u.y), r * std::sin(2 * pi * u.y), 0));
    }
};

double direct_irradiance(const LightScene& scene, LightId id, const Vec3& p, const Vec3& normal, Numbers& numbers)
{
    DirectSample sample;
    if (!scene.direct(id, p, numbers, sample)) return 0.0;
    return luminance_of(sample.radiance) * std::max(0.0f, dot(sample.wi, normal)) / sample.pdf;
}

TEST(EveryLight, ParticlesAndDirectSamplesAgreeOnAPatch)
{
    LightScene scene;
    Numbers numbers(3);
    for (const Patch& patch : {Patch{}, Patch{Vec3(0.5f, 0.3f, 0), normalize(Vec3(-1, 0.2f, 0.5f)), 0.5f}})
        for (const NamedLight& named : all_lights(scene)) {
            Series particles, direct;
            for (int i = 0; i < 40000; ++i) {
                EmissionSample sample;
                const bool hits = scene.emit(named.id, numbers, sample) && patch.hit_by(sample.ray);
                particles.add(hits ? luminance_of(sample.flux) / patch.area() : 0.0);
                direct.add(direct_irradiance(scene, named.id, patch.point(numbers.next_2d()), patch.normal, numbers));
            }
            ASSERT_GT(direct.mean(), 0.0) << named.name;
            EXPECT_LT(particles.error(), 0.15 * direct.mean()) << named.name << ": too few hits to tell";
            EXPECT_NEAR(particles.mean(), direct.mean(), 3.5 * std::hypot(particles.error(), direct.error()))
                << named.name;
        }
}

TEST(EveryLight, DensitiesAreThoseOfTheSamples)
{
    LightScene scene;
    Numbers numbers(4);
    const Vec3 reference(0.2f, 0.1f, -0.2f);
    for (const NamedLight& named : all_lights(scene)) {
        const Light& light = scene[named.id];
        for (int i = 0; i < 300; ++i) {
            DirectSample sample;
            if (!scene.direct(named.id, reference, numbers, sample)) continue;
            EXPECT_NEAR(length(sample.wi), 1.0f, 1e-5f) << named.name;
            if (sample.delta) {
                EXPECT_EQ(sample.pdf, 1.0f) << named.name;
            } else if (light.kind == Light::Kind::area) {
                EXPECT_NEAR(
                    sample.pdf,
                    direct_pdf_area(scene.lights, named.id, reference, sample.wi, sample.position, sample.normal),
                    2e-3f * sample.pdf)
                    << named.name;
                EXPECT_NEAR(sample.distance, length(sample.position - reference), 1e-4f) << named.name;
            } else {
                EXPECT_EQ(sample.distance, infinity);
                EXPECT_NEAR(sample.pdf, direct_pdf_environment(scene.lights, named.id, sample.wi), 2e-3f * sample.pdf)
                    << named.name;
                const Spectrum seen =
                    emitted_environment(scene.lights, scene.pool, named.id, sample.wi, scene.wavelengths);
                EXPECT_NEAR(sample.radiance[1], seen[1], 1e-4f * seen[1]) << named.name;
            }
        }
    }
}

TEST(EveryLight, MovesWithItsTransform)
{
    // Lights turned about the x axis by half a turn see what the turned patch sees.
    LightScene scene, turned;
    const Transform half_turn(rotation(180, Vec3(1, 0, 0)) * translation(Vec3(0.1f, 0, 0)));
    Numbers numbers(5), same(5);
    const auto names = all_lights(scene);
    all_lights(turned);
    for (const NamedLight& named : names) {
        Light& light = turned[named.id];
        if (light.kind == Light::Kind::area || light.kind == Light::Kind::environment) continue;
        light.world_from_light = AnimatedTransform(half_turn * light.world_from_light.start());
        for (int i = 0; i < 50; ++i) {
            DirectSample a, b;
            const Vec3 p(0.3f * i / 50.0f, 0.2f, 0);
            const bool found = scene.direct(named.id, p, numbers, a);
            ASSERT_EQ(found, turned.direct(named.id, half_turn.point(p), same, b)) << named.name;
            if (!found) continue;
            EXPECT_NEAR(a.radiance[0], b.radiance[0], 1e-3f * a.radiance[0]) << named.name;
            EXPECT_LT(length(half_turn.vector(a.wi) - b.wi), 1e-4f) << named.name;
        }
    }
}

}  // namespace
}  // namespace dapple
