#include "dapple/math/transform.h"

#include "dapple/base/assert.h"

#include <Imath/ImathMatrix.h>
#include <Imath/ImathMatrixAlgo.h>
#include <Imath/ImathQuat.h>

#include <cmath>
#include <utility>

namespace dapple {
namespace {

// Polar decomposition by averaging with the inverse transpose (Shoemake and Duff 1992, section 3).
AnimatedTransform::Parts decompose(const Matrix4& matrix)
{
    AnimatedTransform::Parts parts;
    parts.translation = Vec3(static_cast<float>(matrix.m[0][3]), static_cast<float>(matrix.m[1][3]),
                             static_cast<float>(matrix.m[2][3]));
    Matrix4 linear = matrix;
    for (int i = 0; i < 3; ++i) linear.m[i][3] = linear.m[3][i] = 0.0;

    Matrix4 rotation = linear;
    for (int iteration = 0; iteration < 100; ++iteration) {
        Matrix4 inverse;
        if (!invert(transpose(rotation), inverse)) break;
        double change = 0.0;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                const double next = 0.5 * (rotation.m[i][j] + inverse.m[i][j]);
                change = std::max(change, std::abs(next - rotation.m[i][j]));
                rotation.m[i][j] = next;
            }
        if (change < 1e-12) break;
    }
    if (determinant3(rotation) < 0.0)  // a reflection belongs to the scale: a quaternion cannot hold it
        for (auto& row : rotation.m)
            for (int j = 0; j < 3; ++j) row[j] = -row[j];

    Matrix4 rotation_inverse = transpose(rotation);
    parts.scale = rotation_inverse * linear;

    // Imath multiplies row vectors, hence the transpose.
    Imath::M44d row_matrix;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) row_matrix[i][j] = rotation.m[j][i];
    const Imath::Quatd q = Imath::extractQuat(row_matrix);
    parts.rotation = {static_cast<float>(q.v.x), static_cast<float>(q.v.y), static_cast<float>(q.v.z),
                      static_cast<float>(q.r)};
    return parts;
}

Matrix4 quaternion_matrix(const Imath::Quatd& q)
{
    const Imath::M33d rows = q.normalized().toMatrix33();
    Matrix4 matrix;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) matrix.m[i][j] = rows[j][i];
    return matrix;
}

Imath::Quatd to_quat(const std::array<float, 4>& q) { return {q[3], Imath::V3d(q[0], q[1], q[2])}; }

}  // namespace

Matrix4 operator*(const Matrix4& a, const Matrix4& b)
{
    Matrix4 result;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            double sum = 0.0;
            for (int k = 0; k < 4; ++k) sum += a.m[i][k] * b.m[k][j];
            result.m[i][j] = sum;
        }
    return result;
}

bool invert(const Matrix4& matrix, Matrix4& out)
{
    auto a = matrix.m;
    auto inverse = Matrix4().m;
    for (int column = 0; column < 4; ++column) {
        int pivot = column;
        for (int row = column + 1; row < 4; ++row)
            if (std::abs(a[row][column]) > std::abs(a[pivot][column])) pivot = row;
        if (!(std::abs(a[pivot][column]) > 0.0) || !std::isfinite(a[pivot][column])) return false;
        std::swap(a[pivot], a[column]);
        std::swap(inverse[pivot], inverse[column]);
        const double scale = 1.0 / a[column][column];
        for (int j = 0; j < 4; ++j) {
            a[column][j] *= scale;
            inverse[column][j] *= scale;
        }
        for (int row = 0; row < 4; ++row) {
            if (row == column) continue;
            const double factor = a[row][column];
            for (int j = 0; j < 4; ++j) {
                a[row][j] -= factor * a[column][j];
                inverse[row][j] -= factor * inverse[column][j];
            }
        }
    }
    out.m = inverse;
    return true;
}

Matrix4 transpose(const Matrix4& matrix)
{
    Matrix4 result;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) result.m[i][j] = matrix.m[j][i];
    return result;
}

double determinant3(const Matrix4& matrix)
{
    const auto& m = matrix.m;
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

Matrix4 translation(const Vec3& delta)
{
    Matrix4 result;
    for (int i = 0; i < 3; ++i) result.m[i][3] = delta[i];
    return result;
}

Matrix4 scaling(const Vec3& factors)
{
    Matrix4 result;
    for (int i = 0; i < 3; ++i) result.m[i][i] = factors[i];
    return result;
}

Matrix4 rotation(float degrees_angle, const Vec3& axis)
{
    const double angle = degrees_angle * (3.14159265358979323846 / 180.0);
    Imath::V3d a(axis);
    a.normalize();
    return quaternion_matrix(Imath::Quatd(std::cos(angle / 2.0), a * std::sin(angle / 2.0)));
}

Transform::Transform(const Matrix4& matrix) : m_(matrix)
{
    [[maybe_unused]] const bool invertible = invert(matrix, inverse_);
    DAPPLE_ASSERT(invertible);
}

Vec3 Transform::normal(const Vec3& n) const
{
    const auto& m = inverse_.m;
    return {static_cast<float>(m[0][0] * n.x + m[1][0] * n.y + m[2][0] * n.z),
            static_cast<float>(m[0][1] * n.x + m[1][1] * n.y + m[2][1] * n.z),
            static_cast<float>(m[0][2] * n.x + m[1][2] * n.y + m[2][2] * n.z)};
}

Vec3 Transform::apply_point(const Matrix4& matrix, const Vec3& p)
{
    const auto& m = matrix.m;
    const double x = m[0][0] * p.x + m[0][1] * p.y + m[0][2] * p.z + m[0][3];
    const double y = m[1][0] * p.x + m[1][1] * p.y + m[1][2] * p.z + m[1][3];
    const double z = m[2][0] * p.x + m[2][1] * p.y + m[2][2] * p.z + m[2][3];
    const double w = m[3][0] * p.x + m[3][1] * p.y + m[3][2] * p.z + m[3][3];
    const double scale = w == 1.0 ? 1.0 : 1.0 / w;
    return {static_cast<float>(x * scale), static_cast<float>(y * scale), static_cast<float>(z * scale)};
}

Vec3 Transform::apply_vector(const Matrix4& matrix, const Vec3& v)
{
    const auto& m = matrix.m;
    return {static_cast<float>(m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z),
            static_cast<float>(m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z),
            static_cast<float>(m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z)};
}

AnimatedTransform::AnimatedTransform(const Transform& start, const Transform& end)
    : start_(start), end_(end), moves_(!(start.matrix() == end.matrix()))
{
    if (!moves_) return;
    parts_ = {decompose(start.matrix()), decompose(end.matrix())};
    // The shorter way round.
    const auto& a = parts_[0].rotation;
    auto& b = parts_[1].rotation;
    if (a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] < 0.0f)
        for (float& component : b) component = -component;
}

Transform AnimatedTransform::at(float time) const
{
    if (!moves_ || time <= 0.0f) return start_;
    if (time >= 1.0f) return end_;
    const Imath::Quatd q = Imath::slerp(to_quat(parts_[0].rotation), to_quat(parts_[1].rotation), double(time));
    Matrix4 scale;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            scale.m[i][j] = (1.0 - time) * parts_[0].scale.m[i][j] + time * parts_[1].scale.m[i][j];
    return Transform(translation(lerp(time, parts_[0].translation, parts_[1].translation)) * quaternion_matrix(q) *
                     scale);
}

}  // namespace dapple
