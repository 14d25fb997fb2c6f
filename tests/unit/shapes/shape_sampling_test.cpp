// Sampling of primitives: chi-squared of the area sampler against its density, solid-angle samples against quadrature
// over the surface, agreement of sampled and evaluated densities, closed forms near and far.
#include "dapple/shapes/primitive.h"

#include "shape_fixtures.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

using Kind = Primitive::Kind;
constexpr int bins_per_axis = 4;
constexpr size_t bin_count = bins_per_axis * bins_per_axis;

// Bins follow the parameters of hit_at, so that cells lie in one bin each (triangles: u = b1 + b2, v = b2).
size_t bin_of(const Primitive& primitive, const Vec2& surface_uv)
{
    const bool triangle = primitive.kind == Kind::triangle;
    const Vec2 uv(surface_uv.x, triangle ? surface_uv.y / std::max(surface_uv.x, 1e-9f) : surface_uv.y);
    const int i = std::clamp(static_cast<int>(uv.x * bins_per_axis), 0, bins_per_axis - 1);
    const int j = std::clamp(static_cast<int>(uv.y * bins_per_axis), 0, bins_per_axis - 1);
    return static_cast<size_t>(j * bins_per_axis + i);
}

// A piece of the surface for quadrature.
struct Cell {
    Vec3 position, normal;
    double area;
    size_t bin;
};

std::vector<Cell> cells_of(const Primitive& primitive)
{
    constexpr int n = 160;
    std::vector<Cell> cells;
    const auto at = [&](float i, float j) {
        return surface_point(primitive, hit_at(primitive, Vec2(i / n, j / n)), 0.0f);
    };
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const float x = static_cast<float>(i), y = static_cast<float>(j);
            const SurfacePoint middle = at(x + 0.5f, y + 0.5f);
            const Vec3 across = at(x + 1, y + 0.5f).position - at(x, y + 0.5f).position;
            const Vec3 along = at(x + 0.5f, y + 1).position - at(x + 0.5f, y).position;
            cells.push_back(
                {middle.position, middle.n_geometric, length(cross(across, along)), bin_of(primitive, middle.uv)});
        }
    return cells;
}

TEST(ShapeSampling, AreaSamplesFollowTheirDensity)
{
    // 15 degrees of freedom at 1 %: 30.58; 14 primitives are tested, so the level is 1 % / 14: 39.9.
    constexpr uint64_t count = 40000;
    for (const auto& [name, primitive] : all_primitives()) {
        std::vector<double> expected(bin_count, 0.0), observed(bin_count, 0.0);
        double total = 0.0;
        for (const Cell& cell : cells_of(primitive)) {
            expected[cell.bin] += cell.area * pdf_area(primitive, cell.position);
            total += cell.area * pdf_area(primitive, cell.position);
        }
        EXPECT_NEAR(total, 1.0, 1e-3) << name;
        for (uint64_t i = 0; i < count; ++i) {
            const ShapeSample sample = sample_area(primitive, random_2d(i, 1));
            ASSERT_NEAR(pdf_area(primitive, sample.position) / sample.pdf, 1.0f, 2e-5f) << name;
            observed[bin_of(primitive, sample.uv)] += 1.0;
        }
        double chi2 = 0.0;
        for (size_t b = 0; b < bin_count; ++b) {
            if (expected[b] > 1e-9)
                chi2 += sqr(observed[b] - expected[b] * count / total) / (expected[b] * count / total);
            else
                EXPECT_EQ(observed[b], 0.0) << name;
        }
        EXPECT_LT(chi2, 39.9) << name;
    }
}

TEST(ShapeSampling, AreaSamplesAreUniformWherePromised)
{
    for (const auto& [name, primitive] : all_primitives()) {
        if (name.find("ellipsoid") != std::string::npos || name == "uneven cylinder") continue;
        if (name == "flat quad" || name == "twisted patch") continue;
        for (uint64_t i = 0; i < 50; ++i)
            EXPECT_NEAR(sample_area(primitive, random_2d(i, 1)).pdf * area(primitive), 1.0f, 1e-5f) << name;
    }
}

// The integral of |cos| / d^2 over each bin of the surface as seen from `reference`.
std::vector<double> solid_angles(const std::vector<Cell>& cells, const Vec3& reference, bool front_only)
{
    std::vector<double> result(bin_count, 0.0);
    for (const Cell& cell : cells) {
        const Vec3 to_reference = reference - cell.position;
        const double d2 = length_squared(to_reference);
        const double cosine = dot(cell.normal, to_reference) / std::sqrt(d2);
        if (!front_only || cosine > 0.0) result[cell.bin] += std::abs(cosine) / d2 * cell.area;
    }
    return result;
}

TEST(ShapeSampling, SolidAngleSamplesMatchQuadrature)
{
    // 14 primitives x 3 references x 16 bins: 4.6 standard deviations keep the whole below 1 %.
    constexpr uint64_t count = 20000;
    for (const auto& [name, primitive] : all_primitives()) {
        const std::vector<Cell> cells = cells_of(primitive);
        const Vec3 centre = bounds(primitive).center();
        const bool whole_sphere = name == "sphere" || name == "mirrored sphere" || name == "ellipsoid";
        for (int place = 0; place < 3; ++place) {
            const bool inside = place == 2;
            const Vec3 reference = inside ? centre + Vec3(0.11f, -0.17f, 0.23f)
                                          : centre + normalize(Vec3(0.5f, 1.0f, 0.8f)) * (place == 0 ? 2.0f : 20.0f);
            const std::vector<double> expected = solid_angles(cells, reference, whole_sphere && !inside);
            double total = 0.0;
            for (double e : expected) total += e;
            std::vector<double> sum(bin_count, 0.0), squares(bin_count, 0.0);
            for (uint64_t i = 0; i < count; ++i) {
                ShapeSample sample;
                if (!sample_solid_angle(primitive, reference, random_2d(i, 1), sample)) continue;
                const Vec3 wi = normalize(sample.position - reference);
                ASSERT_NEAR(pdf_solid_angle(primitive, reference, wi, sample.position, sample.normal) / sample.pdf,
                            1.0f, 1e-4f)
                    << name << place;
                const double x = 1.0 / sample.pdf;
                sum[bin_of(primitive, sample.uv)] += x;
                squares[bin_of(primitive, sample.uv)] += x * x;
            }
            for (size_t b = 0; b < bin_count; ++b) {
                const double mean = sum[b] / count;
                const double error = std::sqrt(std::max(0.0, squares[b] / count - mean * mean) / count);
                EXPECT_LT(std::abs(mean - expected[b]), 4.6 * error + 1e-3 * total) << name << place << " bin " << b;
            }
        }
    }
}

TEST(ShapeSampling, SpheresAndTrianglesAreUniformInSolidAngle)
{
    for (const auto& [name, primitive] : all_primitives()) {
        if (name != "sphere" && name != "mirrored sphere" && name != "triangle") continue;
        const Vec3 reference = bounds(primitive).center() + Vec3(0.9f, 1.3f, 1.2f);
        ShapeSample first;
        ASSERT_TRUE(sample_solid_angle(primitive, reference, {0.5f, 0.5f}, first));
        for (uint64_t i = 0; i < 100; ++i) {
            ShapeSample sample;
            ASSERT_TRUE(sample_solid_angle(primitive, reference, random_2d(i, 1), sample));
            EXPECT_NEAR(sample.pdf / first.pdf, 1.0f, 1e-5f) << name;
        }
    }
}

TEST(ShapeSampling, SphereConesAreAccurateNearAndFar)
{
    Primitive sphere;
    sphere.kind = Kind::sphere;
    sphere.world_from_object = Transform(translation({1.0f, 2.0f, 3.0f}));
    const Vec3 centre(1.0f, 2.0f, 3.0f);
    for (double height : {1e-4, 0.1, 10.0, 1e3, 1e5}) {
        const Vec3 reference = centre + Vec3(0.0f, static_cast<float>(1.0 + height), 0.0f);
        const double d = static_cast<double>(reference.y) - centre.y;
        const double sin2 = 1.0 / (d * d);
        const double expected = 1.0 / (2.0 * 3.14159265358979 * sin2 / (1.0 + std::sqrt(1.0 - sin2)));
        for (uint64_t i = 0; i < 200; ++i) {
            ShapeSample sample;
            ASSERT_TRUE(sample_solid_angle(sphere, reference, random_2d(i, 1), sample));
            EXPECT_NEAR(sample.pdf / expected, 1.0, 1e-5) << height;
            EXPECT_NEAR(length(sample.position - centre), 1.0f, 1e-6f) << height;
            // The visible cap begins at height 1 / d above the centre.
            EXPECT_GT(sample.position.y - centre.y, 1.0 / d - 1e-5) << height;
        }
    }
}

TEST(ShapeSampling, TriangleDensityIsOneOverTheOctant)
{
    Primitive triangle;
    triangle.p[0] = Vec3(1, 0, 0);
    triangle.p[1] = Vec3(0, 1, 0);
    triangle.p[2] = Vec3(0, 0, 1);
    ShapeSample sample;
    ASSERT_TRUE(sample_solid_angle(triangle, Vec3(0, 0, 0), {0.3f, 0.6f}, sample));
    EXPECT_NEAR(sample.pdf, 2.0f / pi, 1e-6f);
    // In the triangle's plane nothing is visible but for rounding; a triangle without area has nothing to sample.
    if (sample_solid_angle(triangle, Vec3(2, -2, 1), {0.3f, 0.6f}, sample)) {
        EXPECT_GT(sample.pdf, 1e6f);
    }
    triangle.p[2] = triangle.p[1];
    EXPECT_FALSE(sample_solid_angle(triangle, Vec3(0, 0, 0), {0.3f, 0.6f}, sample));
    EXPECT_EQ(sample_area(triangle, {0.3f, 0.6f}).pdf, 0.0f);
}

// Near triangles are sampled by solid angle, far ones by area; the change is at 3.5 radii.
TEST(ShapeSampling, DensitiesOfTrianglesHoldOnBothSidesOfTheChange)
{
    Primitive triangle;
    triangle.p[0] = Vec3(0.2f, -0.1f, 0.3f);
    triangle.p[1] = Vec3(1.1f, 0.4f, 0.1f);
    triangle.p[2] = Vec3(0.3f, 0.9f, 0.5f);
    const Vec3 centroid = (triangle.p[0] + triangle.p[1] + triangle.p[2]) / 3.0f;
    float radius = 0.0f;
    for (int i = 0; i < 3; ++i) radius = std::max(radius, length(triangle.p[i] - centroid));
    const std::vector<Cell> cells = cells_of(triangle);
    constexpr uint64_t count = 20000;
    for (const float radii : {3.3f, 3.49f, 3.51f, 3.7f})
        for (const Vec3& towards : {Vec3(0.2f, -0.4f, 1.0f), Vec3(1.0f, 0.3f, 0.1f), Vec3(-0.5f, -1.0f, -0.9f)}) {
            const Vec3 reference = centroid + normalize(towards) * (radii * radius);
            double expected = 0.0;
            for (const double e : solid_angles(cells, reference, false)) expected += e;
            double sum = 0.0, squares = 0.0;
            float least = 1e30f, most = 0.0f;
            for (uint64_t i = 0; i < count; ++i) {
                ShapeSample sample;
                ASSERT_TRUE(sample_solid_angle(triangle, reference, random_2d(i, 1), sample));
                const Vec3 wi = normalize(sample.position - reference);
                ASSERT_NEAR(pdf_solid_angle(triangle, reference, wi, sample.position, sample.normal) / sample.pdf, 1.0f,
                            1e-4f)
                    << radii;
                sum += 1.0 / sample.pdf;
                squares += 1.0 / (double(sample.pdf) * sample.pdf);
                least = std::min(least, sample.pdf);
                most = std::max(most, sample.pdf);
            }
            const double mean = sum / count;
            const double error = std::sqrt(std::max(0.0, squares / count - mean * mean) / count);
            EXPECT_LT(std::abs(mean - expected), 4.6 * error + 1e-3 * expected) << radii;
            EXPECT_EQ(most / least < 1.0001f, radii < 3.5f) << "by solid angle, or by area: " << radii;
        }
}

TEST(ShapeSampling, ThinAndDistantTrianglesKeepTheirMoments)
{
    // A sliver seen at an angle, from near and from far: the mean position must be the one by quadrature.
    Primitive triangle;
    triangle.p[0] = Vec3(0, 0, 0);
    triangle.p[1] = Vec3(10, 0, 0);
    triangle.p[2] = Vec3(10, 0.05f, 0);
    const std::vector<Cell> cells = cells_of(triangle);
    for (const Vec3& reference : {Vec3(1, 0.1f, 0.3f), Vec3(3, 5, 40)}) {
        double expected = 0.0, expected_x = 0.0;
        for (const Cell& cell : cells) {
            const Vec3 d = reference - cell.position;
            const double omega = cell.area * std::abs(dot(cell.normal, d)) / std::pow(length(d), 3.0);
            expected += omega;
            expected_x += omega * cell.position.x;
        }
        double sum = 0.0, sum_x = 0.0;
        constexpr uint64_t count = 50000;
        for (uint64_t i = 0; i < count; ++i) {
            ShapeSample sample;
            if (!sample_solid_angle(triangle, reference, random_2d(i, 1), sample)) continue;
            sum += 1.0 / sample.pdf;
            sum_x += sample.position.x / sample.pdf;
        }
        EXPECT_NEAR(sum / count / expected, 1.0, 0.01);
        EXPECT_NEAR(sum_x / count / expected_x, 1.0, 0.03);
    }
}

}  // namespace
}  // namespace dapple
