// Linear RGB colour spaces, given by the chromaticities of their primaries and by the spectrum of their white.
#pragma once

#include "dapple/math/vec.h"

#include <array>
#include <string_view>
#include <vector>

namespace dapple {

using Matrix3 = std::array<std::array<float, 3>, 3>;

// matrix * v.
inline Vec3 multiply(const Matrix3& m, const Vec3& v)
{
    return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
            m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}

struct ColorSpace {
    std::string_view name;         // as pbrt names it
    Vec2 red, green, blue, white;  // chromaticities (x, y)
    Matrix3 xyz_from_rgb;          // RGB (1, 1, 1) is white with Y = 1
    Matrix3 rgb_from_xyz;
    std::vector<float> illuminant;  // spectrum of the white, scaled so that its Y is cie_y_integral
};

// The colour space "srgb", "dci-p3" (P3 primaries with D65, as displays have it), "rec2020" or "aces2065-1"; case does
// not matter. Throws UserError for another name. The reference stays valid.
const ColorSpace& color_space(std::string_view name);
const ColorSpace& srgb();
std::vector<std::string_view> color_space_names();

// Linear sRGB of a linear colour of another space. Unclamped: colours outside of sRGB have negative components.
Vec3 to_srgb(const ColorSpace& space, const Vec3& rgb);

}  // namespace dapple
