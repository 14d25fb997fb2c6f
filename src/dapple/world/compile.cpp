#include "dapple/world/compile.h"

#include "dapple/base/log.h"
#include "dapple/world/accelerator.h"
#include "dapple/world/compile_parts.h"

#include <chrono>

namespace dapple {
namespace {

template <class Step>
double timed(const Step& step)
{
    const auto start = std::chrono::steady_clock::now();
    step();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void measure(const World& world, CompileReport& report)
{
    for (const Mesh& mesh : world.meshes) {
        report.triangles += mesh.indices.size() / 3;
        report.geometry_bytes += mesh.positions.size() * sizeof(Vec3) + mesh.normals.size() * sizeof(Vec3) +
                                 mesh.uvs.size() * sizeof(Vec2) + mesh.tangents.size() * sizeof(Vec3) +
                                 mesh.indices.size() * sizeof(uint32_t);
    }
    report.other_primitives = world.primitives.size();
    report.geometry_bytes += world.primitives.size() * sizeof(Primitive);
    report.instances = world.instances.size();
    report.lights = world.lights.list.size();
    report.accelerator_bytes = world.accelerator->memory();
    for (const Image& image : world.materials.textures.images)
        report.texture_bytes += image.pixels.size() * sizeof(float);
    for (const LightImage& image : world.lights.images)
        report.texture_bytes += image.pixels.pixels.size() * sizeof(float);
    for (const Grid& grid : world.media.grids) report.medium_bytes += grid.values.size() * sizeof(float);
}

// The scene's camera; without pixel jitter, as in pbrt, one that sees the middle of the shutter interval through the
// middle of its lens.
scene::Camera still_camera(const scene::Description& description)
{
    scene::Camera camera = description.camera;
    if (description.options.disable_pixel_jitter) {
        camera.shutter_open = camera.shutter_close = 0.5f * (camera.shutter_open + camera.shutter_close);
        camera.lens_radius = 0.0f;
    }
    return camera;
}

}  // namespace

std::unique_ptr<World> compile(const scene::Description& description, CompileReport* report_out)
{
    CompileReport report;
    auto world = std::make_unique<World>();
    world->light_group_names = {"default"};
    detail::CompileContext context{description, *world, report, still_camera(description), {}, {}, {}, {}};

    report.seconds_textures = timed([&] {
        detail::compile_textures(context);
        detail::compile_materials(context);
        detail::compile_media(context);
    });
    report.seconds_shapes = timed([&] { detail::compile_shapes(context); });
    report.seconds_accelerator = timed([&] { world->accelerator = std::make_unique<Accelerator>(*world); });
    world->bounds = world->accelerator->bounds();
    report.seconds_lights = timed([&] { detail::compile_lights(context); });
    detail::compile_camera(context);

    for (const Material& material : world->materials.list)
        world->has_interfaces |= material.kind == Material::Kind::interface;
    for (const Geometry& geometry : world->geometries) world->has_alpha |= geometry.alpha.valid();
    for (const Medium& medium : world->media.list) {
        world->has_scattering_media |= medium.scatters();
        world->has_emitting_media |= medium.emits();
    }
    if (world->lights.list.empty() && !world->has_emitting_media)
        log_warning("the scene has no lights: the image will be black");
    measure(*world, report);
    if (report_out) *report_out = report;
    return world;
}

namespace detail {

AnimatedTransform over_shutter(const scene::MovingMatrix& matrix, const scene::Camera& camera)
{
    if (!matrix.moves() || !(matrix.end_time > matrix.start_time)) return AnimatedTransform(Transform(matrix.start));
    const AnimatedTransform keyed{Transform(matrix.start), Transform(matrix.end)};
    const auto at = [&](float seconds) {
        return keyed.at((seconds - matrix.start_time) / (matrix.end_time - matrix.start_time));
    };
    if (camera.shutter_open == matrix.start_time && camera.shutter_close == matrix.end_time) return keyed;
    return AnimatedTransform(at(camera.shutter_open), at(camera.shutter_close));
}

LightGroup light_group(World& world, const std::string& name)
{
    if (name.empty()) return LightGroup(0u);
    auto& names = world.light_group_names;
    for (uint32_t i = 1; i < names.size(); ++i)
        if (names[i] == name) return LightGroup(i);
    if (names.size() >= 256) throw UserError("more than 255 light groups");
    names.push_back(name);
    return LightGroup(static_cast<uint32_t>(names.size() - 1));
}

void compile_camera(CompileContext& context)
{
    const scene::Camera& camera = context.camera;
    const scene::Film& film = context.description.film;
    const AnimatedTransform world_from_camera = over_shutter(camera.world_from_camera, camera);
    Camera& out = context.world.camera;
    std::optional<Box2> window;
    if (camera.screen_window) {
        const auto& w = *camera.screen_window;
        window = Box2(Vec2(w[0], w[2]), Vec2(w[1], w[3]));
    }
    switch (camera.kind) {
        case scene::Camera::Kind::perspective:
            out = make_perspective(world_from_camera, film.resolution, camera.fov, camera.frame_aspect_ratio, window,
                                   camera.lens_radius, camera.focal_distance);
            break;
        case scene::Camera::Kind::orthographic:
            out = make_orthographic(world_from_camera, film.resolution, camera.frame_aspect_ratio, window,
                                    camera.lens_radius, camera.focal_distance);
            break;
        case scene::Camera::Kind::spherical:
            out = make_spherical(world_from_camera, film.resolution,
                                 camera.mapping == scene::Camera::SphericalMapping::equal_area
                                     ? Camera::SphericalMapping::equal_area
                                     : Camera::SphericalMapping::equirectangular);
            break;
    }
    out.shutter_open = camera.shutter_open;
    out.shutter_close = camera.shutter_close;
    context.world.camera_medium = medium_id(camera.medium);
}

}  // namespace detail
}  // namespace dapple
