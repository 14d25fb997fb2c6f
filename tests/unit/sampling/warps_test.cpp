// Warps of the unit square: chi-squared against the density, inverses, and densities against numerical Jacobians.
#include "dapple/sampling/warps.h"

#include "dapple/math/hash.h"
#include "statistics.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

using testing_support::chi_squared_passes;

Vec2 point(uint64_t seed, uint64_t i)
{
    const uint64_t bits = hash_words(seed, i);
    return {to_unit_float(bits), to_unit_float(bits << 32)};
}

// Area of the image of a small square around u, over the square's area; 1 / density where the map is smooth.
template <class Map>
double stretch(const Map& map, const Vec2& u)
{
    const float h = 1e-3f;
    const Vec3 du = map({u.x + h, u.y}) - map({u.x - h, u.y});
    const Vec3 dv = map({u.x, u.y + h}) - map({u.x, u.y - h});
    return length(cross(du, dv)) / (4.0 * h * h);
}

template <class Map, class Density>
void expect_density_is_jacobian(const Map& map, const Density& density)
{
    for (int i = 0; i < 300; ++i) {
        const Vec2 u = Vec2(0.02f, 0.02f) + point(11, i) * 0.96f;
        const Vec2 centred(std::fabs(u.x - 0.5f), std::fabs(u.y - 0.5f));
        if (std::fabs(centred.x - centred.y) < 5e-3f || std::fabs(u.x - u.y) < 5e-3f) continue;  // seams
        EXPECT_NEAR(stretch(map, u) * density(map(u)), 1.0, 1e-2) << u.x << " " << u.y;
    }
}

// Chi-squared over cells of equal solid angle in height and azimuth; mass(z0, z1) is the probability of a height band.
template <class Map, class Mass>
bool heights_and_azimuths_fit(const Map& map, float z_low, float z_high, const Mass& mass)
{
    const int n = 100000, bands = 12, sectors = 16;
    std::vector<double> counts(bands * sectors), expected(bands * sectors);
    for (int i = 0; i < n; ++i) {
        const Vec3 w = map(point(12, i));
        EXPECT_NEAR(length(w), 1.0f, 1e-5f);
        const int band = std::clamp(static_cast<int>((w.z - z_low) / (z_high - z_low) * bands), 0, bands - 1);
        const float turn = std::atan2(w.y, w.x) / (2.0f * pi) + 0.5f;
        ++counts[band * sectors + std::clamp(static_cast<int>(turn * sectors), 0, sectors - 1)];
    }
    for (int i = 0; i < bands * sectors; ++i) {
        const double step = (double(z_high) - z_low) / bands;
        const double z0 = z_low + step * (i / sectors);
        expected[i] = n * mass(z0, z0 + step) / sectors;
    }
    return chi_squared_passes(counts, expected);
}

TEST(Warps, DiskIsUniform)
{
    const int n = 100000, rings = 8, sectors = 16;
    std::vector<double> counts(rings * sectors), expected(rings * sectors, n / double(rings * sectors));
    for (int i = 0; i < n; ++i) {
        const Vec2 p = sample_disk_concentric(point(13, i));
        const float r2 = p.x * p.x + p.y * p.y;
        ASSERT_LE(r2, 1.00001f);
        const float turn = std::atan2(p.y, p.x) / (2.0f * pi) + 0.5f;
        ++counts[std::min(static_cast<int>(r2 * rings), rings - 1) * sectors +
                 std::min(static_cast<int>(turn * sectors), sectors - 1)];
    }
    EXPECT_TRUE(chi_squared_passes(counts, expected));
    expect_density_is_jacobian(
        [](const Vec2& u) {
            const Vec2 p = sample_disk_concentric(u);
            return Vec3(p.x, p.y, 0.0f);
        },
        [](const Vec3&) { return pdf_disk(); });
}

TEST(Warps, CosineHemisphere)
{
    const auto map = [](const Vec2& u) { return sample_cosine_hemisphere(u); };
    EXPECT_TRUE(heights_and_azimuths_fit(map, 0.0f, 1.0f, [](double a, double b) { return b * b - a * a; }));
    expect_density_is_jacobian(map, [](const Vec3& w) { return pdf_cosine_hemisphere(w.z); });
    EXPECT_EQ(pdf_cosine_hemisphere(-0.5f), 0.0f);
}

TEST(Warps, UniformHemisphereAndSphere)
{
    const auto hemisphere = [](const Vec2& u) { return sample_uniform_hemisphere(u); };
    EXPECT_TRUE(heights_and_azimuths_fit(hemisphere, 0.0f, 1.0f, [](double a, double b) { return b - a; }));
    expect_density_is_jacobian(hemisphere, [](const Vec3&) { return pdf_uniform_hemisphere(); });

    const auto sphere = [](const Vec2& u) { return sample_uniform_sphere(u); };
    EXPECT_TRUE(heights_and_azimuths_fit(sphere, -1.0f, 1.0f, [](double a, double b) { return 0.5 * (b - a); }));
    expect_density_is_jacobian(sphere, [](const Vec3&) { return pdf_uniform_sphere(); });
}

TEST(Warps, UniformCone)
{
    for (const float cos_max : {0.3f, -0.5f}) {
        const auto map = [=](const Vec2& u) { return sample_uniform_cone(u, cos_max); };
        EXPECT_TRUE(heights_and_azimuths_fit(map, cos_max, 1.0f,
                                             [=](double a, double b) { return (b - a) / (1.0 - cos_max); }));
        expect_density_is_jacobian(map, [=](const Vec3&) { return pdf_uniform_cone(cos_max); });
    }
}

TEST(Warps, NarrowConeKeepsItsPrecision)
{
    // The sun: 0.2666 degrees. The angle at u.x = 0.25 is half of that at 1, which a float cosine cannot resolve.
    const double angle = 0.2666 * 3.14159265358979 / 180.0;
    const float versine = static_cast<float>(2.0 * std::pow(std::sin(0.5 * angle), 2.0));
    const Vec3 edge = sample_uniform_cone_versine({1.0f, 0.0f}, versine);
    const Vec3 middle = sample_uniform_cone_versine({0.25f, 0.0f}, versine);
    EXPECT_NEAR(edge.x / std::sin(angle), 1.0, 1e-6);
    EXPECT_NEAR(middle.x / std::sin(0.5 * angle), 1.0, 1e-5);
    EXPECT_NEAR(pdf_uniform_cone_versine(versine) * 2.0 * 3.14159265 * (1.0 - std::cos(angle)), 1.0, 1e-5);
}

TEST(Warps, TriangleIsUniform)
{
    const int n = 100000, side = 8;
    std::vector<double> counts(side * side), expected(side * side);
    for (int i = 0; i < n; ++i) {
        const Vec3 b = sample_triangle(point(14, i));
        ASSERT_GE(b.z, 0.0f);
        ASSERT_NEAR(b.x + b.y + b.z, 1.0f, 1e-6f);
        ++counts[std::min(static_cast<int>(b.x * side), side - 1) * side +
                 std::min(static_cast<int>(b.y * side), side - 1)];
    }
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j)
            expected[i * side + j] = i + j < side - 1 ? 2.0 * n / (side * side) : i + j == side - 1 ? n / 64.0 : 0.0;
    EXPECT_TRUE(chi_squared_passes(counts, expected));
    expect_density_is_jacobian(
        [](const Vec2& u) {
            const Vec3 b = sample_triangle(u);
            return Vec3(b.x, b.y, 0.0f);  // a triangle of area 1/2
        },
        [](const Vec3&) { return 2.0f; });
}

TEST(Warps, InversesReturnTheNumbers)
{
    for (int i = 0; i < 5000; ++i) {
        const Vec2 u = point(15, i);
        const auto expect_same = [&](const Vec2& back, float tolerance) {
            EXPECT_NEAR(back.x, u.x, tolerance);
            EXPECT_NEAR(back.y, u.y, tolerance);
        };
        expect_same(invert_disk_concentric(sample_disk_concentric(u)), 1e-6f);
        expect_same(invert_cosine_hemisphere(sample_cosine_hemisphere(u)), 1e-6f);
        if (u.x > 1e-3f && u.x < 0.999f) {  // the azimuth is lost at the poles
            expect_same(invert_uniform_hemisphere(sample_uniform_hemisphere(u)), 1e-5f);
            expect_same(invert_uniform_sphere(sample_uniform_sphere(u)), 1e-5f);
            expect_same(invert_uniform_cone(sample_uniform_cone(u, 0.25f), 0.25f), 1e-5f);
        }
        expect_same(invert_triangle(sample_triangle(u)), 1e-6f);
    }
}

}  // namespace
}  // namespace dapple
