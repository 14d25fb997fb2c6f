#include "dapple/integrators/surface_coverage.h"

#include "dapple/math/hash.h"
#include "dapple/sampling/warps.h"

namespace dapple {
namespace {

constexpr int first_points = 16;
constexpr int further_points = 32;
constexpr float golden_angle = 2.39996323f;
constexpr int most_trials = 32;
constexpr int looks_around = 3;
constexpr float flat_tolerance = 0.01f;
// Of slivers and cracks. The spiral's points know smaller shares badly: their quotients would be fireflies.
constexpr float least_share = 1.0f / 16.0f;

// Whether light goes straight on, or bent, and no photon is stored: boundaries of media and smooth glass.
bool lets_light_through(const World& world, uint32_t geometry, const SurfacePoint& point)
{
    const MaterialId material = resolve_mix(world.materials, world.geometries[geometry].material, point);
    switch (world.materials.list[material.value].kind) {
        case Material::Kind::interface: return true;
        case Material::Kind::dielectric:
        case Material::Kind::thin_dielectric:
            return make_bsdf(world.materials, world.spectra, material, point, Wavelengths::rgb(), 0).is_delta();
        default: return false;
    }
}

// The nearest surface that does not let light through.
bool meet_surface(const World& world, Ray ray, float t_max, SurfacePoint& point)
{
    for (int crossed = 0; crossed < 8; ++crossed) {
        Hit hit;
        if (!world.intersect(ray, t_max, hit)) return false;
        point = world.surface_point(ray, hit);
        if (!lets_light_through(world, hit.geometry, point)) return true;
        t_max -= hit.t;
        ray.origin = offset_ray_origin(point.position, point.error, point.n_geometric, ray.direction);
    }
    return false;
}

// A point of the unit disc with the density of the kernel.
Vec2 kernel_point(KernelKind kernel, RandomStream& random)
{
    for (;;) {
        const Vec2 point = sample_disk_concentric(random.next_2d());
        const float t = std::sqrt(sqr(point.x) + sqr(point.y));
        if (random.next() < detail::kernel_shape(kernel, t)) return point;
    }
}

// Whether short rays are longer than rounding errors, and not so long that their lengths have no squares.
bool can_look_around(const SurfaceRegion& region, float radius)
{
    return radius < 1e18f && radius > 5e-7f * region.inverse_flatness * max_component(abs(region.position));
}

// Looks at the neighbourhood of one query.
class Neighbourhood {
public:
    Neighbourhood(const World& world, const SurfaceRegion& region, float radius, float time)
        : world_(world),
          region_(region),
          time_(time),
          frame_(region.normal),
          radius_(radius),
          height_(radius / region.inverse_flatness),
          eye_(region.position + region.normal * height_)
    {
    }

    // Counts points of a spiral of `count` points, turned by `turn`.
    void count(int count, float turn, KernelKind kernel)
    {
        for (int i = 0; i < count; ++i) {
            const float t = std::sqrt((static_cast<float>(i) + 0.5f) / static_cast<float>(count));
            const float angle = turn + golden_angle * static_cast<float>(i);
            const float weight = kernel_disc(kernel, t);
            all_ += weight;
            const Vec3 offset = (frame_.s * std::cos(angle) + frame_.t * std::sin(angle)) * (t * radius_);
            SurfacePoint point;
            if (!meets_surface(region_.position + offset, point)) continue;
            if (region_.side != PhotonSide::both && !sees(point.position)) {
                hidden_ = true;
                continue;
            }
            // Just the point's own weight where the surface is nearly flat: then nothing more needs a look.
            const float area = kernel_area(point, t, kernel);
            covered_ += weight * (std::fabs(area - 1.0f) < flat_tolerance ? 1.0f : area);
        }
    }

    // Whether the way from above the query's point to above a point of the disc is free.
    bool sees(const Vec3& position) const
    {
        const Vec3 to = position + region_.normal * height_ - eye_;
        const float distance = length(to);
        if (!(distance > 1e-3f * height_)) return true;
        SurfacePoint point;
        return !meet_surface(world_, Ray{eye_, to * (1.0f / distance), time_}, distance, point);
    }

    // Whether something stands on the disc, as seen in a few directions along it.
    bool is_obstructed(float turn) const
    {
        for (int i = 0; i < looks_around; ++i) {
            const float angle = 2.0f * pi * (turn + static_cast<float>(i) / looks_around);
            SurfacePoint point;
            if (meet_surface(world_, Ray{eye_, frame_.s * std::cos(angle) + frame_.t * std::sin(angle), time_}, radius_,
                             point))
                return true;
        }
        return false;
    }

    // kernel_area (of what is seen, if asked for) at a point of the disc: 0 where photons cannot count; what curvature
    // adds beyond 1 is left out.
    float area_at(const Vec2& on_disc, KernelKind kernel, bool if_seen) const
    {
        const Vec3 offset = (frame_.s * on_disc.x + frame_.t * on_disc.y) * radius_;
        SurfacePoint point;
        if (!meets_surface(region_.position + offset, point)) return 0.0f;
        if (if_seen && !sees(point.position)) return 0.0f;
        return std::min(kernel_area(point, std::sqrt(sqr(on_disc.x) + sqr(on_disc.y)), kernel), 1.0f);
    }

    SurfaceCoverage coverage() const { return {std::max(covered_ / all_, least_share), hidden_}; }
    bool whole() const { return covered_ == all_; }

private:
    // The area [disc radius^2] of surface over a unit of area of the disc, `from_centre` [disc radius] away from its
    // centre, weighed by what the kernel gives to a photon there over what it gives to the point of the disc: 1 on a
    // plane; less on curved things, whose photons count as far as they are high (SurfaceRegion).
    float kernel_area(const SurfacePoint& point, float from_centre, KernelKind kernel) const
    {
        const float height = dot(point.position - region_.position, region_.normal) / radius_;
        const float t = std::sqrt(std::max(sqr(from_centre) + sqr(height), sqr(height * region_.inverse_flatness)));
        if (!(t < 1.0f)) return 0.0f;
        const float area = 1.0f / abs_dot(point.n_geometric, region_.normal);
        return area * detail::kernel_shape(kernel, t) / detail::kernel_shape(kernel, from_centre);
    }

    // Whether photons that count for the query could lie near a point of its tangent plane.
    bool meets_surface(const Vec3& p, SurfacePoint& point) const
    {
        const Ray down{p + region_.normal * height_, -region_.normal, time_};
        if (!meet_surface(world_, down, 2.0f * height_, point)) return false;
        return abs_dot(point.n_geometric, region_.normal) > region_.min_normal_cosine;
    }

    const World& world_;
    const SurfaceRegion& region_;
    const float time_;
    const Frame frame_;
    const float radius_;
    const float height_;
    const Vec3 eye_;
    float all_ = 0.0f;
    float covered_ = 0.0f;
    bool hidden_ = false;
};

Neighbourhood look_around(const World& world, const SurfaceRegion& region, float radius, KernelKind kernel, float time)
{
    // Turned by a number that belongs to the place: neighbours do not repeat one another's error.
    const uint64_t place =
        hash_words(float_bits(region.position.x), float_bits(region.position.y), float_bits(region.position.z));
    Neighbourhood neighbourhood(world, region, radius, time);
    const float turn = 2.0f * pi * to_unit_float(place);
    neighbourhood.count(first_points, turn, kernel);
    if (!neighbourhood.whole()) neighbourhood.count(further_points, turn + 1.0f, kernel);
    return neighbourhood;
}

}  // namespace

SurfaceCoverage surface_coverage(const World& world, const SurfaceRegion& region, float radius, KernelKind kernel,
                                 float time)
{
    return look_around(world, region, radius, kernel, time).coverage();
}

SampledCoverage sample_coverage(const World& world, const SurfaceRegion& region, float radius, KernelKind kernel,
                                float time, RandomStream& random)
{
    SampledCoverage coverage;
    if (!can_look_around(region, radius)) return coverage;
    const Neighbourhood neighbourhood(world, region, radius, time);
    coverage.obstructed = region.side != PhotonSide::both && neighbourhood.is_obstructed(random.next());
    for (int trial = 1; trial < most_trials; ++trial) {
        const float area = neighbourhood.area_at(kernel_point(kernel, random), kernel, coverage.obstructed);
        if (random.next() < area) break;
        coverage.inverse += 1.0f;
    }
    return coverage;
}

bool sees_along_surface(const World& world, const SurfaceRegion& region, float radius, const Vec3& photon, float time)
{
    return Neighbourhood(world, region, radius, time).sees(photon);
}

EstimateSupport find_covered_photons(const World& world, const PhotonMap& map, const SurfaceRegion& region,
                                     const Bandwidth& bandwidth, NearestPoints& nearest,
                                     std::vector<WeightedPhoton>& found, float time, bool caustics_alone)
{
    found.clear();
    EstimateSupport support = visit_photons(map, region, bandwidth, nearest, [&](uint32_t slot, float weight) {
        if (!caustics_alone || map.path_class(slot) == static_cast<uint8_t>(PathClass::caustic))
            found.push_back({slot, weight});
    });
    if (found.empty() || !can_look_around(region, support.radius)) return support;
    const Neighbourhood neighbourhood = look_around(world, region, support.radius, bandwidth.kernel, time);
    const SurfaceCoverage coverage = neighbourhood.coverage();
    if (coverage.something_hidden)
        std::erase_if(found, [&](const WeightedPhoton& p) { return !neighbourhood.sees(map.position(p.first)); });
    if (coverage.share != 1.0f)
        for (WeightedPhoton& photon : found) photon.second /= coverage.share;
    return support;
}

}  // namespace dapple
