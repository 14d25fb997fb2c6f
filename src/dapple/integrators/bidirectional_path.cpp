#include "dapple/integrators/bidirectional_path.h"

#include "dapple/cameras/raster_copies.h"

namespace dapple {
namespace {

void count(PathEvents& events, bool on_surface) { on_surface ? events.add_surface(false) : events.add_medium(); }

// Whether the technique that joins a light vertex to the one before it takes part.
template <class LightEnd>
bool joins_before(const MisRules& rules, const LightEnd& light)
{
    return light.depth == 1 ? rules.direct : rules.inner;
}

// What an end of a joined edge does to light along it: as Scattering (connect.h), and the density of the way back.
struct End {
    Spectrum value;
    float pdf = 0.0f;
    float back = 0.0f;
};

End surface_end(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi, TransportMode mode)
{
    const BsdfBothWays scattered = evaluate_both_ways(bsdf, wo, wi, mode);
    return {scattered.f * abs_dot(wi, bsdf.frame.n), scattered.pdf, scattered.pdf_reverse};
}

End medium_end(float g, const Vec3& wo, const Vec3& wi)
{
    const float p = evaluate_phase(g, wo, wi);
    return {Spectrum(p), p, evaluate_phase(g, wi, wo)};
}

End eye_end(const Vertex& vertex, const Vec3& wi)
{
    return vertex.on_surface ? surface_end(vertex.bsdf, vertex.wo, wi, TransportMode::radiance)
                             : medium_end(vertex.phase_g, vertex.wo, wi);
}

// scratch: a diffuse Bsdf to be filled in, where that is all that is known of the vertex.
End light_end(const LightVertex& vertex, const LightSubpaths::Path& path, const Vec3& wi, Bsdf& scratch)
{
    if (vertex.bsdf == LightVertex::medium) return medium_end(vertex.reflectance[0], vertex.wo, wi);
    if (vertex.bsdf != LightVertex::diffuse)
        return surface_end(path.bsdf_of(vertex), vertex.wo, wi, TransportMode::importance);
    scratch.frame.n = vertex.n_shading;
    scratch.n_geometric = vertex.n_geometric;
    scratch.a = vertex.reflectance;
    return surface_end(scratch, vertex.wo, wi, TransportMode::importance);
}

// Where a ray to a light vertex ends.
Vec3 arrive_at(const LightVertex& vertex, const Vec3& from_there)
{
    if (!vertex.on_surface()) return vertex.position;
    return offset_ray_origin(vertex.position, abs(vertex.n_geometric) * vertex.offset, vertex.n_geometric, from_there);
}

// Joins that would bring less than this share of what the path has found so far are left to chance.
constexpr float worth_a_ray = 0.05f;

}  // namespace

void splat_light_vertex(const PassContext& context, Film& film, const BidirectionalPlan& plan,
                        const LightSubpaths& subpaths, int64_t path, const LightArrival& light)
{
    if (light.depth > plan.max_depth) return;
    const MisRules& rules = plan.rules;
    const World& world = context.world;
    const Vertex& vertex = light.vertex;
    const Vec2 filter_radius = film.settings().filter.radius();
    const float margin = std::max(filter_radius.x, filter_radius.y);
    const float scale = 1.0f / static_cast<float>(subpaths.paths());
    const uint64_t purpose = static_cast<uint64_t>(StreamPurpose::splat);
    RandomStream random(context.seed, hash_words(purpose, uint64_t(context.pass), uint64_t(light.depth)),
                        static_cast<uint32_t>(path));
    SeenByCamera seen;
    if (!connect_to_camera(world, light.carried, vertex, margin, random, seen)) return;
    const double to_here =
        double(seen.camera.importance) * geometric_cosine(vertex, seen.camera.wi) / rules.light_paths;
    const double back = reverse_pdf(vertex, seen.camera.wi, TransportMode::importance);
    const double others = side_sum(rules, light.weights, to_here, back, light.eta, joins_before(rules, light));
    const float weight = static_cast<float>(1.0 / (1.0 + others));
    PathEvents events = light.events;
    count(events, vertex.on_surface);
    const Vec3 rgb = film.settings().sensor.to_rgb(seen.contribution * scale, light.carried.start.wavelengths);
    for (const Vec2& raster : raster_copies(world.camera, seen.camera.raster, margin)) {
        film.splat(raster, rgb * weight, classify({}, events), light.light_group);
        if (plan.techniques) plan.techniques->splat(raster, rgb, weight, {light.depth + 1, 1});
    }
}

BidirectionalEyePath::BidirectionalEyePath(const BidirectionalPlan& plan, const World& world,
                                           const LightSubpaths& subpaths, EyeSample& sample)
    : plan_(plan),
      rules_(plan.rules),
      world_(world),
      subpaths_(subpaths),
      sample_(sample),
      path_(subpaths.path_of(sample.pixel)),
      set_(subpaths.set_of(path_)),
      start_(subpaths.start(path_))
{
    diffuse_light_end_.kind = BsdfKind::diffuse;
    if (plan.techniques) record_.emplace(*plan.techniques, sample.pixel);
}

void BidirectionalEyePath::add(const Spectrum& estimate, double weight, PathClass path_class, LightGroup group,
                               const Technique& technique)
{
    found_ += estimate.max() * static_cast<float>(weight);
    const Vec3 rgb = sample_.filtered(estimate);
    sample_.sums.add(rgb * static_cast<float>(weight), path_class, group);
    if (record_) record_->add(rgb, static_cast<float>(weight), technique);
}

void BidirectionalEyePath::trace()
{
    eye_ = start_at_camera(world_, sample_.raster, start_, sample_.random);
    eye_.keep_reverse_density();
    GuideRecorder guides(world_, sample_);
    while (const Vertex* vertex = eye_.next(world_, sample_.random)) {
        if (plan_.first_vertex_only && eye_.events().diffuse > 0) return;
        guides.see(*vertex);
        if (!eye_.medium_emission().is_black()) add_medium_emission();
        if (!arrive()) return;
        add_emission();
        if (eye_.depth() > plan_.max_depth) return;
        if (!vertex->is_delta()) {
            carried_ = eye_.carried();
            if (rules_.direct) join_light();
            if (plan_.merging) merge();
            if (rules_.inner) join_all();
        }
        if (plan_.first_vertex_only && !vertex->has_delta_lobe()) return;
        if (eye_.depth() > 1 && !eye_.survive_roulette(sample_.random, expected_albedo(*vertex))) return;
    }
    if (plan_.first_vertex_only && eye_.events().diffuse > 0) return;
    if (!eye_.medium_emission().is_black()) add_medium_emission();
    if (eye_.escaped()) add_environment();
}

// Found by eye paths alone.
void BidirectionalEyePath::add_medium_emission()
{
    add(eye_.medium_emission(), 1.0, PathClass::volume, LightGroup(0u), {0, eye_.depth() + (eye_.escaped() ? 2 : 1)});
}

PathEvents BidirectionalEyePath::events_at_vertex() const
{
    PathEvents events = eye_.events();
    count(events, eye_.vertex().on_surface);
    return events;
}

SubpathStep BidirectionalEyePath::step(int depth_before) const
{
    return {eye_.pdf_direction(), eye_.pdf_reverse(), eye_.cosine_out(), eta_,
            depth_before == 1 ? rules_.camera : rules_.inner};
}

// Updates the weights for the vertex just met.
bool BidirectionalEyePath::arrive()
{
    const Vertex& vertex = eye_.vertex();
    const float cosine_in = geometric_cosine(vertex, vertex.wo);
    if (!(cosine_in > 0.0f)) return false;
    if (eye_.depth() == 1)
        weights_ = first_eye_weights(
            rules_, importance_at(world_.camera, vertex.at.position, vertex.distance, start_.time), cosine_in);
    else
        weights_ = advance(rules_, weights_, step(eye_.depth() - 1), sqr(double(vertex.distance)), cosine_in);
    radius_ = subpaths_.radius_at(vertex);
    eta_ = subpaths_.eta(set_, radius_);
    return true;
}

// s = 0. direct: density of light sampling, emission: of a light path that starts along the last ray reversed; both
// per area of the light where it has one.
double BidirectionalEyePath::met_weight(const SubpathWeights& weights, double direct, double emission) const
{
    if (!rules_.emission) return 1.0;
    const double others = (rules_.direct ? rules_.m(direct) * weights.d_vcm : 0.0) + rules_.m(emission) * weights.d_vc;
    return 1.0 / (1.0 + others);
}

void BidirectionalEyePath::add_emission()
{
    const Vertex& vertex = eye_.vertex();
    const LightId id = vertex.emitter;
    if (!id.valid()) return;
    const Spectrum radiance = met_emission(world_, eye_, false);
    if (radiance.is_black()) return;
    double weight = 1.0;
    if (eye_.depth() > 1) {
        const Vec3& n = vertex.at.n_geometric;
        const EmissionDensity emission =
            emission_density(world_.lights, id, start_.time, vertex.at.position, n, vertex.wo);
        const double direct =
            direct_pdf_area(world_.lights, id, eye_.previous_position(), -vertex.wo, vertex.at.position, n) *
            double(abs_dot(n, vertex.wo)) / sqr(double(vertex.distance));
        const double probability = world_.light_probability(id);
        weight =
            met_weight(weights_, probability * direct, probability * emission.position * double(emission.direction));
    }
    add(radiance, weight, classify(eye_.events(), {}), world_.lights.list[id.value].group, {0, eye_.depth() + 1});
}

void BidirectionalEyePath::add_environment()
{
    const SubpathWeights weights =
        eye_.depth() > 0 ? advance(rules_, weights_, step(eye_.depth()), 1.0, 1.0) : SubpathWeights{};
    const Vec3& towards = eye_.ray().direction;
    for (LightId id : world_.environments) {
        const double probability = world_.light_probability(id);
        const EmissionDensity emission =
            emission_density(world_.lights, id, start_.time, Vec3(0.0f), Vec3(0.0f), -towards);
        const double direct = direct_pdf_environment(world_.lights, id, towards);
        const double weight =
            met_weight(weights, probability * direct, probability * emission.position * double(emission.direction));
        add(met_environment(world_, eye_, id, false), weight, classify(eye_.events(), {}),
            world_.lights.list[id.value].group, {0, eye_.depth() + 2});
    }
}

bool BidirectionalEyePath::joins_before() const { return eye_.depth() == 1 ? rules_.camera : rules_.inner; }

// s = 1.
void BidirectionalEyePath::join_light()
{
    const Vertex& vertex = eye_.vertex();
    LightConnection c;
    if (!connect_to_light(world_, carried_, vertex, sample_.random, c)) return;
    const float density = c.density(eye_.path_pdf()).average();
    if (!(density > 0.0f)) return;
    const Light& light = world_.lights.list[c.light.value];
    const DirectSample& sample = c.sample;
    float direct_pdf = sample.pdf, cosine_light = 1.0f;
    if (light.kind == Light::Kind::area) {
        cosine_light = abs_dot(sample.normal, sample.wi);
        if (sample.delta)  // cannot be met, and yet is sampled by its shape
            direct_pdf =
                direct_pdf_area(world_.lights, c.light, vertex.at.position, sample.wi, sample.position, sample.normal);
    }
    const EmissionDensity emission =
        emission_density(world_.lights, c.light, start_.time, sample.position, sample.normal, -sample.wi);
    const double to_here = emission_over_direct(light, emission, direct_pdf, cosine_light,
                                                geometric_cosine(vertex, sample.wi), sqr(sample.distance));
    const double back = reverse_pdf(vertex, sample.wi, TransportMode::radiance);
    const double met =
        rules_.emission && can_be_met(light) ? rules_.m(c.scattering.pdf / (double(c.probability) * direct_pdf)) : 0.0;
    const double others = met + side_sum(rules_, weights_, to_here, back, eta_, joins_before());
    add(c.value * (1.0f / density), 1.0 / (1.0 + others), classify(events_at_vertex(), {}), light.group,
        {1, eye_.depth() + 1});
}

// s, t >= 2.
void BidirectionalEyePath::join_all()
{
    const LightSubpaths::Path path = subpaths_.path(path_);
    // Apart from the numbers of the eye path, so that these stay as evenly spread as they are.
    RandomStream chances = stream_of_trials(sample_.random, eye_.depth());
    chances.skip(1u << 15);
    for (const LightVertex& light : path.vertices) join(path, light, chances);
}

void BidirectionalEyePath::join(const LightSubpaths::Path& path, const LightVertex& light, RandomStream& chances)
{
    if (eye_.depth() + light.depth > plan_.max_depth) return;
    const Vertex& z = eye_.vertex();
    const Vec3 towards = light.position - z.at.position;
    const float distance2 = length_squared(towards);
    if (!(distance2 > 0.0f)) return;
    const Vec3 w = towards * (1.0f / std::sqrt(distance2));
    // What turns its back is the commonest case and known from two cosines.
    if (light.bsdf == LightVertex::diffuse && dot(w, light.n_shading) * dot(light.wo, light.n_shading) >= 0.0f) return;
    const End at_eye = eye_end(z, w);
    if (at_eye.value.is_black()) return;
    const End at_light = light_end(light, path, -w, diffuse_light_end_);
    Spectrum value = carried_.throughput * at_eye.value * at_light.value * light.throughput * (1.0f / distance2);
    if (value.is_black()) return;

    const double to_light = double(at_eye.pdf) * geometric_cosine(light, w) / distance2;
    const double to_eye = double(at_light.pdf) * geometric_cosine(z, w) / distance2;
    const double others =
        side_sum(rules_, light.weights(), to_light, at_light.back, light.eta, dapple::joins_before(rules_, light)) +
        side_sum(rules_, weights_, to_eye, at_eye.back, eta_, joins_before());
    const double weight = 1.0 / (1.0 + others);
    const Spectrum path_pdf = carried_.path_pdf * light.path_pdf;
    if (!record_) {
        const float worth = value.max() * static_cast<float>(weight) / path_pdf.average();
        const float probability = std::max(worth / (worth_a_ray * found_), 0x1p-20f);
        if (probability < 1.0f) {
            if (!(chances.next() < probability)) return;
            value *= 1.0f / probability;
        }
    }
    const Transmittance through = between(world_, z, arrive_at(light, -w), start_, sample_.random);
    if (through.blocked()) return;
    const float density = (path_pdf * through.light_pdf).average();
    if (!(density > 0.0f)) return;
    PathEvents light_events = light.events;
    count(light_events, light.on_surface());
    add(value * through.value * (1.0f / density), weight, classify(events_at_vertex(), light_events), light.light_group,
        {light.depth + 1, eye_.depth() + 1});
}

void BidirectionalEyePath::merge()
{
    if (!(radius_ > 0.0f)) return;
    const Vertex& vertex = eye_.vertex();
    const float radius = radius_;
    const double paths = static_cast<double>(subpaths_.paths_in_set(set_));
    const double eta = pi * double(radius) * radius * paths;
    const PathEvents events = events_at_vertex();
    const float scale = static_cast<float>(1.0 / (double(radius) * radius * paths));
    const SurfaceRegion region = surface_region(vertex.at.position, vertex.bsdf, vertex.wo);
    int found = 0;
    std::optional<SampledCoverage> coverage;  // asked for with the first photon
    subpaths_.for_each_near(set_, region, radius, [&](const MergePhoton& photon, const Vec3& at, float distance2) {
        ++found;
        if (eye_.depth() + photon.depth - 1 > plan_.max_depth) return;
        const Vec3& wi = photon.direction;
        const auto [f, to_light, back] = evaluate_both_ways(vertex.bsdf, vertex.wo, wi, TransportMode::radiance);
        if (f.is_black()) return;
        const float density = (carried_.path_pdf * photon.path_pdf).average();
        if (!(density > 0.0f)) return;
        const double others =
            merged_side_sum(rules_, photon.weights(), to_light, eta, dapple::joins_before(rules_, photon)) +
            merged_side_sum(rules_, weights_, back, eta, joins_before());
        if (!coverage) {
            RandomStream trials = stream_of_trials(sample_.random, eye_.depth());
            coverage = sample_coverage(world_, region, radius, plan_.kernel, start_.time, trials);
        }
        if (coverage->obstructed && !sees_along_surface(world_, region, radius, at, start_.time)) return;
        const float kernel = kernel_disc(plan_.kernel, std::sqrt(distance2) / radius) * scale * coverage->inverse;
        add(carried_.throughput * f * photon.throughput * (kernel * shading_per_area(vertex.bsdf, wi) / density),
            1.0 / (1.0 + others), classify(events, photon.events), LightGroup(photon.light_group),
            {photon.depth + 1, eye_.depth() + 1, true});
    });
    if (sample_.sums.radius == 0.0f) {
        sample_.sums.radius = radius;
        sample_.sums.photon_density = static_cast<float>(found) / (pi * radius * radius);
    }
}

}  // namespace dapple
