// Sensors as pbrt-v4 defines them (Pharr, Jakob, Humphreys, "Physically Based Rendering" 4th ed., section 5.4.2):
// response_i = mean over lanes of s_i(lambda) L(lambda) / pdf, an estimate of the integral of s_i L [W/(m2 sr)], then a
// matrix to the output colour space. For cie1931 the s_i are x, y, z, so that radiance whose Y is 1 has luminance 1,
// and white balance is a von Kries adaptation in the Bradford space. A camera's matrix is the least-squares fit of its
// responses to the 24 ColorChecker patches under the white balance's daylight to the patches' XYZ under the output
// white.
#include "dapple/film/sensor.h"

#include "dapple/base/error.h"
#include "dapple/spectrum/color_space.h"
#include "dapple/spectrum/spectrum_value.h"
#include "dapple/spectrum/standard_tables.h"

#include <Imath/ImathMatrix.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dapple {

namespace {

using Matrix3d = Imath::M33d;  // m[row][column], applied to columns by times()
using Curves = std::array<std::vector<float>, 3>;
using Triple = std::array<double, 3>;

Matrix3d to_double(const Matrix3& m)
{
    Matrix3d result;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) result[i][j] = m[i][j];
    return result;
}

Matrix3 to_float(const Matrix3d& m)
{
    Matrix3 result;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) result[i][j] = static_cast<float>(m[i][j]);
    return result;
}

Triple times(const Matrix3d& m, const Triple& v)
{
    Triple result{};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) result[i] += m[i][j] * v[j];
    return result;
}

// XYZ with Y = 1 of a chromaticity.
Triple xyz_of_chromaticity(double x, double y) { return {x / y, 1.0, (1.0 - x - y) / y}; }

// The matrix on XYZ that takes one white to another: von Kries in the Bradford cone space (Lam 1985).
Matrix3d bradford_adaptation(const Triple& source_white, const Triple& target_white)
{
    const Matrix3d cones_from_xyz(0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296);
    const Triple source = times(cones_from_xyz, source_white), target = times(cones_from_xyz, target_white);
    Matrix3d gain;
    for (int i = 0; i < 3; ++i) gain[i][i] = target[i] / source[i];
    return cones_from_xyz.inverse(true) * gain * cones_from_xyz;
}

double inner_product(const std::vector<float>& a, const std::vector<float>& b)
{
    double sum = 0.0;
    for (int i = 0; i < spectrum_table_size; ++i) sum += double(a[i]) * b[i];
    return sum;
}

// The response to a patch under a light, relative to the middle curve's response to the light.
Triple patch_response(const std::vector<float>& patch, const std::vector<float>& light, const Curves& curves)
{
    Triple result{};
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < spectrum_table_size; ++i) result[c] += double(curves[c][i]) * patch[i] * light[i];
    const double white = inner_product(light, curves[1]);
    for (double& value : result) value /= white;
    return result;
}

// The 3x3 matrix that takes the camera's responses to XYZ.
Matrix3d fit_camera(const Curves& camera, const std::vector<float>& scene_white, const std::vector<float>& output_white)
{
    const Curves& matching = cie_matching_functions();
    const double scale = inner_product(scene_white, matching[1]) / inner_product(scene_white, camera[1]);
    Matrix3d normal(0.0), mixed(0.0);  // A^T A and B^T A, rows of A: camera, of B: XYZ
    for (const std::vector<float>& patch : swatch_reflectances()) {
        const Triple a = patch_response(patch, scene_white, camera);
        const Triple b = patch_response(patch, output_white, matching);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                normal[i][j] += a[i] * a[j];
                mixed[i][j] += scale * b[i] * a[j];
            }
    }
    return mixed * normal.inverse(true);
}

}  // namespace

Sensor make_sensor(const std::string& name, const std::string& color_space_name, float white_balance,
                   float imaging_ratio)
{
    if (!(imaging_ratio > 0.0f) || !std::isfinite(imaging_ratio))
        throw UserError(fmt::format("the imaging ratio {} (exposure time * ISO / 100) is not positive", imaging_ratio));
    if (!(white_balance >= 0.0f)) throw UserError(fmt::format("the white balance {} K is negative", white_balance));
    const ColorSpace& space = color_space(color_space_name);

    Curves response;
    const bool cie = name == "cie1931";
    for (int c = 0; c < 3; ++c) {
        const std::vector<float>* curve = cie ? &cie_matching_functions()[c] : sensor_curve(name, c);
        if (!curve) throw UserError(fmt::format("unknown sensor '{}'{}", name, did_you_mean(name, sensor_names())));
        response[c] = *curve;
    }
    Matrix3d xyz_from_response;
    if (!cie) {
        const std::vector<float> scene_white = daylight_table(white_balance > 0.0f ? white_balance : 6500.0f);
        xyz_from_response = fit_camera(response, scene_white, space.illuminant);
    } else if (white_balance > 0.0f) {
        const Vec3 source = xyz_of_table(daylight_table(white_balance));
        xyz_from_response = bradford_adaptation({double(source.x) / source.y, 1.0, double(source.z) / source.y},
                                                xyz_of_chromaticity(space.white.x, space.white.y));
    }
    const auto rgb_from_response = to_float(to_double(space.rgb_from_xyz) * xyz_from_response);
    Sensor sensor;
    sensor.imaging_ratio = imaging_ratio;
    for (size_t i = 0; i < spectrum_table_size; ++i)
        sensor.rgb.push_back(multiply(rgb_from_response, Vec3(response[0][i], response[1][i], response[2][i])));
    return sensor;
}

Sensor::LaneColors::LaneColors(const Sensor& sensor, const Wavelengths& wavelengths)
{
    std::fill(std::begin(color_), std::end(color_), Vec3(0.0f));
    if (wavelengths.model == ColorModel::rgb) {
        for (int c = 0; c < 3; ++c) color_[c][c] = sensor.imaging_ratio;
        return;
    }
    for (int i = 0; i < Spectrum::lanes; ++i) {
        if (wavelengths.pdf[i] == 0.0f) continue;
        const int index =
            std::clamp(static_cast<int>(wavelengths.lambda[i] - lambda_min + 0.5f), 0, spectrum_table_size - 1);
        color_[i] =
            sensor.rgb[static_cast<size_t>(index)] * (sensor.imaging_ratio / (Spectrum::lanes * wavelengths.pdf[i]));
    }
}

}  // namespace dapple
