#include "dapple/transport/walk.h"

#include "dapple/transport/medium_crossing.h"

namespace dapple {

bool Vertex::has_delta_lobe() const
{
    if (is_delta()) return true;
    const bool coated = bsdf.kind == BsdfKind::coated_diffuse || bsdf.kind == BsdfKind::coated_conductor;
    return on_surface && coated && (bsdf.eta == 1.0f || bsdf.roughness.smooth());
}

Walk::Walk(const Ray& ray, MediumId medium, TransportMode mode, const Wavelengths& wavelengths, int kept_lane,
           const Spectrum& source)
    : ray_(ray),
      source_(source),
      wavelengths_(wavelengths),
      previous_position_(ray.origin),
      medium_(medium),
      kept_lane_(kept_lane),
      mode_(mode)
{
}

namespace {

// The point of the lens that a path starts from; a pinhole has no use for the numbers.
Vec2 choose_lens_point(const Camera& camera, RandomStream& random)
{
    if (camera.lens_radius > 0.0f) return random.next_2d();
    random.skip(2);
    return Vec2(0.5f);
}

Walk start_at_lens(const World& world, const Vec2& raster, const Vec2& u_lens, const PathStart& start)
{
    const CameraRay camera_ray = generate_ray(world.camera, raster, u_lens, start.time);
    return Walk(camera_ray.ray, world.camera_medium, TransportMode::radiance, start.wavelengths, start.kept_lane,
                Spectrum(camera_ray.weight));
}

}  // namespace

Walk start_at_camera(const World& world, const Vec2& raster, const PathStart& start, RandomStream& random)
{
    return start_at_lens(world, raster, choose_lens_point(world.camera, random), start);
}

Walk start_at_camera(const World& world, const Vec2& raster, const Wavelengths& wavelengths, RandomStream& random)
{
    const Vec2 u_lens = choose_lens_point(world.camera, random);
    return start_at_lens(world, raster, u_lens, path_start(wavelengths, random.next_2d()));
}

bool Walk::leave(const World& world, RandomStream& random)
{
    medium_emission_ = Spectrum(0.0f);
    if (at_vertex_ && !scatter(world, random)) return false;
    at_vertex_ = false;
    return true;
}

bool Walk::scatter(const World& world, RandomStream& random)
{
    float u_lobe = 0.0f;
    if (vertex_.on_surface && vertex_.bsdf.chooses_lobe())
        u_lobe = random.next();
    else
        random.skip(1);  // no one looks at it
    const Vec2 u = random.next_2d();
    previous_position_ = vertex_.at.position;
    if (!vertex_.on_surface) {
        Vec3 wi;
        pdf_direction_ = sample_phase(vertex_.phase_g, vertex_.wo, u, wi);
        pdf_reverse_ = pdf_direction_;
        cosine_out_ = 1.0f;
        events_.add_medium();
        ray_ = Ray{vertex_.at.position, wi, ray_.time};
    } else {
        BsdfSample sample;
        if (!sample_bsdf(vertex_.bsdf, vertex_.wo, u_lobe, u, mode_, sample)) return false;
        throughput_ *= sample.weight;
        if (throughput_.is_black() || !throughput_.is_finite()) return false;
        pdf_direction_ = sample.pdf;
        if (keeps_reverse_) {
            pdf_reverse_ = sample.delta ? 0.0f : pdf(vertex_.bsdf, sample.wi, vertex_.wo, mode_);
            cosine_out_ = abs_dot(sample.wi, vertex_.at.n_geometric);
        }
        if (sample.transmission && mode_ == TransportMode::radiance) eta_scale_ *= sqr(sample.eta);
        events_.add_surface(sample.delta);
        ray_ = Ray{offset_ray_origin(vertex_.at.position, vertex_.at.error, vertex_.at.n_geometric, sample.wi),
                   sample.wi, ray_.time};
        medium_ = world.medium_beyond(vertex_.geometry, dot(sample.wi, vertex_.at.n_geometric) > 0.0f, medium_);
    }
    light_pdf_ = pdf_direction_ > 0.0f ? path_pdf_ * (1.0f / pdf_direction_) : Spectrum(0.0f);
    return true;
}

const Vertex* Walk::arrive(const World& world, RandomStream& random)
{
    float travelled = 0.0f;
    for (;;) {
        Hit hit;
        const bool met = world.intersect(ray_, infinity, hit);
        if (medium_.valid() && scatters_in_medium(world, met ? hit.t : infinity, random)) {
            vertex_.distance = travelled + length(vertex_.at.position - ray_.origin);
            ++depth_;
            at_vertex_ = true;
            return &vertex_;
        }
        if (throughput_.is_black()) return nullptr;
        if (!met) {
            escaped_ = true;
            return nullptr;
        }
        travelled += hit.t;
        world.surface_point(ray_, hit, vertex_.at);
        const Geometry& geometry = world.geometries[hit.geometry];
        const MaterialId material = resolve_mix(world.materials, geometry.material, vertex_.at);
        vertex_.wo = -ray_.direction;
        if (world.materials.list[material.value].kind == Material::Kind::interface) {
            medium_ = world.medium_beyond(hit.geometry, dot(ray_.direction, vertex_.at.n_geometric) > 0.0f, medium_);
            ray_.origin =
                offset_ray_origin(vertex_.at.position, vertex_.at.error, vertex_.at.n_geometric, ray_.direction);
            continue;
        }
        vertex_.on_surface = true;
        make_bsdf(world.materials, world.spectra, material, vertex_.at, wavelengths_, kept_lane_, vertex_.bsdf);
        vertex_.geometry = hit.geometry;
        vertex_.emitter = world.emitter(hit);
        vertex_.medium = medium_;
        vertex_.distance = travelled;
        if (vertex_.bsdf.dispersive) keep_only_lane();
        ++depth_;
        at_vertex_ = true;
        return &vertex_;
    }
}

bool Walk::scatters_in_medium(const World& world, float t_max, RandomStream& random)
{
    const MediumEvent event = cross_medium(world, medium_, ray_, t_max, wavelengths_, kept_lane_, path_pdf_, random);
    if (!event.emission.is_black()) medium_emission_ += source_ * throughput_ * event.emission;
    throughput_ *= event.throughput;
    path_pdf_ *= event.path_pdf;
    light_pdf_ *= event.light_pdf;
    if (event.kind != MediumEvent::Kind::scatter) return false;
    vertex_.on_surface = false;
    vertex_.at = SurfacePoint{};
    vertex_.at.position = ray_.at(event.t);
    vertex_.at.time = ray_.time;
    vertex_.wo = -ray_.direction;
    vertex_.phase_g = world.media.list[medium_.value].g;
    vertex_.medium = medium_;
    vertex_.emitter = LightId();
    return true;
}

void Walk::keep_only_lane()
{
    if (single_lane_) return;
    single_lane_ = true;
    // The other lanes could not have gone this way: their densities are zero, and all means are of the kept lane alone.
    for (Spectrum* lanes : {&throughput_, &path_pdf_, &light_pdf_}) {
        Spectrum kept;
        kept[kept_lane_] = (*lanes)[kept_lane_] * Spectrum::lanes;
        *lanes = kept;
    }
}

bool Walk::survive_roulette(RandomStream& random, const Spectrum& coming)
{
    const Spectrum left = throughput_ * coming;
    const float largest = single_lane_ ? left[kept_lane_] / Spectrum::lanes : left.max();
    const float survival = std::min(1.0f, largest * eta_scale_ / path_pdf_.average());
    if (survival >= 1.0f) return true;
    if (random.next() >= survival) return false;
    throughput_ /= survival;
    return true;
}

}  // namespace dapple
