// Affine and projective transforms. Column vectors: point' = m * point, m[row][column], as in pbrt's text.
#pragma once

#include "dapple/math/vec.h"

#include <array>

namespace dapple {

struct Matrix4 {
    std::array<std::array<double, 4>, 4> m{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};

    friend bool operator==(const Matrix4&, const Matrix4&) = default;
};

Matrix4 operator*(const Matrix4& a, const Matrix4& b);
// Inverse in double precision; returns false (and leaves `out`) when the matrix is singular.
bool invert(const Matrix4& matrix, Matrix4& out);
Matrix4 transpose(const Matrix4& matrix);
double determinant3(const Matrix4& matrix);

Matrix4 translation(const Vec3& delta);
Matrix4 scaling(const Vec3& factors);
// Rotation by `degrees` around `axis` (any length), right-handed.
Matrix4 rotation(float degrees, const Vec3& axis);

// A matrix and its inverse.
class Transform {
public:
    Transform() = default;
    // The matrix must be invertible (asserted).
    explicit Transform(const Matrix4& matrix);
    Transform(const Matrix4& matrix, const Matrix4& inverse) : m_(matrix), inverse_(inverse) {}

    Vec3 point(const Vec3& p) const { return apply_point(m_, p); }
    Vec3 vector(const Vec3& v) const { return apply_vector(m_, v); }
    // Transforms a normal (by the inverse transpose); not normalised.
    Vec3 normal(const Vec3& n) const;
    Transform inverse() const { return Transform(inverse_, m_); }
    bool swaps_handedness() const { return determinant3(m_) < 0.0; }
    const Matrix4& matrix() const { return m_; }
    const Matrix4& inverse_matrix() const { return inverse_; }

    friend Transform operator*(const Transform& a, const Transform& b)
    {
        return Transform(a.m_ * b.m_, b.inverse_ * a.inverse_);
    }

    static Vec3 apply_point(const Matrix4& matrix, const Vec3& p);
    static Vec3 apply_vector(const Matrix4& matrix, const Vec3& v);

private:
    Matrix4 m_;
    Matrix4 inverse_;
};

// A transform that moves from `start` (time 0) to `end` (time 1): translation and scale linear, rotation by slerp
// (Shoemake and Duff 1992, "Matrix animation and polar decomposition").
class AnimatedTransform {
public:
    AnimatedTransform() = default;
    explicit AnimatedTransform(const Transform& constant) : start_(constant), end_(constant) {}
    AnimatedTransform(const Transform& start, const Transform& end);

    bool moves() const { return moves_; }
    Transform at(float time) const;
    // function(the transform at a time), which is not copied where it stands still.
    template <class Function>
    auto with(float time, const Function& function) const
    {
        return moves_ ? function(at(time)) : function(start_);
    }
    const Transform& start() const { return start_; }
    const Transform& end() const { return end_; }

    // Translation, rotation quaternion (x, y, z, w) and scale-shear matrix of one key, as used by the interpolation.
    struct Parts {
        Vec3 translation{0, 0, 0};
        std::array<float, 4> rotation{0, 0, 0, 1};
        Matrix4 scale;
    };
    const Parts& start_parts() const { return parts_[0]; }
    const Parts& end_parts() const { return parts_[1]; }

private:
    Transform start_;
    Transform end_;
    bool moves_ = false;
    std::array<Parts, 2> parts_;
};

}  // namespace dapple
