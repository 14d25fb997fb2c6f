// Light tracing: particles from the lights, connected to the camera at every vertex.
// Dutre, Lafortune, Willems 1993, "Monte Carlo light tracing with direct computation of pixel intensities".
// Estimates each pixel's measurement  I_j = integral W_j(x,w) L(x,w)  by  1/N sum over particles of  f Phi W_j  (the
// t = 1 technique). Finds LS*DE caustics; cannot see anything in or through a delta surface. Lights seen directly or
// through delta surfaces (L S* E) come from one eye path per pixel and pass. Error falls as N^-1 in MSE; cost: one
// shadow ray per vertex inside the picture.
#include "dapple/base/log.h"
#include "dapple/cameras/raster_copies.h"
#include "dapple/integrators/pixel_loop.h"
#include "dapple/integrators/registry.h"
#include "dapple/transport/connect.h"
#include "dapple/transport/emission.h"

namespace dapple {
namespace {

constexpr SettingInfo settings_table[] = {
    {"maxdepth", "scatterings", "100", ">= 0", "longest path, in scatterings on surfaces and in media"},
    {"particles", "particles", "auto", "> 0", "particles per pass; auto: one per pixel of the full image"},
};

class LightTracing final : public Integrator {
public:
    explicit LightTracing(const Settings& settings)
        : max_depth_(static_cast<int>(settings.integer("maxdepth"))),
          particles_(settings.is_auto("particles") ? 0 : settings.integer("particles"))
    {
    }

    void render_pass(const PassContext& context, Film& film) override
    {
        const World& world = context.world;
        const ColorModel model = film.settings().color_model;
        for_each_pixel(
            context, film, [&](Int2, RandomStream& random) { return choose_wavelengths(model, random.next()); },
            [&](EyeSample& sample) { see_lights(world, sample); });

        const int64_t particles =
            particles_ > 0 ? particles_ : int64_t(film.resolution().x) * int64_t(film.resolution().y);
        const float scale = 1.0f / static_cast<float>(particles);
        parallel_for_ranges(particles, 1024, [&](int64_t begin, int64_t end) {
            if (context.cancelled()) return;
            for (int64_t i = begin; i < end; ++i) trace(context, film, model, i + particles * context.pass, scale);
        });
        context.statistics.light_paths += static_cast<uint64_t>(particles);
    }

private:
    // L S* E.
    void see_lights(const World& world, EyeSample& sample) const
    {
        Walk eye = start_at_camera(world, sample.raster, sample.wavelengths, sample.random);
        GuideRecorder guides(world, sample);
        while (const Vertex* vertex = eye.next(world, sample.random)) {
            if (eye.events().diffuse > 0) return;  // a coated surface was left by its diffuse part
            guides.see(*vertex);
            if (vertex->emitter.valid())
                sample.add(met_emission(world, eye, false), PathClass::emission,
                           world.lights.list[vertex->emitter.value].group);
            if (!vertex->has_delta_lobe() || eye.depth() > max_depth_) return;
            if (eye.depth() > 1 && !eye.survive_roulette(sample.random)) return;
        }
        if (!eye.escaped() || eye.events().diffuse > 0) return;
        for (LightId light : world.environments)
            sample.add(met_environment(world, eye, light, false), PathClass::emission,
                       world.lights.list[light.value].group);
    }

    void trace(const PassContext& context, Film& film, ColorModel model, int64_t index, float scale) const
    {
        const World& world = context.world;
        RandomStream random(context.seed,
                            hash_words(static_cast<uint64_t>(StreamPurpose::splat), uint64_t(index) >> 32),
                            static_cast<uint32_t>(index));
        const Wavelengths wavelengths = choose_wavelengths(model, random.next());
        Walk photon;
        if (!emit(world, wavelengths, random, photon)) return;
        const Sensor& sensor = film.settings().sensor;
        const Vec2 radius = film.settings().filter.radius();
        const float margin = std::max(radius.x, radius.y);

        while (const Vertex* vertex = photon.next(world, random)) {
            if (photon.depth() > max_depth_) return;
            SeenByCamera seen;
            if (!vertex->is_delta() && connect_to_camera(world, photon.carried(), *vertex, margin, random, seen)) {
                PathEvents events = photon.events();
                vertex->on_surface ? events.add_surface(false) : events.add_medium();
                const Vec3 rgb = sensor.to_rgb(seen.contribution * scale, wavelengths);
                for (const Vec2& raster : raster_copies(world.camera, seen.camera.raster, margin))
                    film.splat(raster, rgb, classify({}, events), photon.light_group);
            }
            if (!photon.survive_roulette(random)) return;
        }
    }

    int max_depth_;
    int64_t particles_;  // 0: one per pixel
};

std::unique_ptr<Integrator> create(const World& world, const Settings& settings)
{
    if (world.has_emitting_media)
        log_warning("lightpath leaves out the light of emitting media: no particles start in them; use path");
    return std::make_unique<LightTracing>(settings);
}

}  // namespace

extern const IntegratorEntry light_tracing_entry{
    "lightpath",    "light tracing: particles connected to the camera; good at caustics on matte surfaces",
    settings_table, true,
    false,          create};

}  // namespace dapple
