// Shapes to geometries. Static shapes are baked into world space; shapes of objects into their group's space; a moving
// shape becomes a group of its own, placed by a moving instance.
#include "dapple/base/log.h"
#include "dapple/base/parallel.h"
#include "dapple/shapes/loop_subdivision.h"
#include "dapple/world/compile_parts.h"

namespace dapple::detail {
namespace {

// A shape on its way: where it goes, and what the parallel part makes of it.
struct Job {
    const scene::Shape* shape;
    Transform transform;  // into world space or the group's space
    bool may_emit;
    Mesh mesh;                          // triangles, if any
    bool mesh_flip = false;             // whether their outside is against their winding
    std::vector<Primitive> primitives;  // quadrics and patches, if any
};

bool flipped(const Job& job) { return job.shape->reverse_orientation != job.transform.swaps_handedness(); }

Mesh bake_mesh(const Job& job, const scene::MeshData& data)
{
    Mesh mesh;
    mesh.positions.reserve(data.positions.size() + 1);
    for (const Vec3& p : data.positions) mesh.positions.push_back(job.transform.point(p));
    mesh.normals.reserve(data.normals.size());
    for (const Vec3& n : data.normals) {
        const Vec3 turned = job.transform.normal(n);
        const float len = length(turned);
        const Vec3 unit = len > 0.0f ? turned * (1.0f / len) : Vec3(0);
        mesh.normals.push_back(job.shape->reverse_orientation ? -unit : unit);
    }
    mesh.uvs = data.uvs;
    mesh.tangents.reserve(data.tangents.size());
    for (const Vec3& s : data.tangents) mesh.tangents.push_back(job.transform.vector(s));
    mesh.indices = data.triangles;
    mesh.positions.push_back(Vec3(0));  // padding, see Mesh
    return mesh;
}

// Shading normals that say no more than the triangles themselves cost time at every hit: they are left out. They may
// have turned the outside over.
void drop_flat_normals(Mesh& mesh, bool& flip)
{
    constexpr float rounding = 1e-5f;
    bool turned = false, first = true;
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
        const uint32_t* v = &mesh.indices[i];
        const Imath::V3d p0(mesh.positions[v[0]]);
        const Imath::V3d winding = (Imath::V3d(mesh.positions[v[1]]) - p0).cross(Imath::V3d(mesh.positions[v[2]]) - p0);
        const double size = winding.length();
        if (!(size > 0.0)) continue;
        const Vec3 unit(winding / size);
        if (first) turned = dot(unit, mesh.normals[v[0]]) < 0.0f;
        first = false;
        for (int corner = 0; corner < 3; ++corner)
            if (!(length(mesh.normals[v[corner]] - (turned ? -unit : unit)) < rounding)) return;
    }
    if (first) return;
    mesh.normals.clear();
    flip = turned;
}

void bake_triangles(Job& job, const scene::MeshData& data)
{
    job.mesh = bake_mesh(job, data);
    job.mesh_flip = flipped(job);
    if (!job.mesh.normals.empty()) drop_flat_normals(job.mesh, job.mesh_flip);
}

std::vector<Primitive> bake_patches(const Job& job, const scene::MeshData& data)
{
    std::vector<Primitive> patches(data.quads.size() / 4);
    for (size_t i = 0; i < patches.size(); ++i) {
        Primitive& patch = patches[i];
        patch.kind = Primitive::Kind::bilinear;
        patch.flip = flipped(job);
        patch.has_normals = !data.normals.empty();
        patch.has_uv = !data.uvs.empty();
        for (int corner = 0; corner < 4; ++corner) {
            const uint32_t v = data.quads[i * 4 + corner];
            patch.p[corner] = job.transform.point(data.positions[v]);
            if (patch.has_uv) patch.uv[corner] = data.uvs[v];
            if (patch.has_normals) {
                const Vec3 n = normalize(job.transform.normal(data.normals[v]));
                patch.n[corner] = job.shape->reverse_orientation ? -n : n;
            }
        }
    }
    return patches;
}

Primitive quadric(const Job& job, Primitive::Kind kind, float radius, float phi_max)
{
    Primitive out;
    out.kind = kind;
    out.flip = flipped(job);
    out.world_from_object = job.transform;
    out.radius = radius;
    out.phi_max = radians(std::clamp(phi_max, 0.0f, 360.0f));
    return out;
}

void bake(Job& job)
{
    const auto& geometry = job.shape->geometry;
    if (const auto* sphere = std::get_if<scene::Sphere>(&geometry)) {
        Primitive p = quadric(job, Primitive::Kind::sphere, sphere->radius, sphere->phi_max);
        p.z_min = std::clamp(std::min(sphere->z_min, sphere->z_max), -sphere->radius, sphere->radius);
        p.z_max = std::clamp(std::max(sphere->z_min, sphere->z_max), -sphere->radius, sphere->radius);
        job.primitives = {p};
    } else if (const auto* disk = std::get_if<scene::Disk>(&geometry)) {
        Primitive p = quadric(job, Primitive::Kind::disk, disk->radius, disk->phi_max);
        p.height = disk->height;
        p.inner_radius = disk->inner_radius;
        job.primitives = {p};
    } else if (const auto* cylinder = std::get_if<scene::Cylinder>(&geometry)) {
        Primitive p = quadric(job, Primitive::Kind::cylinder, cylinder->radius, cylinder->phi_max);
        p.z_min = std::min(cylinder->z_min, cylinder->z_max);
        p.z_max = std::max(cylinder->z_min, cylinder->z_max);
        job.primitives = {p};
    } else if (const auto* mesh = std::get_if<scene::Mesh>(&geometry)) {
        if (!mesh->data->triangles.empty()) bake_triangles(job, *mesh->data);
        job.primitives = bake_patches(job, *mesh->data);
    } else if (const auto* loop = std::get_if<scene::LoopSubdivision>(&geometry)) {
        const SubdividedMesh fine =
            loop_subdivide(loop->data->positions, loop->data->triangles, loop->levels, job.shape->at);
        bake_triangles(job, scene::MeshData{fine.positions, fine.normals, {}, fine.indices, {}, {}});
    }
}

// The triangles of a mesh as primitives, for area lights.
std::vector<Primitive> triangles_of(const Job& job)
{
    std::vector<Primitive> out(job.mesh.indices.size() / 3);
    for (size_t i = 0; i < out.size(); ++i) {
        Primitive& triangle = out[i];
        triangle.kind = Primitive::Kind::triangle;
        triangle.flip = job.mesh_flip;
        triangle.has_normals = !job.mesh.normals.empty();
        triangle.has_uv = !job.mesh.uvs.empty();
        for (int corner = 0; corner < 3; ++corner) {
            const uint32_t v = job.mesh.indices[i * 3 + corner];
            triangle.p[corner] = job.mesh.positions[v];
            if (triangle.has_uv) triangle.uv[corner] = job.mesh.uvs[v];
            if (triangle.has_normals) triangle.n[corner] = job.mesh.normals[v];
        }
    }
    return out;
}

void warn_no_emission(const scene::Shape& shape, const char* why)
{
    if (shape.area_light.valid())
        log_warning("{}: area light on {} is ignored: {}", shape.at.to_string(), shape.name, why);
}

// Appends the geometries of a baked shape (one for its triangles, one for its other primitives).
void append(CompileContext& context, Job& job)
{
    World& world = context.world;
    const scene::Shape& shape = *job.shape;
    Geometry base;
    base.material = MaterialId(shape.material.value);
    base.detail = needed_detail(world.materials, base.material);
    base.has_medium = shape.medium_interface && shape.inside != shape.outside;  // as in pbrt, else no boundary
    base.interior = medium_id(shape.inside);
    base.exterior = medium_id(shape.outside);
    base.flip = flipped(job);
    base.name = static_cast<uint32_t>(world.names.size());
    world.names.push_back(shape.name + (shape.at.file.empty() ? "" : " at " + shape.at.to_string()));
    const bool invisible = !shape.alpha.textured() && shape.alpha.value <= 0.0f;
    if (shape.alpha.textured() || shape.alpha.value < 1.0f) base.alpha = float_texture(context, shape.alpha);
    const bool has_image =
        shape.area_light.valid() && !context.description.area_lights[shape.area_light.value].file.empty();
    if (base.alpha.valid() || has_image) base.detail = std::max(base.detail, SurfaceDetail::no_tangents);
    const bool is_interface = world.materials.list[base.material.value].kind == Material::Kind::interface;
    if (is_interface && job.may_emit) warn_no_emission(shape, "its material is an interface, which has no surface");
    const bool emits = shape.area_light.valid() && job.may_emit && !is_interface;

    const auto add = [&](Geometry geometry, const std::vector<Primitive>& emitters) {
        if (emits) geometry.first_light = compile_area_lights(context, shape, geometry, emitters);
        if (!invisible) world.geometries.push_back(geometry);
    };
    if (!job.mesh.indices.empty()) {
        Geometry geometry = base;
        geometry.mesh = static_cast<uint32_t>(world.meshes.size());
        geometry.flip = job.mesh_flip;
        const std::vector<Primitive> emitters = emits ? triangles_of(job) : std::vector<Primitive>();
        world.meshes.push_back(std::move(job.mesh));
        add(geometry, emitters);
    }
    if (!job.primitives.empty()) {
        Geometry geometry = base;
        geometry.is_mesh = false;
        geometry.first_primitive = static_cast<uint32_t>(world.primitives.size());
        geometry.primitive_count = static_cast<uint32_t>(job.primitives.size());
        world.primitives.insert(world.primitives.end(), job.primitives.begin(), job.primitives.end());
        add(geometry, job.primitives);
    }
}

}  // namespace

void compile_shapes(CompileContext& context)
{
    const scene::Description& description = context.description;
    World& world = context.world;

    // The order of jobs is the order of geometries: static shapes, then objects, then moving shapes.
    std::vector<Job> jobs;
    std::vector<const scene::Shape*> moving;
    for (const scene::Shape& shape : description.shapes) {
        if (over_shutter(shape.world_from_object, context.camera).moves())
            moving.push_back(&shape);
        else
            jobs.push_back(
                {&shape, over_shutter(shape.world_from_object, context.camera).start(), true, {}, false, {}});
    }
    std::vector<size_t> group_ends;
    const size_t static_count = jobs.size();
    for (const scene::ObjectDefinition& object : description.objects) {
        for (const scene::Shape& shape : object.shapes) {
            warn_no_emission(shape, "it is part of an instanced object");
            if (shape.world_from_object.moves())
                log_warning("{}: motion of {} inside an object is ignored; move the instance instead",
                            shape.at.to_string(), shape.name);
            jobs.push_back({&shape, Transform(shape.world_from_object.start), false, {}, false, {}});
        }
        group_ends.push_back(jobs.size());
    }
    for (const scene::Shape* shape : moving) {
        warn_no_emission(*shape, "the shape moves");
        jobs.push_back({shape, Transform(), false, {}, false, {}});
        group_ends.push_back(jobs.size());
    }

    parallel_for(static_cast<int64_t>(jobs.size()), 1, [&](int64_t i) { bake(jobs[i]); });

    for (size_t i = 0; i < static_count; ++i) append(context, jobs[i]);
    size_t next = static_count;
    for (size_t end : group_ends) {
        Group group;
        group.first_geometry = static_cast<uint32_t>(world.geometries.size());
        for (; next < end; ++next) append(context, jobs[next]);
        group.geometry_count = static_cast<uint32_t>(world.geometries.size()) - group.first_geometry;
        world.groups.push_back(group);
    }
    for (const scene::Instance& instance : description.instances)
        world.instances.push_back({instance.object.value, over_shutter(instance.world_from_object, context.camera)});
    for (size_t i = 0; i < moving.size(); ++i)
        world.instances.push_back({static_cast<uint32_t>(description.objects.size() + i),
                                   over_shutter(moving[i]->world_from_object, context.camera)});
}

}  // namespace dapple::detail
