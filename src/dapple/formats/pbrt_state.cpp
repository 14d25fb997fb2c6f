// Transforms follow pbrt-v4: left-handed, each directive multiplies the current matrix from the right.
#include "dapple/formats/pbrt_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dapple {
namespace {

using Vector3d = std::array<double, 3>;

Vector3d cross(const Vector3d& a, const Vector3d& b)
{
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// False when the vector has no direction.
bool normalize(Vector3d& v)
{
    const double length = std::hypot(v[0], v[1], v[2]);
    if (!(length > 0.0) || !std::isfinite(length)) return false;
    for (double& x : v) x /= length;
    return true;
}

template <size_t N>
std::array<double, N> read_array(PbrtLexer& lexer, std::string_view directive)
{
    std::array<double, N> values;
    for (double& value : values) value = lexer.expect_number(fmt::format("{} numbers after {}", N, directive));
    return values;
}

// Files hold matrices column by column.
Matrix4 read_matrix(PbrtLexer& lexer, std::string_view directive)
{
    lexer.expect(PbrtToken::Kind::open, directive);
    const auto values = read_array<16>(lexer, directive);
    lexer.expect(PbrtToken::Kind::close, directive);
    Matrix4 matrix;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) matrix.m[row][column] = values[column * 4 + row];
    return matrix;
}

// Camera from world: the camera at `eye` looks along +z at `look`, +y is up, +x to the right.
Matrix4 look_at(const std::array<double, 9>& v, const SourceLocation& where)
{
    Vector3d forward{v[3] - v[0], v[4] - v[1], v[5] - v[2]};
    if (!normalize(forward)) throw UserError(where, "LookAt: the eye and the point looked at are the same");
    Vector3d up{v[6], v[7], v[8]};
    if (!normalize(up)) throw UserError(where, "LookAt: the up vector has no direction");
    Vector3d right = cross(up, forward);
    constexpr double parallel = 1e-12;  // sine of the angle; rounding alone makes about 1e-16
    if (std::hypot(right[0], right[1], right[2]) < parallel || !normalize(right))
        throw UserError(where, "LookAt: the up vector points along the line of sight");
    const Vector3d true_up = cross(forward, right);

    Matrix4 world_from_camera;
    for (int i = 0; i < 3; ++i) {
        world_from_camera.m[i][0] = right[i];
        world_from_camera.m[i][1] = true_up[i];
        world_from_camera.m[i][2] = forward[i];
        world_from_camera.m[i][3] = v[i];
    }
    return inverse_or_throw(world_from_camera, where, "LookAt");
}

Matrix4 scale(PbrtLexer& lexer, const SourceLocation& where)
{
    const auto factors = read_array<3>(lexer, "Scale");
    Matrix4 matrix;
    for (int i = 0; i < 3; ++i) {
        if (factors[i] == 0.0) throw UserError(where, "Scale by 0 makes the transform singular");
        matrix.m[i][i] = factors[i];
    }
    return matrix;
}

Matrix4 translate(PbrtLexer& lexer)
{
    const auto delta = read_array<3>(lexer, "Translate");
    Matrix4 matrix;
    for (int i = 0; i < 3; ++i) matrix.m[i][3] = delta[i];
    return matrix;
}

Matrix4 rotate(PbrtLexer& lexer, const SourceLocation& where)
{
    const auto v = read_array<4>(lexer, "Rotate");
    Vector3d axis{v[1], v[2], v[3]};
    if (!normalize(axis)) throw UserError(where, "Rotate: the axis has no direction");
    return rotation(static_cast<float>(v[0]),
                    Vec3(static_cast<float>(axis[0]), static_cast<float>(axis[1]), static_cast<float>(axis[2])));
}

}  // namespace

Matrix4 inverse_or_throw(const Matrix4& matrix, const SourceLocation& where, std::string_view what)
{
    const auto finite = [](const Matrix4& m) {
        return std::all_of(m.m.begin(), m.m.end(), [](auto& row) {
            return std::all_of(row.begin(), row.end(), [](double x) { return std::isfinite(x); });
        });
    };
    Matrix4 inverse;
    bool good = finite(matrix) && invert(matrix, inverse) && finite(inverse);
    if (good) {
        // A singular matrix that rounding makes invertible shows in the product of its linear part.
        constexpr double tolerance = 1e-4;
        Matrix4 linear = matrix;
        for (int i = 0; i < 3; ++i) linear.m[i][3] = 0.0;
        Matrix4 linear_inverse;
        good = invert(linear, linear_inverse);
        const Matrix4 product = linear * linear_inverse;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) good = good && std::fabs(product.m[i][j] - (i == j)) < tolerance;
    }
    if (!good) throw UserError(where, fmt::format("{}: the matrix is singular", what));
    return inverse;
}

bool is_transform_directive(std::string_view word)
{
    return word == "Identity" || word == "Translate" || word == "Scale" || word == "Rotate" || word == "LookAt" ||
           word == "Transform" || word == "ConcatTransform";
}

void read_transform_directive(std::string_view word, const char* at, PbrtLexer& lexer, GraphicsState& state)
{
    const SourceLocation where = lexer.locate(at);
    Matrix4 matrix;
    if (word == "Translate") matrix = translate(lexer);
    if (word == "Scale") matrix = scale(lexer, where);
    if (word == "Rotate") matrix = rotate(lexer, where);
    if (word == "LookAt") matrix = look_at(read_array<9>(lexer, word), where);
    if (word == "Transform" || word == "ConcatTransform") {
        matrix = read_matrix(lexer, word);
        inverse_or_throw(matrix, where, word);
    }
    const bool replace = word == "Identity" || word == "Transform";
    if (state.start_active) state.transform.start = replace ? matrix : state.transform.start * matrix;
    if (state.end_active) state.transform.end = replace ? matrix : state.transform.end * matrix;
}

scene::MovingMatrix current_transform(const GraphicsState& state, const SourceLocation& where)
{
    inverse_or_throw(state.transform.start, where, "the current transform");
    if (state.transform.end != state.transform.start)
        inverse_or_throw(state.transform.end, where, "the current transform at the end time");
    return {state.transform.start, state.transform.end, state.start_time, state.end_time};
}

}  // namespace dapple
