// Media of pbrt-v4.
#include "dapple/formats/pbrt_builder.h"
#include "dapple/scene/names.h"

#include <fmt/format.h>

#include <limits>

namespace dapple {
namespace {

constexpr std::string_view medium_types[] = {"homogeneous", "uniformgrid", "rgbgrid", "nanovdb", "cloud"};

scene::SpectrumSource coefficient(PbrtParameters& parameters, std::string_view name)
{
    return parameters.spectrum(name, SpectrumMeaning::unbounded).value_or(scene::SpectrumSource(scene::Constant{1.0f}));
}

struct GridSize {
    int nx, ny, nz;
    int64_t count;
};

GridSize read_grid_size(PbrtParameters& parameters)
{
    constexpr int most = 1 << 20;  // so that the product of three fits into 64 bits
    const int nx = parameters.integer("nx", 1, 1, most);
    const int ny = parameters.integer("ny", 1, 1, most);
    const int nz = parameters.integer("nz", 1, 1, most);
    return {nx, ny, nz, int64_t{nx} * ny * nz};
}

template <class Grid, class Values>
Grid make_grid(PbrtParameters& parameters, std::string_view name, const GridSize& size, Values values)
{
    if (!values.empty() && static_cast<int64_t>(values.size()) != size.count)
        throw UserError(parameters.where(name), fmt::format("parameter '{}' needs nx*ny*nz = {} values, got {}", name,
                                                            size.count, values.size()));
    return Grid{size.nx, size.ny, size.nz, std::move(values)};
}

void check_not_negative(PbrtParameters& parameters, std::string_view name, const std::vector<float>& values)
{
    for (float value : values)
        if (value < 0.0f)
            throw UserError(parameters.where(name),
                            fmt::format("parameter '{}' must not be negative, got {}", name, value));
}

void read_bounds(PbrtParameters& parameters, Vec3& p0, Vec3& p1)
{
    p0 = parameters.point("p0", p0);
    p1 = parameters.point("p1", p1);
    for (int axis = 0; axis < 3; ++axis) {
        if (p0[axis] > p1[axis]) std::swap(p0[axis], p1[axis]);
        if (p0[axis] == p1[axis])
            throw UserError(parameters.at(), "the medium's bounds 'p0' and 'p1' enclose no volume");
    }
}

scene::HomogeneousMedium read_homogeneous(PbrtParameters& parameters)
{
    scene::HomogeneousMedium medium;
    medium.preset = parameters.string("preset", "");
    if (!medium.preset.empty() && !scene::contains(scene::medium_preset_names(), medium.preset))
        throw UserError(parameters.where("preset"), fmt::format("unknown medium preset '{}'{}", shown(medium.preset),
                                                                suggest(medium.preset, scene::medium_preset_names())));
    medium.sigma_a = coefficient(parameters, "sigma_a");
    medium.sigma_s = coefficient(parameters, "sigma_s");
    medium.emission = parameters.spectrum("Le", SpectrumMeaning::light);
    medium.emission_scale = parameters.number("Lescale", 1.0f, PbrtRange::not_negative);
    return medium;
}

scene::UniformGridMedium read_uniform_grid(PbrtParameters& parameters)
{
    scene::UniformGridMedium medium;
    const GridSize size = read_grid_size(parameters);
    medium.density = make_grid<scene::GridData>(parameters, "density", size, parameters.numbers("density"));
    if (medium.density.values.empty()) throw UserError(parameters.at(), "medium 'uniformgrid' needs a 'density'");
    check_not_negative(parameters, "density", medium.density.values);
    medium.temperature = make_grid<scene::GridData>(parameters, "temperature", size, parameters.numbers("temperature"));
    medium.emission_scale = make_grid<scene::GridData>(parameters, "Lescale", size, parameters.numbers("Lescale"));
    check_not_negative(parameters, "Lescale", medium.emission_scale.values);
    medium.emission = parameters.spectrum("Le", SpectrumMeaning::light);
    if (medium.emission && !medium.temperature.values.empty())
        throw UserError(parameters.at(), "medium 'uniformgrid' takes 'Le' or 'temperature', not both");
    medium.temperature_offset = parameters.number("temperatureoffset", parameters.number("temperaturecutoff", 0.0f));
    medium.temperature_scale = parameters.number("temperaturescale", 1.0f);
    medium.sigma_a = coefficient(parameters, "sigma_a");
    medium.sigma_s = coefficient(parameters, "sigma_s");
    read_bounds(parameters, medium.p0, medium.p1);
    return medium;
}

scene::RgbGridMedium read_rgb_grid(PbrtParameters& parameters, scene::ColorSpace color_space)
{
    scene::RgbGridMedium medium;
    const GridSize size = read_grid_size(parameters);
    const auto grid = [&](std::string_view name) {
        auto values = parameters.colors(name);
        for (const Vec3& rgb : values)
            if (rgb.x < 0 || rgb.y < 0 || rgb.z < 0)
                throw UserError(parameters.where(name), fmt::format("parameter '{}' must not be negative", name));
        return make_grid<scene::RgbGridData>(parameters, name, size, std::move(values));
    };
    medium.sigma_a = grid("sigma_a");
    medium.sigma_s = grid("sigma_s");
    medium.emission = grid("Le");
    if (medium.sigma_a.values.empty() && medium.sigma_s.values.empty())
        throw UserError(parameters.at(), "medium 'rgbgrid' needs 'sigma_a' or 'sigma_s'");
    medium.emission_scale = parameters.number("Lescale", 1.0f, PbrtRange::not_negative);
    medium.color_space = color_space;
    read_bounds(parameters, medium.p0, medium.p1);
    return medium;
}

scene::NanoVdbMedium read_nanovdb_medium(PbrtParameters& parameters)
{
    scene::NanoVdbMedium medium;
    medium.file = parameters.file("filename");
    if (medium.file.empty()) throw UserError(parameters.at(), "medium 'nanovdb' needs a 'filename'");
    medium.density_grid = parameters.string("gridname", medium.density_grid);
    medium.temperature_grid = parameters.string("temperaturename", medium.temperature_grid);
    medium.emission_scale = parameters.number("Lescale", 1.0f, PbrtRange::not_negative);
    medium.temperature_offset = parameters.number("temperatureoffset", parameters.number("temperaturecutoff", 0.0f));
    medium.temperature_scale = parameters.number("temperaturescale", 1.0f);
    medium.sigma_a = coefficient(parameters, "sigma_a");
    medium.sigma_s = coefficient(parameters, "sigma_s");
    return medium;
}

scene::HomogeneousMedium read_cloud_stand_in(PbrtParameters& parameters, float& scale)
{
    scene::HomogeneousMedium medium;
    medium.sigma_a = coefficient(parameters, "sigma_a");
    medium.sigma_s = coefficient(parameters, "sigma_s");
    scale = parameters.number("density", 1.0f, PbrtRange::not_negative);
    parameters.number("wispiness", 1.0f);
    parameters.number("frequency", 5.0f);
    Vec3 p0(0), p1(1);
    read_bounds(parameters, p0, p1);
    parameters.context().warn(parameters.at(),
                              "medium 'cloud' is not supported: a homogeneous medium of the cloud's "
                              "density stands in for it");
    return medium;
}

}  // namespace

scene::Medium read_medium(PbrtParameters& parameters, scene::ColorSpace color_space)
{
    scene::Medium medium;
    if (!parameters.has("type"))
        throw UserError(parameters.at(), fmt::format("{} needs a parameter \"string type\"", parameters.what()));
    const std::string type = parameters.string("type", "");
    medium.g = parameters.number("g", 0.0f);
    if (!(medium.g > -1.0f && medium.g < 1.0f))
        throw UserError(parameters.where("g"),
                        fmt::format("parameter 'g' must lie between -1 and 1, got {}", medium.g));
    if (type != "cloud") medium.scale = parameters.number("scale", 1.0f, PbrtRange::not_negative);
    if (type == "homogeneous")
        medium.kind = read_homogeneous(parameters);
    else if (type == "uniformgrid")
        medium.kind = read_uniform_grid(parameters);
    else if (type == "rgbgrid")
        medium.kind = read_rgb_grid(parameters, color_space);
    else if (type == "nanovdb")
        medium.kind = read_nanovdb_medium(parameters);
    else if (type == "cloud")
        medium.kind = read_cloud_stand_in(parameters, medium.scale);
    else
        fail_type("medium", type, medium_types, parameters.where("type"));
    return medium;
}

}  // namespace dapple
