// RGB colour spaces (see color_space.h): ITU-R BT.709, SMPTE EG 432-1 (P3 with D65), ITU-R BT.2020, SMPTE ST 2065-1.
// The white's chromaticity is that of its spectrum under the CIE 1931 observer, so that a white reflectance under the
// white light is exactly RGB (1, 1, 1).
#include "dapple/spectrum/color_space.h"

#include "dapple/base/error.h"
#include "dapple/spectrum/standard_tables.h"

#include <Imath/ImathMatrix.h>

#include <algorithm>
#include <cctype>
#include <string>

namespace dapple {
namespace {

Imath::V3d xyz_of_chromaticity(const Vec2& xy)
{
    return {static_cast<double>(xy.x) / xy.y, 1.0, (1.0 - xy.x - xy.y) / xy.y};
}

// Imath multiplies row vectors, hence the transposition.
Matrix3 to_matrix3(const Imath::M33d& row_matrix)
{
    Matrix3 result{};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) result[i][j] = static_cast<float>(row_matrix[j][i]);
    return result;
}

ColorSpace make_space(std::string_view name, const Vec2& red, const Vec2& green, const Vec2& blue,
                      std::string_view illuminant)
{
    ColorSpace space;
    space.name = name;
    space.red = red;
    space.green = green;
    space.blue = blue;
    space.illuminant = *illuminant_table(illuminant);
    const Imath::V3d white = Imath::V3d(xyz_of_table(space.illuminant)) / static_cast<double>(cie_y_integral);
    const double sum = white.x + white.y + white.z;
    space.white = Vec2(static_cast<float>(white.x / sum), static_cast<float>(white.y / sum));

    Imath::M33d rows;
    const Vec2 primaries[3] = {red, green, blue};
    for (int i = 0; i < 3; ++i) {
        const Imath::V3d xyz = xyz_of_chromaticity(primaries[i]);
        for (int j = 0; j < 3; ++j) rows[i][j] = xyz[j];
    }
    const Imath::V3d scale = white * rows.inverse();
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) rows[i][j] *= scale[i];
    space.xyz_from_rgb = to_matrix3(rows);
    space.rgb_from_xyz = to_matrix3(rows.inverse());
    return space;
}

const std::array<ColorSpace, 4>& spaces()
{
    static const std::array<ColorSpace, 4> all = {
        make_space("srgb", {0.64f, 0.33f}, {0.30f, 0.60f}, {0.15f, 0.06f}, "stdillum-D65"),
        make_space("dci-p3", {0.680f, 0.320f}, {0.265f, 0.690f}, {0.150f, 0.060f}, "stdillum-D65"),
        make_space("rec2020", {0.708f, 0.292f}, {0.170f, 0.797f}, {0.131f, 0.046f}, "stdillum-D65"),
        make_space("aces2065-1", {0.7347f, 0.2653f}, {0.0f, 1.0f}, {0.0001f, -0.0770f}, "illum-acesD60"),
    };
    return all;
}

}  // namespace

const ColorSpace& color_space(std::string_view name)
{
    std::string lower(name);
    std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
    for (const ColorSpace& space : spaces())
        if (space.name == lower) return space;
    throw UserError("unknown colour space '" + std::string(name) + "'" + did_you_mean(lower, color_space_names()));
}

const ColorSpace& srgb() { return spaces()[0]; }

std::vector<std::string_view> color_space_names()
{
    std::vector<std::string_view> names;
    for (const ColorSpace& space : spaces()) names.push_back(space.name);
    return names;
}

Vec3 to_srgb(const ColorSpace& space, const Vec3& rgb)
{
    if (space.name == srgb().name) return rgb;
    return multiply(srgb().rgb_from_xyz, multiply(space.xyz_from_rgb, rgb));
}

}  // namespace dapple
