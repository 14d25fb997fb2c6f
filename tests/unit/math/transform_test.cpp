// Transforms and animated transforms: identities, and motions whose positions are known.
#include "dapple/math/transform.h"

#include "dapple/math/hash.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

float uniform(uint64_t seed, uint64_t i) { return 2.0f * to_unit_float(hash_words(seed, i)) - 1.0f; }
Vec3 random_vector(uint64_t seed, uint64_t i)
{
    return {uniform(seed, 3 * i), uniform(seed, 3 * i + 1), uniform(seed, 3 * i + 2)};
}

Matrix4 random_affine(uint64_t i)
{
    Matrix4 matrix = translation(random_vector(1, i) * 5.0f) * rotation(180.0f * uniform(2, i), random_vector(3, i)) *
                     scaling(Vec3(1.5f) + random_vector(4, i));
    matrix.m[0][1] += 0.3 * uniform(5, i);  // shear
    return matrix;
}

void expect_near(const Vec3& a, const Vec3& b, float tolerance)
{
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(a[axis], b[axis], tolerance);
}

void expect_near(const Matrix4& a, const Matrix4& b, double tolerance)
{
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) EXPECT_NEAR(a.m[i][j], b.m[i][j], tolerance) << i << " " << j;
}

TEST(Matrix, InverseTimesMatrixIsIdentity)
{
    for (uint64_t i = 0; i < 100; ++i) {
        const Matrix4 matrix = random_affine(i);
        Matrix4 inverse;
        ASSERT_TRUE(invert(matrix, inverse));
        expect_near(matrix * inverse, Matrix4(), 1e-12);
        expect_near(inverse * matrix, Matrix4(), 1e-12);
    }
}

TEST(Matrix, SingularMatricesAreRefused)
{
    Matrix4 flat = scaling({1.0f, 0.0f, 2.0f}), out = translation({7, 8, 9});
    const Matrix4 before = out;
    EXPECT_FALSE(invert(flat, out));
    EXPECT_EQ(out, before);
    flat.m[1][1] = std::nan("");
    EXPECT_FALSE(invert(flat, out));
}

TEST(Matrix, PivotsWhereTheDiagonalIsZero)
{
    Matrix4 swap;
    swap.m = {{{0, 1, 0, 0}, {1, 0, 0, 0}, {0, 0, 0, 1}, {0, 0, 1, 0}}};
    Matrix4 inverse;
    ASSERT_TRUE(invert(swap, inverse));
    expect_near(swap * inverse, Matrix4(), 0.0);
}

TEST(Matrix, RotationIsRightHanded)
{
    expect_near(Transform(rotation(90.0f, {0, 0, 5})).vector({1, 0, 0}), {0, 1, 0}, 1e-7f);
    expect_near(Transform(rotation(90.0f, {1, 0, 0})).vector({0, 1, 0}), {0, 0, 1}, 1e-7f);
    expect_near(Transform(rotation(120.0f, {1, 1, 1})).vector({1, 0, 0}), {0, 1, 0}, 1e-7f);
    EXPECT_NEAR(determinant3(rotation(77.0f, {1, -2, 3})), 1.0, 1e-12);
}

TEST(Transform, PointsVectorsAndNormals)
{
    for (uint64_t i = 0; i < 100; ++i) {
        const Transform transform(random_affine(i));
        const Vec3 p = random_vector(6, i), a = random_vector(7, i), b = random_vector(8, i);
        expect_near(transform.inverse().point(transform.point(p)), p, 1e-5f);
        expect_near(transform.inverse().vector(transform.vector(a)), a, 1e-5f);
        expect_near(transform.point(p + a) - transform.point(p), transform.vector(a), 1e-5f);
        // A normal stays at right angles to its surface.
        const Vec3 n = transform.normal(cross(a, b));
        EXPECT_NEAR(dot(n, transform.vector(a)), 0.0f, 1e-5f);
        EXPECT_NEAR(dot(n, transform.vector(b)), 0.0f, 1e-5f);
        // Composition applies the right factor first.
        const Transform other(random_affine(i + 500));
        expect_near((transform * other).point(p), transform.point(other.point(p)), 3e-5f);
        expect_near((transform * other).inverse().point(p), other.inverse().point(transform.inverse().point(p)), 3e-4f);
    }
}

TEST(Transform, Handedness)
{
    EXPECT_FALSE(Transform(rotation(30.0f, {1, 2, 3})).swaps_handedness());
    EXPECT_TRUE(Transform(scaling({1, -1, 1})).swaps_handedness());
    EXPECT_FALSE(Transform(scaling({-1, -1, 1})).swaps_handedness());
}

TEST(Transform, ProjectiveDivision)
{
    Matrix4 perspective;
    perspective.m = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, -1}, {0, 0, 1, 0}}};
    expect_near(Transform::apply_point(perspective, {2, 4, 2}), {1, 2, 0.5f}, 1e-7f);
    Matrix4 inverse;
    ASSERT_TRUE(invert(perspective, inverse));
    expect_near(Transform::apply_point(inverse, {1, 2, 0.5f}), {2, 4, 2}, 1e-6f);
}

TEST(AnimatedTransform, ConstantDoesNotMove)
{
    const Transform transform(random_affine(3));
    EXPECT_FALSE(AnimatedTransform(transform).moves());
    EXPECT_FALSE(AnimatedTransform(transform, transform).moves());
    EXPECT_EQ(AnimatedTransform(transform, transform).at(0.5f).matrix(), transform.matrix());
}

TEST(AnimatedTransform, KeysAndContinuity)
{
    for (uint64_t i = 0; i < 60; ++i) {
        Matrix4 a = random_affine(i), b = random_affine(i + 100);
        if (i % 3 == 0) {  // both mirrored: still a motion
            a = a * scaling({1, 1, -1});
            b = b * scaling({1, 1, -1});
        }
        const AnimatedTransform motion{Transform(a), Transform(b)};
        ASSERT_TRUE(motion.moves());
        EXPECT_EQ(motion.at(0.0f).matrix(), a);
        EXPECT_EQ(motion.at(1.0f).matrix(), b);
        // What the decomposition puts together again must be the key itself: the limit at both ends.
        expect_near(motion.at(1e-6f).matrix(), a, 1e-4);
        expect_near(motion.at(1.0f - 1e-6f).matrix(), b, 1e-4);
    }
}

TEST(AnimatedTransform, TranslationIsLinear)
{
    const AnimatedTransform motion{Transform(translation({1, 2, 3})), Transform(translation({5, 0, 3}))};
    expect_near(motion.at(0.25f).point(Vec3(0.0f)), {2, 1.5f, 3}, 1e-6f);
}

TEST(AnimatedTransform, ScaleIsLinear)
{
    const AnimatedTransform motion{Transform(scaling(Vec3(1.0f))), Transform(scaling({3, 1, 2}))};
    expect_near(motion.at(0.5f).vector(Vec3(1.0f)), {2, 1, 1.5f}, 1e-6f);
}

TEST(AnimatedTransform, RotationHasConstantSpeedTheShortWay)
{
    for (const float degrees_end : {120.0f, -120.0f, 179.0f}) {
        const Vec3 axis(0.3f, -1.0f, 0.5f);
        const AnimatedTransform motion{Transform(), Transform(rotation(degrees_end, axis))};
        for (const float t : {0.1f, 0.25f, 0.5f, 0.9f})
            expect_near(motion.at(t).matrix(), rotation(degrees_end * t, axis), 2e-6);
    }
    // 270 degrees one way are 90 the other.
    const AnimatedTransform motion{Transform(), Transform(rotation(270.0f, {0, 0, 1}))};
    expect_near(motion.at(0.5f).vector({1, 0, 0}), {std::sqrt(0.5f), -std::sqrt(0.5f), 0}, 1e-6f);
}

TEST(AnimatedTransform, InverseFollowsTheMotion)
{
    const AnimatedTransform motion{Transform(random_affine(11)), Transform(random_affine(12))};
    for (const float t : {0.2f, 0.5f, 0.8f}) {
        const Transform at = motion.at(t);
        expect_near(at.matrix() * at.inverse_matrix(), Matrix4(), 1e-10);
    }
}

}  // namespace
}  // namespace dapple
