// Frames, angles, hashes and robust ray origins.
#include "dapple/math/frame.h"
#include "dapple/math/hash.h"
#include "dapple/math/ray.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

float uniform(uint64_t seed, uint64_t i) { return 2.0f * to_unit_float(hash_words(seed, i)) - 1.0f; }
Vec3 random_vector(uint64_t seed, uint64_t i)
{
    return {uniform(seed, 3 * i), uniform(seed, 3 * i + 1), uniform(seed, 3 * i + 2)};
}

void expect_orthonormal(const Frame& frame)
{
    EXPECT_NEAR(length(frame.s), 1.0f, 2e-6f);
    EXPECT_NEAR(length(frame.t), 1.0f, 2e-6f);
    EXPECT_NEAR(dot(frame.s, frame.t), 0.0f, 2e-6f);
    EXPECT_NEAR(dot(frame.s, frame.n), 0.0f, 2e-6f);
    EXPECT_NEAR(dot(frame.t, frame.n), 0.0f, 2e-6f);
    EXPECT_NEAR(dot(cross(frame.s, frame.t), frame.n), 1.0f, 4e-6f);
}

TEST(Frame, IsOrthonormalAroundAnyNormal)
{
    std::vector<Vec3> normals = {{0, 0, 1},
                                 {0, 0, -1},
                                 {1, 0, 0},
                                 {0, -1, 0},
                                 {1, 0, -0.0f},
                                 normalize(Vec3(1e-4f, -1e-4f, -1.0f)),
                                 normalize(Vec3(1e-20f, 0, -1.0f))};
    for (uint64_t i = 0; i < 500; ++i) normals.push_back(normalize(random_vector(1, i)));
    for (const Vec3& n : normals) {
        const Frame frame(n);
        expect_orthonormal(frame);
        EXPECT_EQ(frame.n, n);
        const Vec3 v(0.3f, -0.5f, 0.7f);
        const Vec3 back = frame.to_local(frame.to_world(v));
        for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(back[axis], v[axis], 2e-6f);
        EXPECT_NEAR(cos_theta(frame.to_local(n)), 1.0f, 2e-6f);
    }
}

TEST(Frame, FollowsTheTangent)
{
    for (uint64_t i = 0; i < 500; ++i) {
        const Vec3 n = normalize(random_vector(2, i));
        // Every other tangent all but parallel to the normal.
        const Vec3 tangent = i % 2 ? random_vector(3, i) * 10.0f : n + random_vector(3, i) * 1e-4f;
        const Frame frame = Frame::from_normal_tangent(n, tangent);
        expect_orthonormal(frame);
        EXPECT_GT(dot(frame.s, tangent), 0.0f);
        EXPECT_NEAR(dot(frame.t, tangent) / length(tangent), 0.0f, 4e-6f) << i;
    }
    for (const Vec3& useless : {Vec3(0.0f), Vec3(0, 0, 3), Vec3(1e-7f, 0, 1), Vec3(infinity, 0, 0)})
        expect_orthonormal(Frame::from_normal_tangent({0, 0, 1}, useless));
}

TEST(Geometry, AnglesNearZeroAndPi)
{
    for (const double angle : {0.0, 1e-6, 1e-3, 0.5, 1.5707963, 3.0, 3.1405926, 3.14159165}) {
        const Vec3 a(1, 0, 0), b(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0);
        EXPECT_NEAR(angle_between(a, b), angle, 1e-6 * std::max(1.0, angle));
    }
}

TEST(Geometry, FaceForward)
{
    EXPECT_EQ(face_forward({0, 0, 1}, {1, 0, -0.1f}), Vec3(0, 0, -1));
    EXPECT_EQ(face_forward({0, 0, 1}, {1, 0, 0.1f}), Vec3(0, 0, 1));
}

TEST(OffsetRayOrigin, LeavesTheErrorBoxOnTheSideOfTheRay)
{
    for (uint64_t i = 0; i < 20000; ++i) {
        const float size = std::exp(8.0f * uniform(4, i));  // points from 3e-4 to 3000 away
        const Vec3 p = random_vector(5, i) * size;
        const Vec3 n = normalize(i % 10 == 0 ? Vec3(0, 0, 1) : random_vector(6, i));
        const Vec3 error = abs(p) * 4e-7f + Vec3(1e-12f);
        const Vec3 direction = normalize(random_vector(7, i));
        const Vec3 origin = offset_ray_origin(p, error, n, direction);
        // The true surface is a plane through some point of the error box; its farthest corner along n is the worst.
        const double side = dot(direction, n) < 0.0f ? -1.0 : 1.0;
        double along = 0.0, reach = 0.0, moved = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
            const double step = static_cast<double>(origin[axis]) - p[axis];
            along += side * n[axis] * step;
            reach += std::abs(static_cast<double>(n[axis])) * error[axis];
            moved = std::max(moved, std::abs(step));
        }
        ASSERT_GE(along, reach * (1.0 - 1e-6)) << i;
        ASSERT_LE(moved, reach + 3e-7 * size) << i;  // and no farther than it takes
    }
}

TEST(Hash, BitsAreBalancedAndAvalanche)
{
    // Flipping any input bit flips each output bit half of the time: 5 standard deviations of 4096 trials.
    for (int in = 0; in < 64; in += 7) {
        int flips[64] = {};
        for (uint64_t i = 0; i < 4096; ++i) {
            const uint64_t x = hash_words(9, i);
            const uint64_t difference = mix64(x) ^ mix64(x ^ (1ull << in));
            for (int out = 0; out < 64; ++out) flips[out] += (difference >> out) & 1u;
        }
        for (const int count : flips) EXPECT_NEAR(count, 2048, 160);
    }
    EXPECT_NE(hash_words(1, 2), hash_words(2, 1));
    EXPECT_NE(hash_words(1), hash_words(1, 0));
    EXPECT_LT(to_unit_float(~0ull), 1.0f);
}

TEST(NextFloat, IsNextafter)
{
    for (uint64_t i = 0; i < 2000; ++i) {
        const float x = uniform(8, i) * std::exp2(100.0f * uniform(9, i));
        EXPECT_EQ(next_float(x, true), std::nextafter(x, infinity));
        EXPECT_EQ(next_float(x, false), std::nextafter(x, -infinity));
    }
    for (const float x : {0.0f, -0.0f, 0x1p-149f, -0x1p-149f, 1.0f, -1.0f, 0x1p-126f}) {
        EXPECT_EQ(next_float(x, true), std::nextafter(x, infinity));
        EXPECT_EQ(next_float(x, false), std::nextafter(x, -infinity));
    }
}

}  // namespace
}  // namespace dapple
