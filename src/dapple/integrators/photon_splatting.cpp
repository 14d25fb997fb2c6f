// Photon splatting: the eye's visible points of a pass are stored and indexed, then photons are traced and each is
// added, through the kernel, to the visible points whose disc it falls into. Lavignotte and Paulin 2003, "Scalable
// photon splatting for global illumination" (there in image space); with the radii of progressive photon mapping.
// The dual of sppm: the same visible points and the same photons in the same estimate (visible_points.h), with the
// loops exchanged. What differs is memory: photons are never stored, so any number of them takes no more, but visible
// points are (224 bytes and 28 of the index each, one or little more per pixel). And a photon adds to the film
// itself, whose exact sums are the same in any order.
// The index: visible points are sorted by the power of two of their radius, and each such level has a hash grid (times
// wavelength sets). Bias, rate of error and speed: as sppm.
//
// Cut for time, eye paths end at half of it, and as many light paths are traced as the other half allows; their light
// is kept apart from the film until their number is known.
#include "dapple/integrators/registry.h"
#include "dapple/integrators/surface_coverage.h"
#include "dapple/integrators/visible_points.h"
#include "dapple/photons/hash_grid.h"

#include <array>
#include <atomic>
#include <map>
#include <mutex>

namespace dapple {
namespace {

constexpr SettingInfo settings_table[] = {
    visible_point_setting::photons, visible_point_setting::radius, visible_point_setting::fixed_radius,
    visible_point_setting::alpha,   photon_setting::kernel,        visible_point_setting::wavelength_sets,
    photon_setting::max_depth,
};

// Where an eye path asks for photons, with all that a photon's contribution needs.
struct VisiblePoint {
    Vec3 position;
    float radius;  // [m]
    Vec3 wo;
    Int2 pixel;
    Spectrum throughput;  // of the eye path, pixel filter and allowance for the surface's edges included
    Bsdf bsdf;
    PathEvents events;  // of the eye path before this vertex
    bool obstructed;    // photons count only if they are seen
    bool first;         // of its eye path: the layer of photon density shows it
    uint32_t photons;   // that fell into its disc
};

// Visible points of similar radius. Points are counted in the order of the level's list.
struct Level {
    std::vector<VisiblePoint*> points;
    HashGrid grid;
};

// The visible points of a wavelength set in a pass.
class VisiblePoints {
public:
    explicit VisiblePoints(int rows) : rows_(static_cast<size_t>(rows)) {}

    // Thread-safe; `row` spreads the threads. A point without a proper radius finds no photons and is left out.
    void add(int row, const VisiblePoint& point)
    {
        if (!(point.radius > 0.0f && point.radius < 1e18f)) return;
        Row& to = rows_[static_cast<size_t>(row)];
        const std::lock_guard lock(to.mutex);
        to.points.push_back(point);
    }

    // Call once, after all points were added.
    void index()
    {
        std::map<int, Level> by_exponent;
        int largest = -1000;
        for (Row& row : rows_)
            for (VisiblePoint& point : row.points) largest = std::max(largest, std::ilogb(point.radius));
        // Points of far smaller radii than the largest share a level: only time depends on it.
        for (Row& row : rows_)
            for (VisiblePoint& point : row.points)
                by_exponent[std::max(std::ilogb(point.radius), largest - most_levels + 1)].points.push_back(&point);
        for (auto& [exponent, level] : by_exponent) {
            std::vector<Vec3> positions;
            positions.reserve(level.points.size());
            for (const VisiblePoint* point : level.points) positions.push_back(point->position);
            level.grid = HashGrid(positions, std::ldexp(1.0f, exponent + 1));
            levels_.push_back(std::move(level));
        }
    }

    // Calls visit(point, region, distance^2) for each point whose disc holds the photon, on its side of the surface: as
    // PhotonMap::for_each_on_surface, seen from the photon.
    template <class Visit>
    void for_each_around(const Photon& photon, const Visit& visit) const
    {
        for (const Level& level : levels_)
            level.grid.for_each_within(photon.position, [&](uint32_t i, float distance_squared) {
                VisiblePoint& point = *level.points[i];
                const SurfaceRegion region = surface_region(point.position, point.bsdf, point.wo);
                const float squared = region.disc().distance_squared(photon.position, distance_squared);
                if (squared < sqr(point.radius) && region.takes(photon.normal)) visit(point, region, squared);
            });
    }

    // From several threads at once.
    template <class Visit>
    void for_each(const Visit& visit) const
    {
        parallel_for(static_cast<int64_t>(rows_.size()), 4, [&](int64_t row) {
            for (const VisiblePoint& point : rows_[static_cast<size_t>(row)].points) visit(point);
        });
    }

private:
    static constexpr int most_levels = 16;
    struct Row {
        std::mutex mutex;
        std::vector<VisiblePoint> points;
    };
    std::vector<Row> rows_;
    std::vector<Level> levels_;
};

class PhotonSplatting final : public Integrator {
public:
    PhotonSplatting(const World& world, const Settings& settings)
        : settings_(world, settings, "photonsplat"), report_(settings_.describe(world))
    {
    }

    void render_pass(const PassContext& context, Film& film) override
    {
        const std::vector<PassSet> sets = settings_.sets_of_pass(
            context, film.settings().color_model, settings_.paths(film.resolution(), film.settings().color_model));
        std::vector<VisiblePoints> points;
        const int rows = film.settings().crop_max.y - film.settings().crop_min.y;
        for (size_t i = 0; i < sets.size(); ++i) points.emplace_back(rows);
        PassContext eyes = context;
        if (context.half_time) eyes.cancel = context.half_time;
        see(eyes, film, sets, points);
        parallel_for(static_cast<int64_t>(points.size()), 1,
                     [&](int64_t i) { points[static_cast<size_t>(i)].index(); });
        double per_photon = 1.0;
        if (context.half_time) {
            per_photon = splat_until_cut(context, film, sets, points);
        } else {
            for (size_t i = 0; i < sets.size(); ++i)
                splat(context, film, sets[i], points[i], {0, sets[i].photons.paths});
            if (context.cancelled()) per_photon = 0.0;
        }
        if (per_photon == 0.0) return film.give_up_pass();
        for (const VisiblePoints& of_set : points) note_density(film, of_set, static_cast<float>(per_photon));
    }

    bool light_comes_last() const override { return true; }
    std::vector<std::string> report() const override { return report_; }
    double bias_scale(uint32_t pass) const override { return settings_.shrinkage(pass); }

    // A quarter of the time, as eye paths and what photons bring them take some, too.
    std::vector<Effort> efforts(const PassContext&, const FilmSettings& film) const override
    {
        return {{"photons", "light paths per pass", settings_.paths(film.resolution, film.color_model),
                 photon_setting::least_paths, 0.25}};
    }

private:
    // The eye paths of the pass.
    void see(const PassContext& context, Film& film, const std::vector<PassSet>& sets,
             std::vector<VisiblePoints>& points) const
    {
        const auto shrinkage = static_cast<float>(std::sqrt(settings_.shrinkage(context.pass)));
        for_each_pixel_of_sets(context, film, sets, [&](EyeSample& sample, size_t set) {
            const auto keep = [&](const Walk& eye, float distance) {
                const Vertex& vertex = eye.vertex();
                const float radius = shrinkage * settings_.first_radius(context.world.camera, distance);
                const bool first = !(sample.sums.radius > 0.0f);
                if (first) sample.sums.radius = radius;
                RandomStream trials = stream_of_trials(sample.random, eye.depth());
                const SampledCoverage coverage =
                    sample_coverage(context.world, surface_region(vertex.at.position, vertex.bsdf, vertex.wo), radius,
                                    settings_.kernel(), vertex.at.time, trials);
                points[set].add(sample.pixel.y - film.settings().crop_min.y,
                                {vertex.at.position, radius, vertex.wo, sample.pixel,
                                 eye.arriving() * (sample.filter_weight * coverage.inverse), vertex.bsdf, eye.events(),
                                 coverage.obstructed, first, 0});
            };
            trace_visible_points(context.world, sample, sets[set].time, settings_.max_depth(), keep);
        });
    }

    struct PathRange {
        int64_t begin, end;
    };

    // Of all light paths of the set; light is divided by the number of all.
    void splat(const PassContext& context, Film& film, const PassSet& set, const VisiblePoints& points,
               PathRange paths) const
    {
        constexpr int64_t grain = 256;
        const Sensor::LaneColors colors(film.settings().sensor, set.wavelengths);
        parallel_for_ranges(paths.end - paths.begin, grain, [&](int64_t begin, int64_t end) {
            if (context.cancelled()) return;
            std::vector<Photon> photons;
            trace_photons(context.world, set.photons, paths.begin + begin, paths.begin + end, photons);
            for (const Photon& photon : photons) add(context.world, film, colors, set, points, photon);
        });
        context.statistics.light_paths += static_cast<uint64_t>(paths.end - paths.begin);
    }

    // In rounds of equally many light paths of each set, until all are traced; where eye paths were cut, until the time
    // is up. Their light is divided by the number that was traced: returns how much more each counts than in a whole
    // pass; or 0 where there are too few of them to count at all.
    double splat_until_cut(const PassContext& context, Film& film, const std::vector<PassSet>& sets,
                           const std::vector<VisiblePoints>& points) const
    {
        constexpr int64_t round = 2048;
        PassContext whole_rounds = context;
        whole_rounds.cancel = nullptr;
        FilmSettings radiance_alone = film.settings();
        radiance_alone.guide_layers = radiance_alone.photon_layers = false;
        Film light(radiance_alone);
        const int64_t all = sets.front().photons.paths;
        const bool to_the_end = film.reached_part() < 1.0;
        int64_t traced = 0;
        do {
            const int64_t end = to_the_end ? traced + round : std::min(traced + round, all);
            for (size_t i = 0; i < sets.size(); ++i) splat(whole_rounds, light, sets[i], points[i], {traced, end});
            traced = end;
        } while (!context.cancelled() && (to_the_end || traced < all));
        // Few light paths are better than none, but would bring noise into the mean of other passes.
        if (!context.coarse_to_fine && 2 * traced < all) return 0.0;
        const double per_photon = static_cast<double>(all) / static_cast<double>(traced);
        film.add_light(light, per_photon);
        return per_photon;
    }

    void add(const World& world, Film& film, const Sensor::LaneColors& colors, const PassSet& set,
             const VisiblePoints& points, const Photon& photon) const
    {
        const float per_path = 1.0f / static_cast<float>(set.photons.paths);
        const float time = set.time.value_or(0.0f);
        points.for_each_around(photon, [&](VisiblePoint& point, const SurfaceRegion& region, float distance_squared) {
            std::atomic_ref(point.photons).fetch_add(1, std::memory_order_relaxed);
            const float inv_radius = 1.0f / point.radius;
            const float weight = kernel_disc(settings_.kernel(), std::sqrt(distance_squared) * inv_radius) *
                                 (sqr(inv_radius) * per_path);
            const Spectrum light =
                photon_radiance(point.bsdf, point.wo, photon.direction, photon.flux,
                                static_cast<PathClass>(photon.path_class), photon.from_delta_light, weight);
            if (light.is_black()) return;
            if (point.obstructed && !sees_along_surface(world, region, point.radius, photon.position, time)) return;
            film.add_to_pixel(point.pixel, colors.to_rgb(point.throughput * light),
                              class_with_photon(point.events, photon.path_class), LightGroup(photon.light_group));
        });
    }

    // Fills the layer of photon density, which is known only now.
    static void note_density(Film& film, const VisiblePoints& points, float per_photon)
    {
        points.for_each([&](const VisiblePoint& point) {
            if (!point.first || point.photons == 0) return;
            PixelSample sums(0);
            sums.photon_density = per_photon * static_cast<float>(point.photons) * inv_pi / sqr(point.radius);
            film.add_pixel(point.pixel, sums, 1);
        });
    }

    VisiblePointSettings settings_;
    std::vector<std::string> report_;
};

std::unique_ptr<Integrator> create(const World& world, const Settings& settings)
{
    return std::make_unique<PhotonSplatting>(world, settings);
}

}  // namespace

extern const IntegratorEntry photon_splatting_entry{
    "photonsplat",
    "photon splatting: photons added to stored visible points, as sppm with memory independent of the photons",
    settings_table, false, true, create,
    // A visible point or little more, in a list with room to grow, and the index.
    2 * sizeof(VisiblePoint) + 40, true};

}  // namespace dapple
