// Path tracing: eye paths with next-event estimation, combined by multiple importance sampling.
// Kajiya 1986, "The rendering equation"; Veach and Guibas 1995, "Optimally combining sampling techniques".
// At each vertex the direct light is estimated twice, by sampling lights and by sampling the scattering; the balance
// heuristic weighs them. Unbiased, surfaces and media. Cannot find light of point-like sources through delta surfaces,
// and finds small lights through them with great noise. Error falls as N^-1 in MSE; cost: two rays per vertex.
#include "dapple/integrators/pixel_loop.h"
#include "dapple/integrators/registry.h"
#include "dapple/transport/connect.h"

namespace dapple {
namespace {

constexpr SettingInfo settings_table[] = {
    {"maxdepth", "scatterings", "100", ">= 0", "longest path, in scatterings on surfaces and in media"},
};

class PathTracing final : public Integrator {
public:
    explicit PathTracing(const Settings& settings) : max_depth_(static_cast<int>(settings.integer("maxdepth"))) {}

    bool adds_eye_samples_alone() const override { return true; }

    void render_pass(const PassContext& context, Film& film) override
    {
        const ColorModel model = film.settings().color_model;
        for_each_pixel(
            context, film, [&](Int2, RandomStream& random) { return choose_wavelengths(model, random.next()); },
            [&](EyeSample& sample) { trace(context.world, sample); });
    }

private:
    void trace(const World& world, EyeSample& sample) const
    {
        RandomStream& random = sample.random;
        Walk eye = start_at_camera(world, sample.raster, sample.wavelengths, random);
        GuideRecorder guides(world, sample);

        while (const Vertex* vertex = eye.next(world, random)) {
            guides.see(*vertex);
            if (!eye.medium_emission().is_black()) sample.add(eye.medium_emission(), PathClass::volume, LightGroup(0u));
            if (vertex->emitter.valid())
                sample.add(met_emission(world, eye, true), classify(eye.events(), {}),
                           world.lights.list[vertex->emitter.value].group);
            if (eye.depth() > max_depth_) return;
            if (!vertex->is_delta()) {
                const DirectLight direct = direct_light(world, eye, *vertex, true, random);
                if (direct.found) sample.add(direct.radiance, class_at(eye, *vertex), direct.group);
            }
            if (eye.depth() > 1 && !eye.survive_roulette(random)) return;
        }
        if (!eye.medium_emission().is_black()) sample.add(eye.medium_emission(), PathClass::volume, LightGroup(0u));
        if (eye.escaped())
            for (LightId light : world.environments)
                sample.add(met_environment(world, eye, light, true), classify(eye.events(), {}),
                           world.lights.list[light.value].group);
    }

    // The class of light that comes straight from a light to the vertex.
    static PathClass class_at(const Walk& eye, const Vertex& vertex)
    {
        PathEvents events = eye.events();
        vertex.on_surface ? events.add_surface(false) : events.add_medium();
        return classify(events, {});
    }

    int max_depth_;
};

std::unique_ptr<Integrator> create(const World&, const Settings& settings)
{
    return std::make_unique<PathTracing>(settings);
}

}  // namespace

extern const IntegratorEntry path_tracing_entry{
    "path", "path tracing: unbiased reference; surfaces and media; poor at caustics", settings_table, true, false,
    create};

}  // namespace dapple
