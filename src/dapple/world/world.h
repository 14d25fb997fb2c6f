// The compiled scene: flat arrays joined by small ids, read only while rendering. Rays are answered by Embree, which is
// hidden behind Accelerator.
#pragma once

#include "dapple/cameras/camera.h"
#include "dapple/lights/light.h"
#include "dapple/materials/material.h"
#include "dapple/media/medium.h"
#include "dapple/sampling/piecewise.h"
#include "dapple/sampling/random_stream.h"
#include "dapple/shapes/primitive.h"
#include "dapple/spectrum/spectrum_value.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace dapple {

// A set of triangles, or of other primitives, that share everything but their places. One Embree geometry each.
struct Geometry {
    bool is_mesh = true;
    bool flip = false;                               // mesh: outside is against the winding's normal
    SurfaceDetail detail = SurfaceDetail::tangents;  // what its material needs of a surface point
    bool has_medium = false;                         // crossing it changes the medium
    MaterialId material;
    MediumId interior, exterior;   // invalid: vacuum
    FloatTextureId alpha;          // invalid: opaque
    LightId first_light;           // invalid: no emitter; else light of primitive i is first_light + i
    uint32_t mesh = 0;             // is_mesh: index into World::meshes
    uint32_t first_primitive = 0;  // else: range of World::primitives
    uint32_t primitive_count = 0;
    uint32_t name = 0;  // index into World::names, for messages
};

// Vertices of a mesh, in world space, or in the space of the group it belongs to.
struct Mesh {
    std::vector<Vec3> positions;    // one more than there are vertices: Embree reads 16 bytes at a time
    std::vector<Vec3> normals;      // empty, or one per vertex
    std::vector<Vec2> uvs;          // empty, or one per vertex
    std::vector<Vec3> tangents;     // empty, or one per vertex, of any length
    std::vector<uint32_t> indices;  // three per triangle
};

// Geometries that are placed together, once per instance.
struct Group {
    uint32_t first_geometry = 0;
    uint32_t geometry_count = 0;
};
struct GroupInstance {
    uint32_t group = 0;
    AnimatedTransform world_from_group;
};

// Where a ray meets the scene.
struct Hit {
    static constexpr uint32_t no_instance = 0xffffffffu;
    float t = 0.0f;
    Vec2 uv{0, 0};                    // as in PrimitiveHit
    uint32_t geometry = 0;            // index into World::geometries
    uint32_t primitive = 0;           // triangle or primitive of the geometry
    uint32_t instance = no_instance;  // index into World::instances
};

class Accelerator;  // embree_accelerator.cpp

class World {
public:
    World();
    World(const World&) = delete;  // the accelerator refers to the arrays in place
    World& operator=(const World&) = delete;
    ~World();

    // The nearest surface met by the ray at t in (0, t_max), alpha cut-outs ignored. False when there is none.
    bool intersect(const Ray& ray, float t_max, Hit& hit) const;
    // Whether any surface (interfaces included) is met at t in (0, t_max).
    bool occluded(const Ray& ray, float t_max) const;
    // Differential geometry at a hit of `ray`; uv and tangents where the geometry's material looks at them.
    SurfacePoint surface_point(const Ray& ray, const Hit& hit) const
    {
        SurfacePoint at;
        surface_point(ray, hit, at);
        return at;
    }
    // The same in place; what is left out keeps what it held.
    void surface_point(const Ray& ray, const Hit& hit, SurfacePoint& at) const;

    // The area light at a hit, or an invalid id.
    LightId emitter(const Hit& hit) const
    {
        const LightId first = geometries[hit.geometry].first_light;
        return first.valid() && hit.instance == Hit::no_instance ? LightId(first.value + hit.primitive) : LightId();
    }
    // The medium beyond a geometry's surface: on its outside or inside. `current`: where no boundary is declared.
    MediumId medium_beyond(uint32_t geometry, bool outside, MediumId current) const
    {
        const Geometry& g = geometries[geometry];
        return g.has_medium ? (outside ? g.exterior : g.interior) : current;
    }
    const std::string& name_of(uint32_t geometry) const { return names[geometries[geometry].name]; }

    // Opacity of a light's shape at one of its points: what a cut-out leaves of an area light's emission.
    float opacity(const Light& light, const Vec3& position, const Vec3& normal, const Vec2& uv) const
    {
        return light.alpha_texture.valid() ? textured_opacity(light, position, normal, uv) : 1.0f;
    }

    // Probability of a light under power-weighted selection (light_choice).
    float light_probability(LightId light) const { return light_choice.probability(light.value); }
    // A light chosen so. By u where none is improbable, and u is as good as new afterwards: the points on the lights
    // share its even spread; where too few of its bits would be left, a number is drawn.
    LightId choose_light(RandomStream& random, float& u) const
    {
        if (!light_choice.remaps_finely()) return LightId(light_choice.sample(random.next()));
        random.skip(1);
        return LightId(light_choice.sample(u, &u));
    }

    SpectrumPool spectra;
    Materials materials;
    Lights lights;
    Media media;
    Camera camera;
    MediumId camera_medium;

    std::vector<Mesh> meshes;
    std::vector<Primitive> primitives;
    std::vector<Geometry> geometries;
    std::vector<Group> groups;
    std::vector<GroupInstance> instances;
    std::vector<std::string> names;
    std::vector<std::string> light_group_names;  // index: LightGroup; [0] is "default"

    AliasTable light_choice;            // over lights.list, by power
    std::vector<LightId> environments;  // lights that an escaping ray meets
    Box3 bounds;
    bool has_interfaces = false;  // some material is an interface: shadow rays must look closer
    bool has_alpha = false;
    bool has_scattering_media = false;
    bool has_emitting_media = false;
    // Whether media do more than absorb.
    bool has_active_media() const { return has_scattering_media || has_emitting_media; }

    std::unique_ptr<Accelerator> accelerator;

private:
    float textured_opacity(const Light& light, const Vec3& position, const Vec3& normal, const Vec2& uv) const;
};

}  // namespace dapple
