#include "dapple/integrators/cache_overture.h"

#include <limits>
#include <optional>

namespace dapple {
namespace {

constexpr float min_radius_pixels = 2.0f;
constexpr float max_radius_pixels = 20.0f;
constexpr int first_stride = 32, least_stride = 2;

// Where a record may be made.
struct Place {
    Vec3 position, error, n_geometric, normal;
    float time = 0.0f;
    float eye_distance = 0.0f;
    MediumId medium;
    uint32_t geometry = 0;
    Int2 pixel;
};

struct NewRecord {
    CacheRecord record;
    std::vector<HemisphereIrradiance> values;
};

// Sums radiance whatever its class: all that comes to it is indirect light.
struct RadianceSum {
    Spectrum sum;
    void add(const Spectrum& radiance, PathClass, LightGroup) { sum += radiance; }
};

class Overture {
public:
    Overture(const PassContext& context, const Film& film, const PhotonEpoch& epoch, const GatherSettings& gathering,
             const OvertureSettings& settings, const MovingShapes& moving)
        : context_(context),
          world_(context.world),
          film_(film),
          epoch_(epoch),
          gathering_(gathering),
          settings_(settings),
          moving_(moving),
          strata_(HemisphereStrata::of(settings.rays / static_cast<int>(epoch.maps.size()))),
          cache_(world_.bounds, static_cast<int>(epoch.maps.size()), settings.accuracy * epoch.shrinkage)
    {
    }

    IrradianceCache make()
    {
        for (int stride = first_stride; stride >= least_stride && settings_.pays(stride); stride /= 2)
            for (int part : {0, 3, 1, 2}) add_wave(stride, part & 1, part >> 1);
        return context_.cancelled() ? IrradianceCache() : std::move(cache_);
    }

private:
    // The pixels at the middle of the cells of a grid that are odd or even across and down.
    void add_wave(int stride, int odd_x, int odd_y)
    {
        const int64_t most = settings_.most > 0 ? settings_.most - made_ : std::numeric_limits<int64_t>::max();
        if (context_.cancelled() || most <= 0) return;
        const Int2 low = film_.settings().crop_min, high = film_.settings().crop_max;
        const auto cells = [&](int extent, int odd) {
            return std::max(0, (extent - stride / 2 + stride - 1) / stride - odd + 1) / 2;
        };
        const int columns = cells(high.x - low.x, odd_x), rows = cells(high.y - low.y, odd_y);
        std::vector<std::optional<Place>> asked(static_cast<size_t>(columns) * static_cast<size_t>(rows));
        parallel_for(static_cast<int64_t>(asked.size()), 64, [&](int64_t i) {
            if (context_.cancelled()) return;
            const int x = 2 * static_cast<int>(i % columns) + odd_x, y = 2 * static_cast<int>(i / columns) + odd_y;
            asked[static_cast<size_t>(i)] = find_place(low + Int2(x * stride + stride / 2, y * stride + stride / 2));
        });
        std::vector<Place> places;
        for (const auto& place : asked)
            if (place) places.push_back(*place);
        thin_out(places, most);
        made_ += static_cast<int64_t>(places.size());
        std::vector<NewRecord> made(places.size());
        parallel_for(static_cast<int64_t>(places.size()), 1, [&](int64_t i) {
            if (!context_.cancelled()) made[static_cast<size_t>(i)] = make_record(places[static_cast<size_t>(i)]);
        });
        if (context_.cancelled()) return;
        for (const NewRecord& record : made) cache_.add(record.record, record.values);
    }

    // Leaves `most` of the places, evenly.
    static void thin_out(std::vector<Place>& places, int64_t most)
    {
        const auto count = static_cast<int64_t>(places.size());
        if (count <= most) return;
        for (int64_t i = 0; i < most; ++i)
            places[static_cast<size_t>(i)] = places[static_cast<size_t>(i * count / most)];
        places.resize(static_cast<size_t>(most));
    }

    RandomStream stream(Int2 pixel, uint32_t purpose) const
    {
        const uint64_t id = (uint64_t(uint32_t(pixel.y)) << 32) | uint32_t(pixel.x);
        return RandomStream(context_.seed,
                            hash_words(static_cast<uint64_t>(StreamPurpose::cache_record), uint64_t(epoch_.index), id),
                            purpose);
    }

    // Where an eye path through the pixel meets a cached surface that no record serves yet.
    std::optional<Place> find_place(Int2 pixel) const
    {
        RandomStream random = stream(pixel, 0);
        const Vec2 u = random.next_2d();
        const PhotonMapSet& maps = epoch_.maps[random.next_index(static_cast<uint32_t>(epoch_.maps.size()))];
        const PathStart start = path_start(maps.wavelengths, random.next_2d(), maps.time);
        Walk eye = start_at_camera(world_, Vec2(pixel.x + u.x, pixel.y + u.y), start, random);
        float distance = 0.0f;
        while (const Vertex* vertex = eye.next(world_, random)) {
            distance += vertex->distance;
            if (eye.depth() > gathering_.max_depth) return {};
            if (!vertex->is_delta()) {
                Spectrum irradiance;
                if (!is_cached(*vertex, moving_) || cache_.look_up(vertex->at.position, cache_normal(*vertex), 0,
                                                                   irradiance) != IrradianceCache::Answer::none)
                    return {};
                return Place{vertex->at.position,   vertex->at.error, vertex->at.n_geometric,
                             cache_normal(*vertex), vertex->at.time,  distance,
                             vertex->medium,        vertex->geometry, pixel};
            }
            if (!eye.survive_roulette(random)) return {};
        }
        return {};
    }

    NewRecord make_record(const Place& place) const
    {
        NewRecord made;
        CacheRecord& record = made.record;
        record.position = place.position;
        record.frame = Frame(place.normal);
        const float footprint = pixel_footprint(world_.camera, place.eye_distance);
        record.min_radius = min_radius_pixels * footprint;
        record.max_radius = max_radius_pixels * footprint;

        const auto rays = static_cast<size_t>(strata_.count());
        std::vector<Spectrum> radiance(rays);
        std::vector<float> distance(rays), u_ring(rays), distances;
        for (size_t set = 0; set < epoch_.maps.size(); ++set) {
            for (int ring = 0; ring < strata_.rings; ++ring)
                for (int sector = 0; sector < strata_.sectors; ++sector) {
                    const auto i = static_cast<size_t>(strata_.index(ring, sector));
                    RandomStream random = stream(place.pixel, static_cast<uint32_t>(1 + set * rays + i));
                    const Vec2 u = random.next_2d();
                    u_ring[i] = u.x;
                    radiance[i] = look(place, epoch_.maps[set],
                                       record.frame.to_world(strata_.direction(ring, sector, u)), random, distance[i]);
                }
            distances.insert(distances.end(), distance.begin(), distance.end());
            made.values.push_back(integrate_hemisphere(strata_, radiance, distance, u_ring));
        }
        record.reach = std::min(harmonic_mean(distances), gradient_length(made.values));
        return made;
    }

    // Indirect light of wide surfaces that comes from a direction, and the distance of what is seen there.
    Spectrum look(const Place& place, const PhotonMapSet& maps, const Vec3& direction, RandomStream& random,
                  float& distance) const
    {
        RadianceSum radiance;
        PhotonGather<RadianceSum> gather(gathering_, world_, maps, epoch_.shrinkage, false, random, radiance);
        gather.begin_at_diffuse();
        gather.set_eye_distance(place.eye_distance);
        const bool outside = dot(direction, place.n_geometric) > 0.0f;
        const Ray ray{offset_ray_origin(place.position, place.error, place.n_geometric, direction), direction,
                      maps.time.value_or(place.time)};
        const int kept_lane = static_cast<int>(random.next_index(Spectrum::lanes));
        distance = gather.follow(Walk(ray, world_.medium_beyond(place.geometry, outside, place.medium),
                                      TransportMode::radiance, maps.wavelengths, kept_lane, Spectrum(1.0f)),
                                 GatherPart::from_wide);
        return radiance.sum;
    }

    // How far one may go until the irradiance has changed by all of itself [m].
    static float gradient_length(const std::vector<HemisphereIrradiance>& values)
    {
        float irradiance = 0.0f, x = 0.0f, y = 0.0f;
        for (const HemisphereIrradiance& value : values) {
            irradiance += value.value.average();
            x += value.translation_x.average();
            y += value.translation_y.average();
        }
        const float slope = std::hypot(x, y);
        return slope > 0.0f ? irradiance / slope : infinity;
    }

    const PassContext& context_;
    const World& world_;
    const Film& film_;
    const PhotonEpoch& epoch_;
    const GatherSettings& gathering_;
    const OvertureSettings& settings_;
    const MovingShapes& moving_;
    const HemisphereStrata strata_;
    IrradianceCache cache_;
    int64_t made_ = 0;
};

}  // namespace

int64_t places_of_records(const FilmSettings& film, const OvertureSettings& settings)
{
    const Int2 size = film.crop_max - film.crop_min;
    int64_t places = 0;
    for (int stride = first_stride; stride >= least_stride && settings.pays(stride); stride /= 2)
        places += (int64_t(size.x) / stride + 1) * (int64_t(size.y) / stride + 1);
    return places;
}

IrradianceCache make_irradiance_cache(const PassContext& context, const Film& film, const PhotonEpoch& epoch,
                                      const GatherSettings& gathering, const OvertureSettings& settings,
                                      const MovingShapes& moving)
{
    return Overture(context, film, epoch, gathering, settings, moving).make();
}

}  // namespace dapple
