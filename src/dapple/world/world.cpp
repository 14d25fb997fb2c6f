#include "dapple/world/world.h"

#include "dapple/math/hash.h"
#include "dapple/shapes/mesh.h"
#include "dapple/world/accelerator.h"

namespace dapple {
namespace {

// Whether an alpha cut-out lets the ray pass at this point: a choice made by a hash of the ray and the hit, so that it
// is the same on every thread and differs between rays.
bool passes_cutout(const World& world, const Geometry& geometry, const Ray& ray, const SurfacePoint& at)
{
    if (!geometry.alpha.valid()) return false;
    const float opacity = evaluate(world.materials.textures, geometry.alpha, at);
    if (opacity >= 1.0f) return false;
    if (opacity <= 0.0f) return true;
    const uint64_t h = hash_words(float_bits(ray.direction.x), float_bits(ray.direction.y), float_bits(ray.direction.z),
                                  float_bits(at.position.x), float_bits(at.position.y), float_bits(at.position.z));
    return to_unit_float(h) > opacity;
}

// A primitive of a group, where an instance places it.
Primitive placed_primitive(Primitive primitive, const Transform& place)
{
    primitive.world_from_object = place * primitive.world_from_object;
    primitive.flip = primitive.flip != place.swaps_handedness();
    for (int corner = 0; corner < 4; ++corner) {
        primitive.p[corner] = place.point(primitive.p[corner]);
        if (primitive.has_normals) primitive.n[corner] = normalize(place.normal(primitive.n[corner]));
    }
    return primitive;
}

// The surface point of a triangle of a group, where an instance places it.
void placed_surface_point(const GroupInstance& instance, TriangleCorners corners, SurfaceDetail detail, const Ray& ray,
                          const Hit& hit, SurfacePoint& at)
{
    const Transform place = instance.world_from_group.at(ray.time);
    corners.flip = corners.flip != place.swaps_handedness();
    Vec3 group_size(0);  // Embree intersects in the group's space: its rounding counts too
    Vec3 p[3], n[3], s[3];
    for (int corner = 0; corner < 3; ++corner) {
        for (int axis = 0; axis < 3; ++axis)
            group_size[axis] = std::max(group_size[axis], std::fabs((*corners.p[corner])[axis]));
        p[corner] = place.point(*corners.p[corner]);
        corners.p[corner] = &p[corner];
        if (corners.has_normals) n[corner] = normalize(place.normal(*corners.n[corner]));
        if (corners.has_tangents) s[corner] = place.vector(*corners.s[corner]);
        corners.n[corner] = &n[corner];
        corners.s[corner] = &s[corner];
    }
    triangle_surface_point(corners, hit.uv, ray.time, detail, at);
    const auto& m = place.matrix().m;
    for (int axis = 0; axis < 3; ++axis) {
        // Rounding of the instance transform itself, in both directions.
        float magnitude = std::fabs(at.position[axis]) + static_cast<float>(std::fabs(m[axis][3]));
        for (int k = 0; k < 3; ++k) magnitude += static_cast<float>(std::fabs(m[axis][k])) * group_size[k];
        at.error[axis] += magnitude * 1e-6f;
    }
}

}  // namespace

World::World() = default;
World::~World() = default;

bool World::intersect(const Ray& ray, float t_max, Hit& hit) const
{
    if (!accelerator->intersect(ray, t_max, hit)) return false;
    if (!has_alpha) return true;
    Ray rest = ray;
    float travelled = 0.0f;
    for (;;) {
        const SurfacePoint at = surface_point(rest, hit);
        if (!passes_cutout(*this, geometries[hit.geometry], ray, at)) {
            hit.t += travelled;
            return true;
        }
        const Vec3 origin = offset_ray_origin(at.position, at.error, at.n_geometric, ray.direction);
        travelled = dot(origin - ray.origin, ray.direction) / length_squared(ray.direction);
        rest.origin = origin;
        if (!(t_max > travelled) || !accelerator->intersect(rest, t_max - travelled, hit)) return false;
    }
}

bool World::occluded(const Ray& ray, float t_max) const
{
    if (!has_alpha) return accelerator->occluded(ray, t_max);
    Hit hit;
    return intersect(ray, t_max, hit);
}

float World::textured_opacity(const Light& light, const Vec3& position, const Vec3& normal, const Vec2& uv) const
{
    SurfacePoint at;
    at.position = position;
    at.n_geometric = at.n_shading = normal;
    at.uv = uv;
    return clamp01(evaluate(materials.textures, light.alpha_texture, at));
}

void World::surface_point(const Ray& ray, const Hit& hit, SurfacePoint& at) const
{
    const Geometry& geometry = geometries[hit.geometry];
    const bool placed = hit.instance != Hit::no_instance;
    if (!geometry.is_mesh) {
        const Primitive& primitive = primitives[geometry.first_primitive + hit.primitive];
        const PrimitiveHit primitive_hit{hit.t, hit.uv};
        if (!placed) {
            at = dapple::surface_point(primitive, ray, primitive_hit, geometry.detail);
            return;
        }
        const Transform place = instances[hit.instance].world_from_group.at(ray.time);
        at = dapple::surface_point(placed_primitive(primitive, place), ray, primitive_hit, geometry.detail);
        return;
    }
    const Mesh& mesh = meshes[geometry.mesh];
    const uint32_t* index = &mesh.indices[size_t(hit.primitive) * 3];
    if (!placed && geometry.detail == SurfaceDetail::bare && mesh.normals.empty()) {
        bare_surface_point(mesh.positions.data(), index, geometry.flip, hit.uv, ray.time, at);
        return;
    }
    TriangleCorners corners;
    corners.flip = geometry.flip;
    corners.has_normals = !mesh.normals.empty();
    corners.has_uv = !mesh.uvs.empty() && geometry.detail != SurfaceDetail::bare;
    corners.has_tangents = !mesh.tangents.empty() && geometry.detail == SurfaceDetail::tangents;
    for (int corner = 0; corner < 3; ++corner) {
        corners.p[corner] = mesh.positions.data() + index[corner];
        if (corners.has_normals) corners.n[corner] = mesh.normals.data() + index[corner];
        if (corners.has_uv) corners.uv[corner] = mesh.uvs.data() + index[corner];
        if (corners.has_tangents) corners.s[corner] = mesh.tangents.data() + index[corner];
    }
    if (placed)
        placed_surface_point(instances[hit.instance], corners, geometry.detail, ray, hit, at);
    else
        triangle_surface_point(corners, hit.uv, ray.time, geometry.detail, at);
}

}  // namespace dapple
