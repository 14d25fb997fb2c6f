#include "dapple/integrators/light_subpaths.h"

#include "dapple/integrators/wavelength_sets.h"
#include "dapple/transport/emission.h"
#include "dapple/transport/photon_tracing.h"

#include <atomic>

namespace dapple {

MergeRadius MergeRadius::footprints(const Camera& camera, float count)
{
    MergeRadius radius;
    radius.center_ = camera.world_from_camera.at(0.5f).point(Vec3(0.0f));
    if (camera.kind == Camera::Kind::orthographic)
        radius.base_ = count * pixel_footprint(camera, 1.0f);
    else
        radius.slope_ = count * pixel_footprint(camera, 1.0f);
    return radius;
}

MergeRadius MergeRadius::fixed(float r)
{
    MergeRadius radius;
    radius.base_ = r;
    return radius;
}

MergeRadius MergeRadius::operator*(float factor) const
{
    MergeRadius radius = *this;
    radius.base_ *= factor;
    radius.slope_ *= factor;
    return radius;
}

double emission_over_direct(const Light& light, const EmissionDensity& emission, float direct_pdf, float cosine_light,
                            float cosine_in, float distance2)
{
    const double leaving = double(emission.position) * emission.direction * cosine_in;
    switch (light.kind) {
        case Light::Kind::area: return leaving / (double(direct_pdf) * cosine_light);
        case Light::Kind::environment:
        case Light::Kind::environment_image:
        case Light::Kind::distant: return leaving / direct_pdf;
        default: return leaving / distance2;
    }
}

namespace {

// The weights at the first vertex of a light path.
SubpathWeights departure_weights(const World& world, const MisRules& rules, const Departure& departure,
                                 const Walk& walk)
{
    const Vertex& vertex = walk.vertex();
    const EmissionSample& sample = departure.sample;
    const Light& light = world.lights.list[departure.light.value];
    const Vec3& to_light = vertex.wo;
    const float cosine_in = geometric_cosine(vertex, to_light);
    float cosine_light = 1.0f, direct_pdf = 1.0f;
    if (light.kind == Light::Kind::area) {
        cosine_light = abs_dot(sample.normal, to_light);
        direct_pdf = direct_pdf_area(world.lights, departure.light, vertex.at.position, to_light, sample.ray.origin,
                                     sample.normal);
    } else if (can_be_met(light)) {
        direct_pdf = direct_pdf_environment(world.lights, departure.light, to_light);
    }
    const EmissionDensity emission{sample.pdf_position, sample.pdf_direction};
    const double direct_over_emission =
        direct_pdf > 0.0f
            ? 1.0 / emission_over_direct(light, emission, direct_pdf, cosine_light, cosine_in, sqr(vertex.distance))
            : 0.0;
    const double leaving = double(departure.probability) * sample.pdf_position * sample.pdf_direction * cosine_in;
    return first_light_weights(rules, direct_over_emission, cosine_light / leaving, can_be_met(light));
}

}  // namespace

LightSubpaths::LightSubpaths(const PassContext& context, ColorModel model, Int2 resolution,
                             const LightSubpathPlan& plan, const Visitor& visit)
    : plan_(plan), model_(model), resolution_(resolution), seed_(context.seed), pass_(context.pass)
{
    const uint64_t purpose = static_cast<uint64_t>(StreamPurpose::wavelength_set);
    const uint32_t turn = static_cast<uint32_t>(hash_words(purpose, seed_, uint64_t(pass_)));
    const int sets = plan_.wavelength_sets;
    for (int set = 0; set < sets; ++set)
        set_starts_.push_back({wavelengths_of_set(model, seed_, pass_, set, sets), time_of_set(seed_, pass_, set, sets),
                               static_cast<int>((turn + static_cast<uint32_t>(set)) % Spectrum::lanes)});
    if (sets > 1) {
        set_of_path_.resize(static_cast<size_t>(plan_.paths));
        parallel_for(plan_.paths, 4096, [&](int64_t path) {
            const Int2 pixel(static_cast<int>(path % resolution_.x), static_cast<int>(path / resolution_.x));
            set_of_path_[static_cast<size_t>(path)] =
                static_cast<uint32_t>(set_of_pixel(pixel, pass_, static_cast<size_t>(sets)));
        });
    }
    if (plan_.merging) {
        maps_.resize(set_starts_.size());
        for (int64_t path = 0; path < plan_.paths; ++path) ++maps_[set_of(path)].paths;
    }

    chunks_.resize(plan_.stored ? static_cast<size_t>((plan_.paths + chunk_paths - 1) / chunk_paths) : 0);
    std::atomic<uint64_t> stored{0};
    parallel_for_ranges(plan_.paths, chunk_paths, [&](int64_t begin, int64_t end) {
        if (context.cancelled()) return;
        Chunk traced;
        if (plan_.stored) traced.vertices.reserve(4 * static_cast<size_t>(end - begin));
        for (int64_t path = begin; path < end; ++path) {
            trace(context.world, path, [&](const LightArrival& arrival) {
                visit(*this, path, arrival);
                if (plan_.stored) store(arrival, traced);
            });
            if (plan_.stored) traced.end.push_back(static_cast<uint32_t>(traced.vertices.size()));
        }
        if (!plan_.stored) return;
        stored += traced.vertices.size();
        traced.vertices.shrink_to_fit();
        traced.bsdfs.shrink_to_fit();
        chunks_[static_cast<size_t>(begin / chunk_paths)] = std::move(traced);
    });
    context.statistics.light_paths += static_cast<uint64_t>(plan_.paths);
    if (plan_.merging) context.statistics.photons_stored += stored.load();
    if (plan_.merging && !context.cancelled()) build_maps();
}

size_t LightSubpaths::memory_bytes() const
{
    size_t bytes = set_of_path_.size() * sizeof(uint32_t);
    for (const Chunk& chunk : chunks_)
        bytes += chunk.vertices.size() * sizeof(LightVertex) + chunk.bsdfs.size() * sizeof(Bsdf) +
                 chunk.end.size() * sizeof(uint32_t);
    size_t all = 0, most = 0;
    for (const Map& map : maps_) {
        bytes += map.photons.size() * sizeof(MergePhoton) + map.tree.memory_bytes();
        all += map.photons.size();
        most = std::max(most, map.photons.size());
    }
    // build_maps: the members of all sets, with room to grow, and one set at a time its positions, its order and two
    // buffers of 16 bytes that the tree sorts in.
    return bytes + all * 2 * sizeof(void*) + most * (sizeof(Vec3) + sizeof(uint32_t) + 32);
}

PathStart LightSubpaths::start(int64_t path) const
{
    if (!set_starts_.empty()) return set_starts_[set_of(path)];
    // Even in the pass: the wavelengths of a pixel are spread over the spectrum.
    RandomStream random(seed_, hash_words(static_cast<uint64_t>(StreamPurpose::light_subpath), uint64_t(path), 0),
                        pass_);
    const Vec2 u = random.next_2d();
    return path_start(choose_wavelengths(model_, random.next()), u);
}

template <class Arrive>
void LightSubpaths::trace(const World& world, int64_t path, Arrive&& arrive) const
{
    // The paths of all passes are one sequence: they spread evenly together.
    RandomStream random = light_path_stream(seed_, hash_words(static_cast<uint64_t>(StreamPurpose::light_subpath), 1),
                                            path + plan_.paths * int64_t(pass_));
    Walk walk;
    Departure departure;
    if (!emit(world, start(path), random, walk, departure)) return;
    walk.keep_reverse_density();
    const size_t set = set_of(path);
    SubpathWeights weights;
    double eta_here = 0.0;
    while (const Vertex* vertex = walk.next(world, random)) {
        const float cosine_in = geometric_cosine(*vertex, vertex->wo);
        if (!(cosine_in > 0.0f)) return;
        if (walk.depth() == 1) {
            weights = departure_weights(world, plan_.rules, departure, walk);
        } else {
            const SubpathStep step{walk.pdf_direction(), walk.pdf_reverse(), walk.cosine_out(), eta_here,
                                   walk.depth() == 2 ? plan_.rules.direct : plan_.rules.inner};
            weights = advance(plan_.rules, weights, step, sqr(double(vertex->distance)), cosine_in);
        }
        eta_here = eta(set, radius_at(*vertex));
        if (!vertex->is_delta())
            arrive(LightArrival{*vertex, walk.carried(), weights, eta_here, walk.events(), walk.light_group,
                                walk.depth()});
        if (walk.depth() >= plan_.max_depth || !walk.survive_roulette(random, expected_albedo(*vertex))) return;
    }
}

void LightSubpaths::store(const LightArrival& arrival, Chunk& chunk)
{
    const Vertex& vertex = arrival.vertex;
    const Bsdf& bsdf = vertex.bsdf;
    LightVertex& v = chunk.vertices.emplace_back();
    v.throughput = arrival.carried.throughput;
    v.path_pdf = arrival.carried.path_pdf;
    v.position = vertex.at.position;
    v.wo = vertex.wo;
    // Beyond the range of float nothing is left for the technique at hand either way (balance heuristic; the power
    // heuristic gets there with distances of 1e9 m, where its weights may then sum to more than one).
    constexpr double most = 1e37;
    v.d_vcm = static_cast<float>(std::min(arrival.weights.d_vcm, most));
    v.d_vc = static_cast<float>(std::min(arrival.weights.d_vc, most));
    v.eta = static_cast<float>(arrival.eta);
    v.light_group = arrival.light_group;
    v.events = arrival.events;
    v.depth = static_cast<uint16_t>(arrival.depth);
    if (!vertex.on_surface) {
        v.bsdf = LightVertex::medium;
        v.reflectance = Spectrum(vertex.phase_g);
        return;
    }
    v.n_geometric = vertex.at.n_geometric;
    v.n_shading = bsdf.frame.n;
    v.offset = dot(abs(vertex.at.n_geometric), vertex.at.error);
    if (bsdf.kind == BsdfKind::diffuse) {
        v.bsdf = LightVertex::diffuse;
        v.reflectance = bsdf.a;
    } else {
        v.bsdf = static_cast<uint32_t>(chunk.bsdfs.size());
        chunk.bsdfs.push_back(bsdf);
    }
}

void LightSubpaths::build_maps()
{
    std::vector<std::vector<const LightVertex*>> members(maps_.size());
    for (int64_t i = 0; i < plan_.paths; ++i) {
        std::vector<const LightVertex*>& of_set = members[set_of(i)];
        for (const LightVertex& v : path(i).vertices)
            if (v.on_surface()) of_set.push_back(&v);
    }
    for (size_t set = 0; set < maps_.size(); ++set) {
        Map& map = maps_[set];
        const std::vector<const LightVertex*>& of_set = members[set];
        std::vector<Vec3> positions(of_set.size());
        parallel_for(static_cast<int64_t>(of_set.size()), 4096,
                     [&](int64_t i) { positions[static_cast<size_t>(i)] = of_set[static_cast<size_t>(i)]->position; });
        std::vector<uint32_t> order;
        map.tree = PointTree(positions, order);
        map.photons.resize(order.size());
        parallel_for(static_cast<int64_t>(order.size()), 4096, [&](int64_t slot) {
            const LightVertex& v = *of_set[order[static_cast<size_t>(slot)]];
            const Vec3 normal = face_forward(v.n_geometric, v.wo);
            map.photons[static_cast<size_t>(slot)] = {v.throughput,
                                                      v.path_pdf,
                                                      v.wo,
                                                      v.d_vcm,
                                                      v.d_vc,
                                                      v.events,
                                                      v.depth,
                                                      static_cast<uint16_t>(pack_unit<8>(normal)),
                                                      static_cast<uint16_t>(v.light_group.value)};
        });
    }
}

}  // namespace dapple
