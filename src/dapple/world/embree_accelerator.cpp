// Embree 3.13 (or 4) behind the Accelerator interface. Triangles are native; quadrics and bilinear patches are user
// geometry, intersected by shapes/primitive.h in double precision. Single-ray queries with isa=avx2: the fastest choice
// for incoherent rays on the machine of docs/performance.md.
#include "dapple/world/accelerator.h"

#include "dapple/base/error.h"
#include "dapple/base/log.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#define DAPPLE_EMBREE 4
#else
#include <embree3/rtcore.h>
#define DAPPLE_EMBREE 3
#endif

#include <atomic>
#include <cstddef>
#include <cstring>
#include <vector>

namespace dapple {

namespace {

struct PrimitiveSet {
    const World* world;
    const Geometry* geometry;
};

}  // namespace

struct Accelerator::State {
    const World* world = nullptr;
    RTCDevice device = nullptr;
    RTCScene top = nullptr;
    std::vector<RTCScene> group_scenes;
    std::vector<uint32_t> top_geometries;  // geomID of a plain geometry in the top scene -> index in world.geometries
    uint32_t first_instance = 0;           // geomIDs from here on are instances
    std::vector<PrimitiveSet> sets;        // user data of user geometries; never resized once handed out
    std::atomic<size_t> bytes{0};

    ~State()
    {
        for (RTCScene scene : group_scenes) rtcReleaseScene(scene);
        if (top) rtcReleaseScene(top);
        if (device) rtcReleaseDevice(device);
    }

    RTCGeometry make_geometry(const Geometry& geometry) const;
    RTCGeometry make_instance(const GroupInstance& instance) const;
};

namespace {

bool count_memory(void* user, ssize_t bytes, bool)
{
    static_cast<std::atomic<size_t>*>(user)->fetch_add(static_cast<size_t>(bytes));
    return true;
}

void report_error(void*, RTCError, const char* text) { log_warning("Embree: {}", text); }

const Primitive& primitive_of(const World& world, const Geometry& geometry, unsigned index)
{
    return world.primitives[geometry.first_primitive + index];
}

void primitive_bounds(const RTCBoundsFunctionArguments* args)
{
    const auto* set = static_cast<const PrimitiveSet*>(args->geometryUserPtr);
    const Box3 box = bounds(primitive_of(*set->world, *set->geometry, args->primID));
    RTCBounds& out = *args->bounds_o;
    // Embree tests boxes in single precision: a margin keeps grazing rays inside.
    const Vec3 margin = (abs(box.min) + abs(box.max)) * 4e-7f;
    out.lower_x = box.min.x - margin.x;
    out.lower_y = box.min.y - margin.y;
    out.lower_z = box.min.z - margin.z;
    out.upper_x = box.max.x + margin.x;
    out.upper_y = box.max.y + margin.y;
    out.upper_z = box.max.z + margin.z;
}

Ray from_embree(const RTCRay& ray)
{
    return Ray{{ray.org_x, ray.org_y, ray.org_z}, {ray.dir_x, ray.dir_y, ray.dir_z}, ray.time};
}

void primitive_intersect(const RTCIntersectFunctionNArguments* args)
{
    if (!args->valid[0]) return;
    const auto* set = static_cast<const PrimitiveSet*>(args->geometryUserPtr);
    auto* ray_hit = reinterpret_cast<RTCRayHit*>(args->rayhit);
    PrimitiveHit hit;
    if (!meet(primitive_of(*set->world, *set->geometry, args->primID), from_embree(ray_hit->ray), ray_hit->ray.tnear,
              ray_hit->ray.tfar, hit))
        return;
    ray_hit->ray.tfar = hit.t;
    ray_hit->hit.u = hit.uv.x;
    ray_hit->hit.v = hit.uv.y;
    ray_hit->hit.geomID = args->geomID;
    ray_hit->hit.primID = args->primID;
    ray_hit->hit.instID[0] = args->context->instID[0];
}

void primitive_occluded(const RTCOccludedFunctionNArguments* args)
{
    if (!args->valid[0]) return;
    const auto* set = static_cast<const PrimitiveSet*>(args->geometryUserPtr);
    auto* ray = reinterpret_cast<RTCRay*>(args->ray);
    PrimitiveHit hit;
    if (meet(primitive_of(*set->world, *set->geometry, args->primID), from_embree(*ray), ray->tnear, ray->tfar, hit))
        ray->tfar = -infinity;
}

void set_decomposition(RTCGeometry geometry, unsigned step, const AnimatedTransform::Parts& parts)
{
    RTCQuaternionDecomposition q;
    rtcInitQuaternionDecomposition(&q);
    const auto& m = parts.scale.m;
    // Embree holds an upper triangular scale-skew; a symmetric stretch fits it only when diagonal (see make_instance).
    rtcQuaternionDecompositionSetScale(&q, static_cast<float>(m[0][0]), static_cast<float>(m[1][1]),
                                       static_cast<float>(m[2][2]));
    rtcQuaternionDecompositionSetQuaternion(&q, parts.rotation[3], parts.rotation[0], parts.rotation[1],
                                            parts.rotation[2]);
    rtcQuaternionDecompositionSetTranslation(&q, parts.translation.x, parts.translation.y, parts.translation.z);
    rtcSetGeometryTransformQuaternion(geometry, step, &q);
}

void set_matrix(RTCGeometry geometry, unsigned step, const Transform& transform)
{
    float columns[12];
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 3; ++row)
            columns[column * 3 + row] = static_cast<float>(transform.matrix().m[row][column]);
    rtcSetGeometryTransform(geometry, step, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
}

bool is_diagonal(const Matrix4& matrix)
{
    const auto& m = matrix.m;
    const double size = std::abs(m[0][0]) + std::abs(m[1][1]) + std::abs(m[2][2]);
    double off = 0.0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (i != j) off = std::max(off, std::abs(m[i][j]));
    return off <= 1e-6 * size;
}

bool same_rotation(const AnimatedTransform& transform)
{
    const auto& a = transform.start_parts().rotation;
    const auto& b = transform.end_parts().rotation;
    float dot = 0.0f;
    for (int i = 0; i < 4; ++i) dot += a[i] * b[i];
    return std::abs(dot) > 1.0f - 1e-7f;
}

RTCRayHit to_embree(const Ray& ray, float t_max)
{
    RTCRayHit query;
    // Four numbers at a time: Embree reads them so, and would wait for parts to reach memory.
    typedef float Float4 __attribute__((vector_size(16)));
    const Float4 origin = {ray.origin.x, ray.origin.y, ray.origin.z, 0.0f};  // and tnear
    const Float4 direction = {ray.direction.x, ray.direction.y, ray.direction.z, ray.time};
    static_assert(offsetof(RTCRay, tnear) == 12 && offsetof(RTCRay, dir_x) == 16 && offsetof(RTCRay, time) == 28);
    std::memcpy(reinterpret_cast<char*>(&query.ray), &origin, sizeof origin);
    std::memcpy(reinterpret_cast<char*>(&query.ray) + sizeof origin, &direction, sizeof direction);
    query.ray.tfar = t_max;
    query.ray.mask = 0xffffffffu;
    query.ray.id = 0;
    query.ray.flags = 0;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return query;
}

}  // namespace

RTCGeometry Accelerator::State::make_geometry(const Geometry& geometry) const
{
    if (geometry.is_mesh) {
        const Mesh& mesh = world->meshes[geometry.mesh];
        RTCGeometry out = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetSharedGeometryBuffer(out, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.positions.data(), 0,
                                   sizeof(Vec3), mesh.positions.size() - 1);  // the last is padding, see Mesh
        rtcSetSharedGeometryBuffer(out, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.indices.data(), 0,
                                   3 * sizeof(uint32_t), mesh.indices.size() / 3);
        rtcCommitGeometry(out);
        return out;
    }
    RTCGeometry out = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(out, geometry.primitive_count);
    rtcSetGeometryBoundsFunction(out, primitive_bounds, nullptr);
    rtcSetGeometryIntersectFunction(out, primitive_intersect);
    rtcSetGeometryOccludedFunction(out, primitive_occluded);
    return out;  // user data and commit: by the constructor, which owns the sets
}

RTCGeometry Accelerator::State::make_instance(const GroupInstance& instance) const
{
    RTCGeometry out = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(out, group_scenes[instance.group]);
    const AnimatedTransform& transform = instance.world_from_group;
    if (!transform.moves()) {
        rtcSetGeometryTimeStepCount(out, 1);
        set_matrix(out, 0, transform.start());
    } else if (same_rotation(transform)) {
        rtcSetGeometryTimeStepCount(out, 2);  // without rotation, interpolating matrices is the same and exact
        set_matrix(out, 0, transform.start());
        set_matrix(out, 1, transform.end());
    } else if (is_diagonal(transform.start_parts().scale) && is_diagonal(transform.end_parts().scale)) {
        rtcSetGeometryTimeStepCount(out, 2);
        set_decomposition(out, 0, transform.start_parts());
        set_decomposition(out, 1, transform.end_parts());
    } else {
        // A general stretch that also turns: piecewise linear in time, fine enough not to show.
        constexpr unsigned steps = 65;
        rtcSetGeometryTimeStepCount(out, steps);
        for (unsigned step = 0; step < steps; ++step) set_matrix(out, step, transform.at(float(step) / (steps - 1)));
    }
    rtcCommitGeometry(out);
    return out;
}

Accelerator::Accelerator(const World& world) : state_(std::make_unique<State>())
{
    State& s = *state_;
    s.world = &world;
    s.device = rtcNewDevice("isa=avx2");
    if (!s.device) s.device = rtcNewDevice(nullptr);
    if (!s.device) throw UserError("Embree could not start on this machine");
    rtcSetDeviceErrorFunction(s.device, report_error, nullptr);
    rtcSetDeviceMemoryMonitorFunction(s.device, count_memory, &s.bytes);

    s.sets.reserve(world.geometries.size());
    std::vector<bool> in_group(world.geometries.size(), false);
    const auto attach = [&](RTCScene scene, const Geometry& geometry) {
        RTCGeometry made = s.make_geometry(geometry);
        if (!geometry.is_mesh) {
            s.sets.push_back({&world, &geometry});
            rtcSetGeometryUserData(made, &s.sets.back());
            rtcCommitGeometry(made);
        }
        const unsigned id = rtcAttachGeometry(scene, made);
        rtcReleaseGeometry(made);
        return id;
    };

    for (const Group& group : world.groups) {
        RTCScene scene = rtcNewScene(s.device);
        rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
        for (uint32_t i = 0; i < group.geometry_count; ++i) {
            in_group[group.first_geometry + i] = true;
            attach(scene, world.geometries[group.first_geometry + i]);
        }
        rtcCommitScene(scene);
        s.group_scenes.push_back(scene);
    }

    s.top = rtcNewScene(s.device);
    rtcSetSceneFlags(s.top, RTC_SCENE_FLAG_ROBUST);
    for (uint32_t i = 0; i < world.geometries.size(); ++i) {
        if (in_group[i]) continue;
        attach(s.top, world.geometries[i]);
        s.top_geometries.push_back(i);
    }
    s.first_instance = static_cast<uint32_t>(s.top_geometries.size());
    for (const GroupInstance& instance : world.instances) {
        RTCGeometry made = s.make_instance(instance);
        rtcAttachGeometry(s.top, made);
        rtcReleaseGeometry(made);
    }
    rtcCommitScene(s.top);
}

Accelerator::~Accelerator() = default;

bool Accelerator::intersect(const Ray& ray, float t_max, Hit& hit) const
{
    RTCRayHit query = to_embree(ray, t_max);
#if DAPPLE_EMBREE == 4
    rtcIntersect1(state_->top, &query);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(state_->top, &context, &query);
#endif
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    hit.t = query.ray.tfar;
    hit.uv = Vec2(query.hit.u, query.hit.v);
    hit.primitive = query.hit.primID;
    if (query.hit.instID[0] == RTC_INVALID_GEOMETRY_ID) {
        hit.instance = Hit::no_instance;
        hit.geometry = state_->top_geometries[query.hit.geomID];
    } else {
        hit.instance = query.hit.instID[0] - state_->first_instance;
        const Group& group = state_->world->groups[state_->world->instances[hit.instance].group];
        hit.geometry = group.first_geometry + query.hit.geomID;
    }
    return true;
}

bool Accelerator::occluded(const Ray& ray, float t_max) const
{
    RTCRay query = to_embree(ray, t_max).ray;
#if DAPPLE_EMBREE == 4
    rtcOccluded1(state_->top, &query);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(state_->top, &context, &query);
#endif
    return query.tfar < 0.0f;
}

Box3 Accelerator::bounds() const
{
    RTCBounds box;
    rtcGetSceneBounds(state_->top, &box);
    return Box3(Vec3(box.lower_x, box.lower_y, box.lower_z), Vec3(box.upper_x, box.upper_y, box.upper_z));
}

size_t Accelerator::memory() const { return state_->bytes.load(); }

}  // namespace dapple
