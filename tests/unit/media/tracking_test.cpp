// Majorants and the walk through them: bounds everywhere, no length lost or counted twice, and unbiased transmittance.

#include "media_support.h"

#include <gtest/gtest.h>

#include <limits>

namespace dapple {
namespace {

using namespace testing_support;

std::vector<MajorantSegment> segments_of(const GridScene& scene, const Ray& ray, float t_max,
                                         const Wavelengths& wavelengths)
{
    MajorantTracker tracker(scene.media, scene.pool, scene.medium, ray, t_max, wavelengths);
    std::vector<MajorantSegment> segments;
    MajorantSegment segment;
    while (tracker.next_segment(segment)) segments.push_back(segment);
    return segments;
}

// The overlap of the ray with the medium's box, in double precision; false when there is none.
bool overlap(const GridScene& scene, const Ray& ray, double t_max, double& t0, double& t1)
{
    const Vec3 o = scene.medium.medium_from_world.point(ray.origin);
    const Vec3 d = scene.medium.medium_from_world.vector(ray.direction);
    t0 = 0.0;
    t1 = t_max;
    for (int axis = 0; axis < 3; ++axis) {
        const double a = (double(scene.medium.grid_bounds.min[axis]) - o[axis]) / d[axis];
        const double b = (double(scene.medium.grid_bounds.max[axis]) - o[axis]) / d[axis];
        t0 = std::max(t0, std::min(a, b));
        t1 = std::min(t1, std::max(a, b));
    }
    return t0 < t1;
}

Wavelengths spectral() { return Wavelengths::sample_visible(0.3f); }

TEST(Majorants, BoundTheExtinctionEverywhere)
{
    for (const Medium::Kind kind : {Medium::Kind::uniform_grid, Medium::Kind::rgb_grid}) {
        const GridScene scene(kind);
        Numbers numbers(3);
        double slack = 0.0;
        int points = 0;
        for (int i = 0; i < 1500; ++i) {
            const Ray ray = scene.random_ray(numbers);
            const Wavelengths wavelengths = i % 2 ? Wavelengths::rgb() : Wavelengths::sample_visible(numbers.next());
            for (const MajorantSegment& segment : segments_of(scene, ray, 20.0f, wavelengths))
                for (int k = 0; k < 6; ++k) {
                    // Both ends too: there a point may round into the neighbouring cell.
                    const float part = k == 0 ? 0.0f : (k == 1 ? 1.0f : numbers.next());
                    const Vec3 p = ray.at(lerp(part, segment.t_min, segment.t_max));
                    const Spectrum sigma_t = scene.sigma_t(p, wavelengths);
                    for (int lane = 0; lane < Spectrum::lanes; ++lane)
                        ASSERT_LE(sigma_t[lane], segment.majorant[lane] * 1.00001f);
                    if (segment.majorant[1] > 0.0f) {
                        slack += sigma_t[1] / segment.majorant[1];
                        ++points;
                    }
                }
        }
        // Neither loose to uselessness nor suspiciously perfect.
        EXPECT_GT(slack / points, 0.1);
        EXPECT_LT(slack / points, 0.9);
    }
}

TEST(Majorants, SegmentsCoverTheOverlapExactly)
{
    const GridScene scene;
    Numbers numbers(4);
    for (int i = 0; i < 3000; ++i) {
        const Ray ray = scene.random_ray(numbers);
        const float t_max = i % 3 == 0 ? 6.0f * numbers.next() : infinity;
        const auto segments = segments_of(scene, ray, t_max, spectral());
        double t0, t1;
        if (!overlap(scene, ray, t_max, t0, t1)) {
            EXPECT_LT(segments.empty() ? 0.0f : segments.back().t_max - segments.front().t_min, 1e-5f);
            continue;
        }
        ASSERT_FALSE(segments.empty());
        EXPECT_NEAR(segments.front().t_min, t0, 1e-5);
        EXPECT_NEAR(segments.back().t_max, t1, 1e-5);
        for (size_t k = 0; k < segments.size(); ++k) {
            EXPECT_LT(segments[k].t_min, segments[k].t_max);
            if (k > 0) {
                EXPECT_EQ(segments[k].t_min, segments[k - 1].t_max);
            }
        }
    }
}

// A box [0,8]^3 in world space with one majorant cell per unit and a different majorant in each.
GridScene unit_cells()
{
    GridScene scene;
    scene.medium.medium_from_world = Transform();
    scene.medium.grid_bounds = Box3(Vec3(0.0f), Vec3(8.0f));
    MajorantGrid& grid = scene.media.majorants[0];
    grid.nx = grid.ny = grid.nz = 8;
    grid.values.clear();
    for (int i = 0; i < 512; ++i) grid.values.push_back(static_cast<float>(i + 1));
    scene.medium.sigma_a = make_constant(1.0f);
    scene.medium.sigma_s = make_constant(0.0f);
    return scene;
}

void expect_cells(const GridScene& scene, const Ray& ray, float t_max, const std::vector<std::array<int, 3>>& cells)
{
    const auto segments = segments_of(scene, ray, t_max, spectral());
    ASSERT_EQ(segments.size(), cells.size());
    for (size_t i = 0; i < cells.size(); ++i)
        EXPECT_EQ(segments[i].majorant[0], static_cast<float>((cells[i][2] * 8 + cells[i][1]) * 8 + cells[i][0] + 1))
            << i;
}

TEST(Majorants, AxisParallelAndDiagonalRays)
{
    const GridScene scene = unit_cells();
    for (int axis = 0; axis < 3; ++axis)
        for (const float sign : {1.0f, -1.0f}) {
            std::vector<std::array<int, 3>> cells;
            Ray ray;
            ray.origin = Vec3(2.5f);
            ray.direction = Vec3(0.0f);
            ray.origin[axis] = sign > 0 ? -3.0f : 11.0f;
            ray.direction[axis] = sign;
            for (int i = 0; i < 8; ++i) {
                cells.push_back({2, 2, 2});
                cells.back()[axis] = sign > 0 ? i : 7 - i;
            }
            expect_cells(scene, ray, infinity, cells);
            ray.origin[(axis + 1) % 3] = 8.5f;  // beside the box
            expect_cells(scene, ray, infinity, {});
            // In the plane of a face and along an edge: within the box, in its outermost cells.
            ray.origin[(axis + 1) % 3] = 8.0f;
            ray.origin[(axis + 2) % 3] = 0.0f;
            for (auto& cell : cells) {
                cell[(axis + 1) % 3] = 7;
                cell[(axis + 2) % 3] = 0;
            }
            expect_cells(scene, ray, infinity, cells);
            // In a wall between cells: eight cells of length one, whichever side.
            ray.origin[(axis + 1) % 3] = 3.0f;
            EXPECT_EQ(segments_of(scene, ray, infinity, spectral()).size(), 8u);
        }
    // Negative zero is no direction either.
    Ray ray;
    ray.origin = Vec3(1.5f, 1.5f, 6.5f);
    ray.direction = Vec3(-0.0f, -0.0f, 1.0f);
    expect_cells(scene, ray, infinity, {{1, 1, 6}, {1, 1, 7}});
    // From a cell's corner, and backwards from there.
    ray.origin = Vec3(7.0f, 7.0f, 7.0f);
    ray.direction = normalize(Vec3(1.0f));
    expect_cells(scene, ray, infinity, {{7, 7, 7}});
    ray.direction = -ray.direction;
    const auto back = segments_of(scene, ray, infinity, spectral());
    EXPECT_NEAR(back.back().t_max, 7.0f * std::sqrt(3.0f), 1e-5f);
    // Beyond the box, and with nothing left to travel.
    ray.origin = Vec3(-1.0f);
    expect_cells(scene, ray, infinity, {});
    ray.origin = Vec3(4.5f);
    expect_cells(scene, ray, 0.0f, {});
    expect_cells(scene, ray, 0.1f, {{4, 4, 4}});
}

TEST(Majorants, EqualNeighboursMakeOneSegment)
{
    GridScene scene = unit_cells();
    scene.media.majorants[0].values.assign(512, 2.0f);
    Ray ray;
    ray.origin = Vec3(-1, 3.2f, 3.7f);
    ray.direction = normalize(Vec3(1, 0.1f, 0.2f));
    const auto segments = segments_of(scene, ray, infinity, spectral());
    ASSERT_EQ(segments.size(), 1u);
}

TEST(Majorants, HomogeneousMediaAreOneSegment)
{
    SpectrumPool pool;
    Media media;
    Medium medium;
    medium.sigma_a = make_constant(0.5f);
    medium.sigma_s = make_constant(1.5f);
    build_majorants(media, medium);
    EXPECT_TRUE(media.majorants.empty());
    MajorantTracker tracker(media, pool, medium, Ray{}, infinity, spectral());
    MajorantSegment segment;
    ASSERT_TRUE(tracker.next_segment(segment));
    EXPECT_EQ(segment.t_min, 0.0f);
    // Endless, but finite: 0 times its length is 0.
    EXPECT_EQ(segment.t_max, std::numeric_limits<float>::max());
    EXPECT_FLOAT_EQ(segment.majorant[0], 2.0f);
    EXPECT_FALSE(tracker.next_segment(segment));
    EXPECT_TRUE(medium.scatters());
    medium.sigma_s = make_constant(0.0f);
    EXPECT_FALSE(medium.scatters());
}

// The optical depth along the ray, by the midpoint rule.
double optical_depth(const GridScene& scene, const Ray& ray, const Wavelengths& wavelengths, int lane)
{
    double t0, t1, sum = 0.0;
    if (!overlap(scene, ray, 1e9, t0, t1)) return 0.0;
    constexpr int n = 20000;
    for (int i = 0; i < n; ++i)
        sum += scene.sigma_t(ray.at(static_cast<float>(t0 + (t1 - t0) * (i + 0.5) / n)), wavelengths)[lane];
    return sum * (t1 - t0) / n;
}

// One path of delta tracking (0 or 1) and of ratio tracking along the ray, by lane 0.
void track(const GridScene& scene, const Ray& ray, const Wavelengths& wavelengths, Numbers& numbers, double& delta,
           double& ratio)
{
    delta = ratio = 1.0;
    MajorantTracker tracker(scene.media, scene.pool, scene.medium, ray, infinity, wavelengths);
    MajorantSegment segment;
    while (tracker.next_segment(segment)) {
        const double majorant = segment.majorant[0];
        if (majorant == 0.0) continue;
        double t = segment.t_min;
        while (true) {
            t -= std::log(1.0 - numbers.next()) / majorant;
            if (t >= segment.t_max) break;
            const double real = scene.sigma_t(ray.at(static_cast<float>(t)), wavelengths)[0] / majorant;
            ratio *= 1.0 - real;
            if (numbers.next() < real) delta = 0.0;
        }
    }
}

TEST(Tracking, TransmittanceIsThatOfTheIntegral)
{
    for (const Medium::Kind kind : {Medium::Kind::uniform_grid, Medium::Kind::rgb_grid}) {
        const GridScene scene(kind);
        Numbers numbers(5);
        for (int r = 0; r < 4; ++r) {
            const Ray ray = scene.random_ray(numbers);
            const Wavelengths wavelengths = r % 2 ? Wavelengths::rgb() : spectral();
            const double expected = std::exp(-optical_depth(scene, ray, wavelengths, 0));
            constexpr int n = 12000;
            double sum[2] = {0, 0}, squares[2] = {0, 0};
            for (int i = 0; i < n; ++i) {
                double value[2];
                track(scene, ray, wavelengths, numbers, value[0], value[1]);
                for (int k = 0; k < 2; ++k) {
                    sum[k] += value[k];
                    squares[k] += value[k] * value[k];
                }
            }
            for (int k = 0; k < 2; ++k) {
                const double mean = sum[k] / n;
                const double deviation = std::sqrt(std::max(squares[k] / n - mean * mean, 1e-6) / n);
                EXPECT_NEAR(mean, expected, 3.3 * deviation) << r << " " << k;
            }
            EXPECT_GT(expected, 0.002);  // else the test says nothing
        }
    }
}

}  // namespace
}  // namespace dapple
