// Gradients against closed forms and finite differences.
#include "dapple/density/hemisphere.h"

#include <gtest/gtest.h>

#include "dapple/sampling/random_stream.h"

#include <vector>

namespace dapple {
namespace {

struct Seen {
    float radiance;
    float distance;
};

// Integrates what `look(direction)` sees, in strata of about `rays` rays.
template <class Look>
HemisphereIrradiance integrate(int rays, uint64_t seed, const Look& look)
{
    const HemisphereStrata strata = HemisphereStrata::of(rays);
    std::vector<Spectrum> radiance;
    std::vector<float> distance, u_ring;
    for (int ring = 0; ring < strata.rings; ++ring)
        for (int sector = 0; sector < strata.sectors; ++sector) {
            RandomStream random(seed, 1, static_cast<uint32_t>(strata.index(ring, sector)));
            const Vec2 u = random.next_2d();
            const Seen seen = look(strata.direction(ring, sector, u));
            radiance.push_back(Spectrum(seen.radiance));
            distance.push_back(seen.distance);
            u_ring.push_back(u.x);
        }
    return integrate_hemisphere(strata, radiance, distance, u_ring);
}

// The mean over seeds: single gradients are noisy.
template <class Look>
HemisphereIrradiance mean(int rays, const Look& look)
{
    HemisphereIrradiance sum;
    constexpr int seeds = 40;
    for (uint64_t seed = 0; seed < seeds; ++seed) {
        const HemisphereIrradiance one = integrate(rays, seed, look);
        sum.value += one.value * (1.0f / seeds);
        sum.rotation_x += one.rotation_x * (1.0f / seeds);
        sum.rotation_y += one.rotation_y * (1.0f / seeds);
        sum.translation_x += one.translation_x * (1.0f / seeds);
        sum.translation_y += one.translation_y * (1.0f / seeds);
    }
    return sum;
}

// A ceiling at height h of radiance 1 beyond x = edge (black before it), seen from the origin:
// E = pi / 2 (1 - edge / sqrt(h^2 + edge^2)), and dE / d(shift along x) = pi / 2 h^2 / (h^2 + edge^2)^(3/2).
TEST(Hemisphere, MovesUnderHalfACeilingAsTheClosedFormSays)
{
    constexpr float h = 2.0f;
    for (const float edge : {0.0f, 0.7f, -1.5f}) {
        const auto look = [&](const Vec3& d) {
            const float t = h / d.z;
            return Seen{t * d.x > edge ? 1.0f : 0.0f, t};
        };
        const float root = std::sqrt(h * h + edge * edge);
        const HemisphereIrradiance e = mean(1000, look);
        EXPECT_NEAR(e.value[0], 0.5f * pi * (1.0f - edge / root), 0.01f);
        const float slope = 0.5f * pi * h * h / (root * root * root);
        EXPECT_NEAR(e.translation_x[0], slope, 0.04f * slope) << edge;
        EXPECT_NEAR(e.translation_y[0], 0.0f, 0.02f * slope) << edge;
    }
}

// The same ceiling turned by 1 radian: the gradient turns with it, whatever the sectors.
TEST(Hemisphere, GradientsTurnWithTheScene)
{
    const float c = std::cos(1.0f), s = std::sin(1.0f);
    const HemisphereIrradiance e = mean(1000, [&](const Vec3& d) {
        const float t = 2.0f / d.z;
        return Seen{t * (d.x * c + d.y * s) > 0.3f ? 1.0f : 0.0f, t};
    });
    const float root = std::sqrt(4.0f + 0.09f);
    const float slope = 0.5f * pi * 4.0f / (root * root * root);
    EXPECT_NEAR(e.translation_x[0], slope * c, 0.04f * slope);
    EXPECT_NEAR(e.translation_y[0], slope * s, 0.04f * slope);
}

// A smooth ceiling, by finite differences: a panel with a bright Gaussian spot.
TEST(Hemisphere, TranslationAgreesWithFiniteDifferences)
{
    const auto from = [](float x) {
        return [x](const Vec3& d) {
            const float t = 1.0f / d.z;
            const float px = x + t * d.x - 0.6f, py = t * d.y;
            return Seen{std::exp(-2.0f * (px * px + py * py)), t};
        };
    };
    const float step = 0.05f;
    const float difference = (mean(4000, from(step)).value[0] - mean(4000, from(-step)).value[0]) / (2.0f * step);
    EXPECT_NEAR(mean(4000, from(0.0f)).translation_x[0], difference, 0.04f * difference);
}

// Radiance 1 + w . a all around: E(n) = pi + 2 pi / 3 n . a in the upper half; turning n by small angles about the
// tangent plane's axes changes E by cross(n, n') . rotation.
TEST(Hemisphere, TurnsAsTheClosedFormSays)
{
    const Vec3 a(0.5f, -0.3f, 0.2f);
    const HemisphereIrradiance e = mean(4000, [&](const Vec3& d) { return Seen{1.0f + dot(d, a), infinity}; });
    EXPECT_NEAR(e.value[0], pi + 2.0f * pi / 3.0f * a.z, 0.01f);
    // n' = n + epsilon x: cross(z, x) = y; E changes by 2 pi / 3 a.x.
    EXPECT_NEAR(e.rotation_y[0], 2.0f * pi / 3.0f * a.x, 0.03f);
    // n' = n + epsilon y: cross(z, y) = -x.
    EXPECT_NEAR(-e.rotation_x[0], 2.0f * pi / 3.0f * a.y, 0.03f);
    EXPECT_EQ(e.translation_x[0], 0.0f);  // all of it infinitely far
}

TEST(Hemisphere, HarmonicMeanIgnoresWhatIsNotMet)
{
    const std::vector<float> distances = {1.0f, infinity, infinity, infinity};
    EXPECT_FLOAT_EQ(harmonic_mean(distances), 4.0f);
    EXPECT_EQ(harmonic_mean(std::vector<float>{infinity}), infinity);
}

}  // namespace
}  // namespace dapple
