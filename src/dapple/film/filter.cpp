// Filter tables. Formulas: gaussian less its value at the radius (per axis) and windowed sinc as in Pharr, Jakob,
// Humphreys, "Physically Based Rendering" 4th ed., section 8.8; Mitchell and Netravali 1988, equation 8, stretched so
// that its support is the radius.
#include "dapple/film/filter.h"

#include "dapple/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dapple {

namespace {

double sinc(double x)
{
    const double t = static_cast<double>(pi) * x;
    return std::fabs(t) < 1e-5 ? 1.0 - t * t / 6.0 : std::sin(t) / t;
}

double mitchell(double x, double b, double c)
{
    if (x <= 1.0) return ((12 - 9 * b - 6 * c) * x * x * x + (-18 + 12 * b + 6 * c) * x * x + (6 - 2 * b)) / 6.0;
    if (x <= 2.0)
        return ((-b - 6 * c) * x * x * x + (6 * b + 30 * c) * x * x + (-12 * b - 48 * c) * x + (8 * b + 24 * c)) / 6.0;
    return 0.0;
}

// One axis' factor at x >= 0, in any scale.
double formula(const FilterShape& shape, double radius, double x)
{
    switch (shape.kind) {
        case FilterShape::Kind::box: return 1.0;
        case FilterShape::Kind::triangle: return std::max(0.0, radius - x);
        case FilterShape::Kind::gaussian: {
            const double scale = -0.5 / (double(shape.sigma) * shape.sigma);
            return std::max(0.0, std::exp(scale * x * x) - std::exp(scale * radius * radius));
        }
        case FilterShape::Kind::mitchell: return mitchell(2.0 * x / radius, shape.b, shape.c);
        case FilterShape::Kind::sinc: return sinc(x) * sinc(x / shape.tau);
    }
    return 0.0;
}

// The integral of |linear function from a to b| over the unit interval.
double absolute_area(double a, double b)
{
    if (a * b >= 0.0) return 0.5 * (std::fabs(a) + std::fabs(b));
    return 0.5 * (a * a + b * b) / (std::fabs(a) + std::fabs(b));
}

// A position in [0, 1) with density proportional to the linear function from a to b, both >= 0, not both 0.
float sample_linear(float u, float a, float b)
{
    return std::min(u * (a + b) / (a + std::sqrt(std::max(0.0f, lerp(u, a * a, b * b)))), one_minus_epsilon);
}

}  // namespace

Vec2 FilterShape::default_radius(Kind kind)
{
    switch (kind) {
        case Kind::box: return Vec2(0.5f);
        case Kind::triangle: return Vec2(2.0f);
        case Kind::gaussian: return Vec2(1.5f);
        case Kind::mitchell: return Vec2(2.0f);
        case Kind::sinc: return Vec2(4.0f);
    }
    return Vec2(1.5f);
}

Filter::Filter(const FilterShape& shape) : shape_(shape)
{
    for (const float radius : {shape.radius.x, shape.radius.y})
        if (!(radius > 0.0f && radius <= max_radius))
            throw UserError(
                fmt::format("the pixel filter's radius {} is not above 0 and at most {} pixels", radius, max_radius));
    if (shape.kind == Kind::gaussian && !(shape.sigma > 0.0f))
        throw UserError(fmt::format("the pixel filter's sigma {} is not positive", shape.sigma));
    if (shape.kind == Kind::sinc && !(shape.tau > 0.0f))
        throw UserError(fmt::format("the pixel filter's tau {} is not positive", shape.tau));
    x_.build(shape, shape.radius.x);
    y_.build(shape, shape.radius.y);
}

void Filter::Axis::build(const FilterShape& shape, float axis_radius)
{
    radius = axis_radius;
    to_cell = cells / radius;
    const double cell_width = double(radius) / cells;
    std::array<double, cells + 1> f;
    for (int i = 0; i <= cells; ++i) f[i] = formula(shape, radius, i * cell_width);

    double integral = 0.0, absolute = 0.0;
    std::array<double, cells + 1> running{};
    for (int i = 0; i < cells; ++i) {
        integral += 0.5 * (f[i] + f[i + 1]);
        absolute += absolute_area(f[i], f[i + 1]);
        running[i + 1] = absolute;
    }
    if (!(integral > 0.0)) throw UserError("the pixel filter's integral is not positive");

    weight = static_cast<float>(absolute / integral);
    const double to_unit = 1.0 / (2.0 * integral * cell_width);  // both halves of the axis
    for (int i = 0; i <= cells; ++i) {
        value[i] = static_cast<float>(f[i] * to_unit);
        cdf[i] = static_cast<float>(running[i] / absolute);
    }
    int cell = 0;
    for (int k = 0; k < cells; ++k) {
        while (cell + 1 < cells && cdf[cell + 1] <= static_cast<float>(k) / cells) ++cell;
        guide[k] = static_cast<uint8_t>(cell);
    }
}

float Filter::Axis::sample(float u, float& sample_weight) const
{
    // The two halves of the axis share the inverse; monotone in u, which keeps stratification.
    const float signed_u = 2.0f * u - 1.0f;
    const float t = std::min(std::fabs(signed_u), one_minus_epsilon);
    // The last cell that begins at or below t: the guide leaves a step or two (Chen and Asau 1974).
    int cell = guide[static_cast<int>(t * cells)];
    while (cell + 1 < cells && cdf[cell + 1] <= t) ++cell;
    const float a = value[cell], b = value[cell + 1];
    const float width = cdf[cell + 1] - cdf[cell];
    const float v = width > 0.0f ? std::clamp((t - cdf[cell]) / width, 0.0f, one_minus_epsilon) : 0.5f;

    float position, sign;
    if (a * b >= 0.0f) {
        sign = a + b < 0.0f ? -1.0f : 1.0f;
        position = a == b ? v : sample_linear(v, std::fabs(a), std::fabs(b));
    } else {  // the sign changes inside the cell: two triangles that meet at `root`
        const float root = a / (a - b);
        const float first = a * a / (a * a + b * b);  // the first triangle's share
        const bool in_first = v < first;
        position = in_first ? root * (1.0f - std::sqrt(1.0f - v / first))
                            : root + (1.0f - root) * std::sqrt((v - first) / (1.0f - first));
        sign = (in_first ? a : b) < 0.0f ? -1.0f : 1.0f;
    }
    sample_weight *= sign * weight;
    const float x = std::min((static_cast<float>(cell) + position) / to_cell, radius);
    return signed_u < 0.0f ? -x : x;
}

Filter::Sample Filter::sample(const Vec2& u) const
{
    Sample result{Vec2(0.0f), 1.0f};
    result.offset = {x_.sample(u.x, result.weight), y_.sample(u.y, result.weight)};
    return result;
}

}  // namespace dapple
