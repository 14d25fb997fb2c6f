// Shapes of pbrt-v4.
#include "dapple/formats/pbrt_builder.h"
#include "dapple/formats/pbrt_legacy.h"
#include "dapple/formats/ply.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace dapple {
namespace {

constexpr std::string_view shape_types[] = {"sphere",       "disk",    "cylinder",   "trianglemesh",
                                            "bilinearmesh", "plymesh", "loopsubdiv", "curve"};

float read_phi_max(PbrtParameters& parameters)
{
    const float phi_max = parameters.number("phimax", 360.0f, PbrtRange::positive);
    if (phi_max > 360.0f)
        throw UserError(parameters.where("phimax"),
                        fmt::format("parameter 'phimax' must not exceed 360, got {}", phi_max));
    return phi_max;
}

scene::Sphere read_sphere(PbrtParameters& parameters)
{
    scene::Sphere sphere;
    sphere.radius = parameters.number("radius", 1.0f, PbrtRange::positive);
    const float z0 = parameters.number("zmin", -sphere.radius);
    const float z1 = parameters.number("zmax", sphere.radius);
    sphere.z_min = std::clamp(std::min(z0, z1), -sphere.radius, sphere.radius);
    sphere.z_max = std::clamp(std::max(z0, z1), -sphere.radius, sphere.radius);
    if (sphere.z_min == sphere.z_max) throw UserError(parameters.at(), "'zmin' and 'zmax' leave nothing of the sphere");
    sphere.phi_max = read_phi_max(parameters);
    return sphere;
}

scene::Disk read_disk(PbrtParameters& parameters)
{
    scene::Disk disk;
    disk.height = parameters.number("height", 0.0f);
    disk.radius = parameters.number("radius", 1.0f, PbrtRange::positive);
    disk.inner_radius = parameters.number("innerradius", 0.0f, PbrtRange::not_negative);
    if (disk.inner_radius >= disk.radius)
        throw UserError(parameters.where("innerradius"), "parameter 'innerradius' must be less than 'radius'");
    disk.phi_max = read_phi_max(parameters);
    return disk;
}

scene::Cylinder read_cylinder(PbrtParameters& parameters)
{
    scene::Cylinder cylinder;
    cylinder.radius = parameters.number("radius", 1.0f, PbrtRange::positive);
    const float z0 = parameters.number("zmin", -1.0f);
    const float z1 = parameters.number("zmax", 1.0f);
    cylinder.z_min = std::min(z0, z1);
    cylinder.z_max = std::max(z0, z1);
    if (cylinder.z_min == cylinder.z_max)
        throw UserError(parameters.at(), "'zmin' and 'zmax' of the cylinder are the same");
    cylinder.phi_max = read_phi_max(parameters);
    return cylinder;
}

std::vector<uint32_t> read_indices(PbrtParameters& parameters, size_t per_face, size_t vertices)
{
    const std::vector<int> indices = parameters.integers("indices");
    const SourceLocation where = parameters.where("indices");
    if (indices.empty()) {
        if (vertices != per_face) throw UserError(where, fmt::format("{} needs 'indices'", parameters.what()));
        std::vector<uint32_t> single(per_face);
        std::iota(single.begin(), single.end(), 0u);
        return single;
    }
    if (indices.size() % per_face != 0)
        throw UserError(where, fmt::format("parameter 'indices' takes {} numbers per face, got {} in all", per_face,
                                           indices.size()));
    std::vector<uint32_t> result(indices.size());
    for (size_t i = 0; i < indices.size(); ++i) {
        if (indices[i] < 0 || static_cast<size_t>(indices[i]) >= vertices)
            throw UserError(where, fmt::format("parameter 'indices': value {} of {} is {}, but there are {} vertices",
                                               i + 1, indices.size(), indices[i], vertices));
        result[i] = static_cast<uint32_t>(indices[i]);
    }
    return result;
}

void check_count(PbrtParameters& parameters, std::string_view name, size_t count, size_t vertices)
{
    if (count != 0 && count != vertices)
        throw UserError(parameters.where(name),
                        fmt::format("parameter '{}' has {} values for {} vertices", name, count, vertices));
}

scene::MeshData read_vertices(PbrtParameters& parameters)
{
    scene::MeshData mesh;
    mesh.positions = parameters.points("P");
    if (mesh.positions.empty())
        throw UserError(parameters.at(), fmt::format("{} needs positions 'P'", parameters.what()));
    return mesh;
}

void read_vertex_attributes(PbrtParameters& parameters, scene::MeshData& mesh)
{
    mesh.normals = parameters.normals("N");
    mesh.uvs = parameters.points2("uv");
    check_count(parameters, "N", mesh.normals.size(), mesh.positions.size());
    check_count(parameters, "uv", mesh.uvs.size(), mesh.positions.size());
    parameters.ignore("faceIndices", "only ptex textures use it");
}

scene::Mesh read_triangle_mesh(PbrtParameters& parameters)
{
    scene::MeshData mesh = read_vertices(parameters);
    mesh.triangles = read_indices(parameters, 3, mesh.positions.size());
    read_vertex_attributes(parameters, mesh);
    mesh.tangents = parameters.vectors("S");
    check_count(parameters, "S", mesh.tangents.size(), mesh.positions.size());
    return {std::make_shared<const scene::MeshData>(std::move(mesh))};
}

scene::Mesh read_bilinear_mesh(PbrtParameters& parameters)
{
    scene::MeshData mesh = read_vertices(parameters);
    mesh.quads = read_indices(parameters, 4, mesh.positions.size());
    read_vertex_attributes(parameters, mesh);
    parameters.ignore("emissionfilename", "give the area light a 'filename'");
    return {std::make_shared<const scene::MeshData>(std::move(mesh))};
}

scene::LoopSubdivision read_loop_subdivision(PbrtParameters& parameters)
{
    constexpr int most_levels = 10;
    constexpr int64_t most_triangles = 100'000'000;
    scene::LoopSubdivision subdivision;
    subdivision.levels = parameters.integer("levels", 3, 0, most_levels);
    constexpr std::string_view schemes[] = {"loop"};
    parameters.word("scheme", 0, schemes);
    scene::MeshData mesh = read_vertices(parameters);
    mesh.triangles = read_indices(parameters, 3, mesh.positions.size());
    const int64_t triangles = static_cast<int64_t>(mesh.triangles.size() / 3) << (2 * subdivision.levels);
    if (triangles > most_triangles)
        throw UserError(parameters.at(), fmt::format("{} levels of subdivision make {} triangles, more than {}",
                                                     subdivision.levels, triangles, most_triangles));
    subdivision.data = std::make_shared<const scene::MeshData>(std::move(mesh));
    return subdivision;
}

scene::Mesh read_ply_mesh(PbrtParameters& parameters, PlyCache& ply_files)
{
    const std::filesystem::path path = parameters.file("filename");
    const SourceLocation where = parameters.where("filename");
    if (path.empty()) throw UserError(where, "shape 'plymesh' needs a 'filename'");
    parameters.context().check_files_allowed(where);
    parameters.ignore("displacement", "displaced meshes are not supported; the mesh is used as it is");
    parameters.ignore("edgelength", "displaced meshes are not supported");
    auto& mesh = ply_files[path.string()];
    if (!mesh) mesh = std::make_shared<const scene::MeshData>(read_ply(path, where));
    return {mesh};
}

}  // namespace

std::optional<ShapeGeometry> read_geometry(const std::string& type, PbrtParameters& parameters, PlyCache& ply_files)
{
    if (type == "sphere") return read_sphere(parameters);
    if (type == "disk") return read_disk(parameters);
    if (type == "cylinder") return read_cylinder(parameters);
    if (type == "trianglemesh") return read_triangle_mesh(parameters);
    if (type == "bilinearmesh") return read_bilinear_mesh(parameters);
    if (type == "loopsubdiv") return read_loop_subdivision(parameters);
    if (type == "plymesh") return read_ply_mesh(parameters, ply_files);
    if (type == "curve") {
        parameters.context().warn(parameters.at(), "shape 'curve' is not supported: it is left out");
        parameters.ignore_rest();
        return std::nullopt;
    }
    fail_type("shape", type, shape_types, parameters.at(), legacy_hint(LegacyKind::shape, type));
}

}  // namespace dapple
