#include "dapple/integrators/pixel_loop.h"

namespace dapple {
namespace {

Vec3 in_camera_space(const Camera& camera, const Vec3& p, float time)
{
    return camera.world_from_camera.with(
        time, [&](const Transform& transform) { return Transform::apply_point(transform.inverse_matrix(), p); });
}

Vec3 normal_in_camera_space(const Camera& camera, const Vec3& n, float time)
{
    return normalize(
        camera.world_from_camera.with(time, [&](const Transform& transform) { return transform.inverse().normal(n); }));
}

}  // namespace

uint64_t pixels_of_first_round(const FilmSettings& settings)
{
    const Int2 size = settings.crop_max - settings.crop_min;
    const auto blocks = [](int extent) { return (extent + PassContext::block - 1) / PassContext::block; };
    return uint64_t(blocks(size.x)) * uint64_t(blocks(size.y));
}

void GuideRecorder::see(const Vertex& vertex)
{
    if (has_color_ || !vertex.on_surface) return;
    Guides& guides = sample_.sums.guides;
    if (!has_geometry_) {
        has_geometry_ = true;
        const Vec3 position = in_camera_space(world_.camera, vertex.at.position, vertex.at.time);
        guides.position = sample_.guides_in_camera_space ? position : vertex.at.position;
        guides.depth = position.z;
    }
    if (vertex.is_delta()) return;
    has_color_ = true;
    const Vec3& n = vertex.bsdf.frame.n;
    guides.normal = sample_.guides_in_camera_space ? normal_in_camera_space(world_.camera, n, vertex.at.time) : n;
    // Once more in the rgb model: a guide must not carry colour noise.
    const MaterialId material = resolve_mix(world_.materials, world_.geometries[vertex.geometry].material, vertex.at);
    const Bsdf bsdf = make_bsdf(world_.materials, world_.spectra, material, vertex.at, Wavelengths::rgb(), 0);
    const Spectrum albedo = guide_albedo(bsdf, vertex.wo);
    guides.albedo = Vec3(albedo[0], albedo[1], albedo[2]);
}

}  // namespace dapple
