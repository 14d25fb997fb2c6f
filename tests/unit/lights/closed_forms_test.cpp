// Lights against closed forms: point, Lambertian disk, sphere, distant, environment; sides, rectangles, spots, images.

#include "../sampling/statistics.h"
#include "light_fixtures.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

using namespace testing_support;

// Irradiance at p on a surface of that normal, with its standard error.
Series irradiance(const LightScene& scene, LightId id, const Vec3& p, const Vec3& normal, int samples = 20000)
{
    Numbers numbers(7);
    Series series;
    for (int i = 0; i < samples; ++i) {
        DirectSample sample;
        const bool found = scene.direct(id, p, numbers, sample);
        series.add(found ? sample.radiance[1] * std::max(0.0f, dot(sample.wi, normal)) / sample.pdf : 0.0);
    }
    return series;
}

void expect_irradiance(const LightScene& scene, LightId id, const Vec3& p, const Vec3& normal, double expected)
{
    const Series series = irradiance(scene, id, p, normal);
    EXPECT_NEAR(series.mean(), expected, 3.5 * series.error() + 1e-4 * expected);
    EXPECT_LT(series.error(), 0.02 * expected);
}

const Vec3 up(0, 0, 1);

TEST(ClosedForms, PointLightOf100Lumens)
{
    LightScene scene;
    Light light;
    light.world_from_light = AnimatedTransform(Transform(translation(Vec3(0, 0, 1))));
    const LightId id = scene.add(light, 1.0f);
    scene[id].spectrum = make_constant(100.0f / power_factor(scene[id], scene.lights));
    expect_irradiance(scene, id, Vec3(0.0f), up, 7.958);
}

TEST(ClosedForms, SmallLambertianDiskOf100Lumens)
{
    LightScene scene;
    Light light;
    light.kind = Light::Kind::area;
    light.shape = disk_at(up, -up, 0.001f);
    const LightId id = scene.add(light, 1.0f);
    scene[id].spectrum = make_constant(100.0f / power_factor(scene[id], scene.lights));
    expect_irradiance(scene, id, Vec3(0.0f), up, 31.831);
}

TEST(ClosedForms, SphereLight)
{
    LightScene scene;
    Light light;
    light.kind = Light::Kind::area;
    light.shape = sphere_at(Vec3(0, 1, 2), 0.5f);
    const LightId id = scene.add(light, 4.0f);
    const double d2 = 5.0, cosine = 2.0 / std::sqrt(5.0);
    expect_irradiance(scene, id, Vec3(0.0f), up, M_PI * 4.0 * 0.25 / d2 * cosine);
    expect_irradiance(scene, id, Vec3(0.0f), normalize(Vec3(0, 1, 2)), M_PI * 4.0 * 0.25 / d2);
}

TEST(ClosedForms, SquareOverItsCornerAndCentre)
{
    // Configuration factors of a unit square at distance 1: 0.2394564705 (centre), 0.1385316060 (corner).
    LightScene scene;
    Light light;
    light.kind = Light::Kind::area;
    const Vec3 a(0, 0, 1), b(1, 0, 1), c(1, 1, 1), d(0, 1, 1);
    light.shape = triangle(a, c, b);  // outside downwards
    const LightId first = scene.add(light, 1.0f);
    light.shape = triangle(a, d, c);
    const LightId second = scene.add(light, 1.0f);
    Primitive square;
    square.kind = Primitive::Kind::bilinear;
    square.p[0] = a;
    square.p[1] = d;
    square.p[2] = b;
    square.p[3] = c;
    light.shape = square;
    const LightId patch = scene.add(light, 1.0f);
    for (const auto& [p, factor] :
         {std::pair(Vec3(0.5f, 0.5f, 0), 0.2394564705), std::pair(Vec3(0.0f), 0.1385316060)}) {
        const Series one = irradiance(scene, first, p, up), two = irradiance(scene, second, p, up);
        const Series whole = irradiance(scene, patch, p, up);
        EXPECT_NEAR(one.mean() + two.mean(), M_PI * factor, 3.5 * std::hypot(one.error(), two.error()));
        EXPECT_NEAR(whole.mean(), M_PI * factor, 3.5 * whole.error());
    }
    EXPECT_NEAR(power_factor(scene[patch], scene.lights), pi, 1e-4f);
    EXPECT_NEAR(power_factor(scene[first], scene.lights) + power_factor(scene[second], scene.lights), pi, 1e-4f);
}

TEST(ClosedForms, DistantLight)
{
    LightScene scene;
    Light light;
    light.kind = Light::Kind::distant;
    light.world_from_light = AnimatedTransform(look_along(Vec3(0.0f), Vec3(1, 0, -1)));  // shines down and to +x
    const LightId id = scene.add(light, 5.0f);
    expect_irradiance(scene, id, Vec3(0.3f, 7, 2), up, 5.0 * std::sqrt(0.5));
    Numbers numbers(1);
    DirectSample sample;
    ASSERT_TRUE(scene.direct(id, Vec3(0.0f), numbers, sample));
    EXPECT_LT(length(sample.wi - normalize(Vec3(-1, 0, 1))), 1e-6f);
    EXPECT_EQ(illuminance_factor(scene[id], scene.lights), 1.0f);
}

TEST(ClosedForms, Environments)
{
    LightScene scene;
    Light light;
    light.kind = Light::Kind::environment;
    const LightId constant = scene.add(light, 2.0f);
    expect_irradiance(scene, constant, Vec3(1.0f), normalize(Vec3(1, 2, 3)), 2.0 * M_PI);
    EXPECT_FLOAT_EQ(illuminance_factor(scene[constant], scene.lights), pi);

    light.kind = Light::Kind::environment_image;
    Image uniform(32, 32, 1);
    for (float& pixel : uniform.pixels) pixel = 1.0f;
    light.image = scene.add_image(make_environment_image(uniform));
    const LightId image = scene.add(light, 2.0f);
    expect_irradiance(scene, image, Vec3(1.0f), normalize(Vec3(1, 2, 3)), 2.0 * M_PI);
    EXPECT_NEAR(illuminance_factor(scene[image], scene.lights), pi, 1e-3f);

    // Any map: the factor is the irradiance of the plane z = 0 of light space from above.
    Image fine(64, 64, 1);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) fine.at(x, y, 0) = static_cast<float>(x + 2 * y);
    light.image = scene.add_image(make_environment_image(fine));
    light.world_from_light = AnimatedTransform(Transform(rotation(30, Vec3(1, 1, 0))));
    const LightId slope = scene.add(light, 1.0f);
    const Vec3 tilted = light.world_from_light.start().vector(up);
    const Series series = irradiance(scene, slope, Vec3(0.0f), tilted, 60000);
    EXPECT_NEAR(series.mean(), illuminance_factor(scene[slope], scene.lights),
                3.5 * series.error() + 3e-4 * series.mean());
}

TEST(AreaLights, EmitFromTheirSides)
{
    LightScene scene;
    Light light;
    light.kind = Light::Kind::area;
    light.shape = disk_at(up, -up, 0.3f);
    const LightId one = scene.add(light, 1.0f);
    light.two_sided = true;
    const LightId both = scene.add(light, 1.0f);
    const Vec3 below(0.0f), above(0, 0, 2);
    EXPECT_GT(irradiance(scene, one, below, up, 1000).mean(), 0.1);
    EXPECT_EQ(irradiance(scene, one, above, -up, 1000).mean(), 0.0);
    EXPECT_NEAR(irradiance(scene, both, above, -up, 4000).mean(), irradiance(scene, both, below, up, 4000).mean(),
                0.01);
    EXPECT_FLOAT_EQ(power_factor(scene[both], scene.lights), 2.0f * power_factor(scene[one], scene.lights));
    const auto emitted = [&](LightId id, const Vec3& w) {
        return emitted_area(scene.lights, scene.pool, id, Vec2(0, 0), -up, w, scene.wavelengths)[0];
    };
    EXPECT_EQ(emitted(one, -up), 1.0f);
    EXPECT_EQ(emitted(one, up), 0.0f);
    EXPECT_EQ(emitted(both, up), 1.0f);
    EXPECT_EQ(direct_pdf_area(scene.lights, one, above, -up, up, -up), 0.0f);
    EXPECT_GT(direct_pdf_area(scene.lights, both, above, -up, up, -up), 0.0f);

    // Particles: half to each side.
    Numbers numbers(1);
    int upwards = 0;
    for (int i = 0; i < 4000; ++i) {
        EmissionSample sample;
        ASSERT_TRUE(scene.emit(both, numbers, sample));
        upwards += sample.ray.direction.z > 0.0f;
        ASSERT_TRUE(scene.emit(one, numbers, sample));
        ASSERT_LT(sample.ray.direction.z, 0.0f);
    }
    EXPECT_NEAR(upwards, 2000, 110);
}

TEST(AreaLights, ShowTheirImageTopUp)
{
    LightScene scene;
    Light light;
    light.kind = Light::Kind::area;
    Image image(2, 2, 3);
    image.at(0, 0, 0) = 1.0f;  // top left red
    image.at(1, 0, 1) = 1.0f;  // top right green
    image.at(0, 1, 2) = 1.0f;  // bottom left blue
    light.image = scene.add_image(make_area_image(image));
    const LightId id = scene.add(light, 2.0f);
    const auto at = [&](float u, float v) {
        return emitted_area(scene.lights, scene.pool, id, Vec2(u, v), up, up, scene.wavelengths);
    };
    EXPECT_EQ(at(0.2f, 0.9f), Spectrum(2, 0, 0, 0));
    EXPECT_EQ(at(0.7f, 0.6f), Spectrum(0, 2, 0, 2));
    EXPECT_EQ(at(0.2f, 0.1f), Spectrum(0, 0, 2, 0));
    EXPECT_EQ(at(0.7f, 0.1f), Spectrum(0.0f));
    EXPECT_EQ(at(1.0f, 1.0f), at(0.0f, 0.0f));
}

TEST(SpotLight, FallsOffAsASmoothstep)
{
    LightScene scene;
    Light light;
    light.kind = Light::Kind::spot;
    light.world_from_light = AnimatedTransform(look_along(Vec3(0, 0, 2), -up));
    light.cos_total = std::cos(radians(50));
    light.cos_falloff = std::cos(radians(20));
    const LightId id = scene.add(light, 6.0f);
    const double k = 2 * M_PI * ((1 - light.cos_falloff) + 0.5 * (light.cos_falloff - light.cos_total));
    EXPECT_NEAR(power_factor(scene[id], scene.lights), k, 1e-5);
    Numbers numbers(1);
    for (const float angle : {0.0f, 10.0f, 19.9f, 25.0f, 35.0f, 45.0f, 49.0f, 51.0f, 90.0f, 170.0f}) {
        const Vec3 p = Vec3(0, 0, 2) + Vec3(std::sin(radians(angle)), 0, -std::cos(radians(angle))) * 2.0f;
        DirectSample sample;
        const bool lit = scene.direct(id, p, numbers, sample);
        const double t = std::clamp(
            (std::cos(radians(angle)) - light.cos_total) / (light.cos_falloff - light.cos_total), 0.0f, 1.0f);
        const double expected = 6.0 / 4.0 * t * t * (3 - 2 * t);
        EXPECT_NEAR(lit ? sample.radiance[0] : 0.0, expected, 1e-4) << angle;
    }
    // Particles follow the profile.
    constexpr int bins = 25, count = 40000;
    std::vector<double> counts(bins, 0.0), expected(bins, 0.0);
    for (int i = 0; i < count; ++i) {
        EmissionSample sample;
        ASSERT_TRUE(scene.emit(id, numbers, sample));
        const double z = -sample.ray.direction.z;
        counts[std::clamp(static_cast<int>((1.0 - z) / (1.0 - light.cos_total) * bins), 0, bins - 1)] += 1.0;
    }
    for (int i = 0; i < bins * 100; ++i) {
        const double z = 1.0 - (i + 0.5) / (bins * 100) * (1.0 - light.cos_total);
        const double t = std::clamp((z - light.cos_total) / (light.cos_falloff - light.cos_total), 0.0, 1.0);
        expected[i / 100] += count * 2 * M_PI * (1 - light.cos_total) / (bins * 100) * t * t * (3 - 2 * t) / k;
    }
    EXPECT_TRUE(chi_squared_passes(counts, expected));
}

TEST(EnvironmentImage, DirectionsFollowTheirDensity)
{
    LightScene scene;
    Light light;
    light.kind = Light::Kind::environment_image;
    light.image = scene.add_image(make_environment_image(random_map(8, 8, 3)));
    light.world_from_light = AnimatedTransform(Transform(rotation(70, Vec3(1, -2, 0.5f))));
    const LightId id = scene.add(light, 1.0f);
    // Cells equal in solid angle, of height and azimuth about the world's z axis.
    constexpr int rows = 8, columns = 12, count = 40000, grid = 200;
    std::vector<double> counts(rows * columns, 0.0), expected(rows * columns, 0.0);
    const auto cell = [](const Vec3& w) {
        const int row = std::clamp(static_cast<int>((w.z + 1.0f) * 0.5f * rows), 0, rows - 1);
        const float turn = std::atan2(w.y, w.x) / (2 * pi) + 0.5f;
        return row * columns + std::clamp(static_cast<int>(turn * columns), 0, columns - 1);
    };
    Numbers numbers(8);
    for (int i = 0; i < count; ++i) {
        DirectSample sample;
        ASSERT_TRUE(scene.direct(id, Vec3(0.0f), numbers, sample));
        counts[cell(sample.wi)] += 1.0;
    }
    double total = 0.0;
    for (int i = 0; i < 2 * grid; ++i)
        for (int j = 0; j < 3 * grid; ++j) {
            const float z = 2.0f * (i + 0.5f) / (2 * grid) - 1.0f;
            const Vec3 w = spherical_direction(safe_sqrt(1 - z * z), z, 2 * pi * (j + 0.5f) / (3 * grid));
            const double share = 4 * M_PI / (6.0 * grid * grid) * direct_pdf_environment(scene.lights, id, w);
            total += share;
            expected[cell(w)] += count * share;
        }
    EXPECT_NEAR(total, 1.0, 0.003);
    EXPECT_TRUE(chi_squared_passes(counts, expected));
}

TEST(Projection, ShowsTheImageUpright)
{
    LightScene scene;
    Light light;
    light.kind = Light::Kind::projection;
    Image image(4, 2, 3);
    image.at(0, 0, 0) = 1.0f;  // top left red
    image.at(3, 1, 2) = 1.0f;  // bottom right blue
    light.image = scene.add_image(make_projection_image(image, 90.0f, light));
    EXPECT_FLOAT_EQ(light.screen_half[0], 2.0f);
    EXPECT_FLOAT_EQ(light.screen_half[1], 1.0f);
    const LightId id = scene.add(light, 1.0f);  // at the origin, along +z, x to the right, y up
    Numbers numbers(1);
    DirectSample sample;
    ASSERT_TRUE(scene.direct(id, Vec3(-1.9f, 0.9f, 1), numbers, sample));
    EXPECT_GT(sample.radiance[0], 0.0f);
    EXPECT_EQ(sample.radiance[2], 0.0f);
    ASSERT_TRUE(scene.direct(id, Vec3(1.9f, -0.9f, 1), numbers, sample));
    EXPECT_GT(sample.radiance[2], 0.0f);
    EXPECT_FALSE(scene.direct(id, Vec3(-1.9f, 1.1f, 1), numbers, sample));
    EXPECT_FALSE(scene.direct(id, Vec3(1.9f, -0.9f, -1), numbers, sample));
    // Solid angle of a 2 x 1 half-extent screen: 4 atan(2 / sqrt(6)).
    Image white(4, 2, 1);
    for (float& pixel : white.pixels) pixel = 1.0f;
    light.image = scene.add_image(make_projection_image(white, 90.0f, light));
    EXPECT_NEAR(power_factor(light, scene.lights), 4 * std::atan(2 / std::sqrt(6.0)), 1e-5);
}

TEST(LatLong, BecomesAnEqualAreaMapOfTheSameLight)
{
    Image latlong(64, 32, 3);
    double expected[3] = {0, 0, 0};
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x)
            for (int c = 0; c < 3; ++c) {
                const double theta = M_PI * (y + 0.5) / 32, phi = 2 * M_PI * (x + 0.5) / 64;
                const Vec3 d = spherical_direction(float(std::sin(theta)), float(std::cos(theta)), float(phi));
                latlong.at(x, y, c) = 1.0f + d[c] + 0.5f * d[c] * d[(c + 1) % 3];
                expected[c] += latlong.at(x, y, c) * (std::cos(M_PI * y / 32) - std::cos(M_PI * (y + 1) / 32)) / 2 / 64;
            }
    ASSERT_TRUE(is_latlong(latlong));
    const Image map = equal_area_from_latlong(latlong);
    ASSERT_EQ(map.width, map.height);
    double mean[3] = {0, 0, 0};
    for (int i = 0; i < map.width * map.height; ++i)
        for (int c = 0; c < 3; ++c) mean[c] += map.pixels[size_t(i) * 3 + c] / (map.width * map.height);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], expected[c], 2e-3);

    LightScene scene;
    Light light;
    light.kind = Light::Kind::environment_image;
    light.image = scene.add_image(make_environment_image(map));
    const LightId id = scene.add(light, 1.0f);
    for (const Vec3& d : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), normalize(Vec3(-1, 2, -3))}) {
        const Spectrum seen = emitted_environment(scene.lights, scene.pool, id, d, scene.wavelengths);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], 1.0f + d[c] + 0.5f * d[c] * d[(c + 1) % 3], 0.08f);
    }
}

TEST(LightImages, RejectWhatIsNoMap)
{
    EXPECT_THROW(make_environment_image(Image(4, 2, 3)), UserError);
    EXPECT_THROW(make_goniometric_image(Image(4, 2, 1)), UserError);
    EXPECT_THROW(make_environment_image(Image()), UserError);
    Image bad(4, 4, 3);
    bad.at(1, 2, 0) = infinity;
    EXPECT_THROW(make_environment_image(bad), UserError);
    EXPECT_THROW(make_area_image(bad), UserError);
    bad.at(1, 2, 0) = std::nanf("");
    Light light;
    EXPECT_THROW(make_projection_image(bad, 45.0f, light), UserError);
    // Negative pixels become black; a black map emits nothing, and says so.
    LightScene scene;
    light.kind = Light::Kind::environment_image;
    bad.at(1, 2, 0) = -1.0f;
    light.image = scene.add_image(make_environment_image(bad));
    const LightId id = scene.add(light, 1.0f);
    EXPECT_EQ(power(scene.lights, scene.pool, id), 0.0f);
    Numbers numbers(1);
    DirectSample direct;
    EmissionSample emission;
    EXPECT_FALSE(scene.direct(id, Vec3(0.0f), numbers, direct));
    EXPECT_FALSE(scene.emit(id, numbers, emission));
}

}  // namespace
}  // namespace dapple
