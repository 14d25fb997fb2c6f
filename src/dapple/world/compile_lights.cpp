// Lights of the scene, and the lights that emissive shapes become. Scales follow pbrt-v4: a spectrum gives the colour
// and, divided by its photometric scale, a luminance (intensity) of 1; `scale` multiplies; `power` and `illuminance`
// set the absolute amount.
#include "dapple/base/log.h"
#include "dapple/image/image_file.h"
#include "dapple/lights/make_light.h"
#include "dapple/world/compile_parts.h"

namespace dapple::detail {
namespace {

SpectrumValue unit_spectrum(CompileContext& context, const scene::SpectrumSource& source, float scale)
{
    SpectrumPool& pool = context.world.spectra;
    const SpectrumValue value = compile_spectrum(pool, source, SpectrumUsage::light);
    return scaled(value, scale * photometric_scale(pool, value));
}

SpectrumValue unit_white(CompileContext& context, scene::ColorSpace space, float scale)
{
    return unit_spectrum(context, scene::SpectrumSource(scene::White{space}), scale);
}

template <class Make>
uint32_t light_image(CompileContext& context, const std::filesystem::path& file, const SourceLocation& at,
                     const Make& make)
{
    Image pixels;
    try {
        pixels = read_image(file.string());
    } catch (const UserError& error) {
        throw UserError(at, error.what());
    }
    auto& images = context.world.lights.images;
    images.push_back(make(std::move(pixels)));
    return static_cast<uint32_t>(images.size() - 1);
}

struct Fill {
    CompileContext& context;
    const scene::Light& source;
    Light& out;

    // Places the light: `place` is applied first, in the light's own space.
    void place(const Transform& place) const
    {
        const AnimatedTransform moving = over_shutter(source.world_from_light, context.camera);
        out.world_from_light = moving.moves() ? AnimatedTransform(moving.start() * place, moving.end() * place)
                                              : AnimatedTransform(moving.start() * place);
    }
    void place() const { place(Transform()); }
    void scale_to_power() const
    {
        if (source.power) out.spectrum = scaled(out.spectrum, *source.power / power_factor(out, context.world.lights));
    }
    void scale_to_illuminance(const std::optional<float>& illuminance) const
    {
        if (illuminance)
            out.spectrum = scaled(out.spectrum, *illuminance / illuminance_factor(out, context.world.lights));
    }

    void operator()(const scene::PointLight& light) const
    {
        out.kind = Light::Kind::point;
        place(Transform(translation(light.from)));
        out.spectrum = unit_spectrum(context, light.intensity, source.scale);
        scale_to_power();
    }
    void operator()(const scene::SpotLight& light) const
    {
        out.kind = Light::Kind::spot;
        place(look_along(light.from, light.to - light.from));
        out.cos_total = std::cos(radians(light.cone_angle));
        out.cos_falloff = std::cos(radians(std::max(0.0f, light.cone_angle - light.cone_delta_angle)));
        out.spectrum = unit_spectrum(context, light.intensity, source.scale);
        scale_to_power();
    }
    void operator()(const scene::DistantLight& light) const
    {
        out.kind = Light::Kind::distant;
        place(look_along(Vec3(0), light.to - light.from));
        out.spectrum = unit_spectrum(context, light.radiance, source.scale);
        scale_to_illuminance(light.illuminance);
    }
    void operator()(const scene::InfiniteLight& light) const
    {
        place();
        if (light.file.empty()) {
            out.kind = Light::Kind::environment;
            out.spectrum = light.radiance ? unit_spectrum(context, *light.radiance, source.scale)
                                          : unit_white(context, source.color_space, source.scale);
        } else {
            out.kind = Light::Kind::environment_image;
            out.spectrum = unit_white(context, source.color_space, source.scale);
            out.image = light_image(context, light.file, source.at, [&](Image pixels) {
                if (is_latlong(pixels)) {
                    log_info("{}: {} is a latitude-longitude map; resampled to equal area", source.at.to_string(),
                             light.file.string());
                    pixels = equal_area_from_latlong(pixels);
                }
                return make_environment_image(std::move(pixels), source.at);
            });
        }
        if (!light.portal.empty())
            log_warning(
                "{}: parameter 'portal' of light 'infinite' is not used: light comes in through every opening, "
                "where pbrt lets it in through the portal alone",
                source.at.to_string());
        scale_to_illuminance(light.illuminance);
    }
    void operator()(const scene::GoniometricLight& light) const
    {
        out.kind = Light::Kind::goniometric;
        // pbrt-v4 has the image's pole, the z axis of the equal-area map, along the light's y axis.
        place(Transform(Matrix4{{{{1, 0, 0, 0}, {0, 0, 1, 0}, {0, 1, 0, 0}, {0, 0, 0, 1}}}}));
        out.spectrum = unit_spectrum(context, light.intensity, source.scale);
        if (light.file.empty())
            out.kind = Light::Kind::point;
        else
            out.image = light_image(context, light.file, source.at,
                                    [&](Image pixels) { return make_goniometric_image(std::move(pixels), source.at); });
        scale_to_power();
    }
    void operator()(const scene::ProjectionLight& light) const
    {
        out.kind = Light::Kind::projection;
        place();
        out.spectrum = unit_white(context, source.color_space, source.scale);
        out.image = light_image(context, light.file, source.at, [&](Image pixels) {
            return make_projection_image(std::move(pixels), light.fov, out, source.at);
        });
        scale_to_power();
    }
};

}  // namespace

LightId compile_area_lights(CompileContext& context, const scene::Shape& shape, const Geometry& geometry,
                            const std::vector<Primitive>& primitives)
{
    const scene::AreaLight& source = context.description.area_lights[shape.area_light.value];
    Lights& lights = context.world.lights;
    Light light;
    light.kind = Light::Kind::area;
    light.two_sided = source.two_sided;
    light.group = light_group(context.world, source.light_group);
    light.medium = geometry.exterior;
    light.medium_inside = geometry.interior;
    if (shape.alpha.textured())
        light.alpha_texture = geometry.alpha;
    else
        light.alpha = shape.alpha.value;
    light.spectrum = source.radiance ? unit_spectrum(context, *source.radiance, source.scale)
                                     : unit_white(context, source.color_space, source.scale);
    if (!source.file.empty())
        light.image = light_image(context, source.file, source.at,
                                  [&](Image pixels) { return make_area_image(std::move(pixels), source.at); });
    const LightId first(lights.list.size());
    for (const Primitive& primitive : primitives) {
        Light one = light;
        one.shape = primitive;
        // As in pbrt, `power` is that of each primitive of a mesh.
        if (source.power) one.spectrum = scaled(one.spectrum, *source.power / power_factor(one, lights));
        lights.list.push_back(one);
    }
    return first;
}

void compile_lights(CompileContext& context)
{
    World& world = context.world;
    Lights& lights = world.lights;
    if (!world.bounds.isEmpty()) {
        lights.scene_center = world.bounds.center();
        lights.scene_radius = std::max(length(world.bounds.size()) * 0.5f, 1e-30f);
    }
    for (const scene::Light& source : context.description.lights) {
        Light light;
        light.group = light_group(world, source.light_group);
        light.medium = medium_id(source.medium);
        std::visit(Fill{context, source, light}, source.kind);
        if (light.kind == Light::Kind::environment || light.kind == Light::Kind::environment_image)
            world.environments.push_back(LightId(lights.list.size()));
        lights.list.push_back(light);
    }
    std::vector<float> powers;
    powers.reserve(lights.list.size());
    for (size_t i = 0; i < lights.list.size(); ++i) powers.push_back(power(lights, world.spectra, LightId(i)));
    world.light_choice = AliasTable(powers);
}

}  // namespace dapple::detail
