// Cameras with affine camera-to-world transforms M. The importance follows from volumes: a ray family of raster (or
// direction) parameters q and path parameter s sweeps dV = |det M| J(s) dq ds in world space, and a surface element
// facing the ray cuts off dV = dA |cos| |D| ds, where D is the world ray per ds. Hence
//     dq / (dA |cos|) = |D| / (|det M| J(s)).
// Perspective: s is the camera z from the lens, D = M (x, y, 1), J = s^2. Orthographic: D = M (slope, 1), J = 1.
// Spherical: s is the radius, D = M d, J = s^2 with q the solid angle in camera space. For rigid M these are the
// textbook 1 / (cos^3 d^2), 1 / cos and 1 / d^2. The lens point is held fixed throughout, so a lens only adds an
// average.
#include "dapple/cameras/camera.h"

#include "dapple/sampling/equal_area.h"
#include "dapple/sampling/warps.h"

namespace dapple {
namespace {

Box2 window_of(const Int2& resolution, std::optional<float> frame_aspect, const std::optional<Box2>& screen_window)
{
    if (screen_window) return *screen_window;
    const float aspect = frame_aspect.value_or(static_cast<float>(resolution.x) / static_cast<float>(resolution.y));
    const Vec2 corner = aspect > 1.0f ? Vec2(aspect, 1.0f) : Vec2(1.0f, 1.0f / aspect);
    return {-corner, corner};
}

// The point of the screen window under a raster position, and back.
Vec2 window_from_raster(const Camera& camera, const Vec2& raster)
{
    const Box2& window = camera.screen_window;
    return {lerp(raster.x / static_cast<float>(camera.resolution.x), window.min.x, window.max.x),
            lerp(raster.y / static_cast<float>(camera.resolution.y), window.max.y, window.min.y)};
}

Vec2 raster_from_window(const Camera& camera, const Vec2& p)
{
    const Box2& window = camera.screen_window;
    return {(p.x - window.min.x) / (window.max.x - window.min.x) * static_cast<float>(camera.resolution.x),
            (window.max.y - p.y) / (window.max.y - window.min.y) * static_cast<float>(camera.resolution.y)};
}

float pixel_count(const Camera& camera)
{
    return static_cast<float>(camera.resolution.x) * static_cast<float>(camera.resolution.y);
}

float pixels_per_window_area(const Camera& camera)
{
    const Box2& window = camera.screen_window;
    return pixel_count(camera) / std::fabs((window.max.x - window.min.x) * (window.max.y - window.min.y));
}

Vec2 lens_point(const Camera& camera, const Vec2& u)
{
    return camera.lens_radius > 0.0f ? sample_disk_concentric(u) * camera.lens_radius : Vec2(0.0f, 0.0f);
}

// Pole along y, as pbrt does by exchanging y and z.
Vec3 spherical_from_raster(const Camera& camera, const Vec2& raster)
{
    const Vec2 p(raster.x / static_cast<float>(camera.resolution.x),
                 raster.y / static_cast<float>(camera.resolution.y));
    if (camera.mapping == Camera::SphericalMapping::equal_area) {
        const Vec3 d = equal_area_square_to_sphere(wrap_equal_area_square(p));
        return {d.x, d.z, d.y};
    }
    const Vec3 d = spherical_direction(std::sin(pi * p.y), std::cos(pi * p.y), 2.0f * pi * p.x);
    return {d.x, d.z, d.y};
}

// The raster position of a unit direction in camera space and the raster area per solid angle there.
Vec2 raster_from_spherical(const Camera& camera, const Vec3& direction, float& pixels_per_solid_angle)
{
    const Vec3 d(direction.x, direction.z, direction.y);
    const Vec2 resolution(static_cast<float>(camera.resolution.x), static_cast<float>(camera.resolution.y));
    if (camera.mapping == Camera::SphericalMapping::equal_area) {
        pixels_per_solid_angle = pixel_count(camera) * (0.25f * inv_pi);
        return equal_area_sphere_to_square(d) * resolution;
    }
    // d omega = sin(theta) d theta d phi; the sine is kept off zero so that the poles stay finite.
    const float sin_t = std::sqrt(d.x * d.x + d.y * d.y);
    const float theta = std::atan2(sin_t, d.z);
    const float turn = std::atan2(d.y, d.x) * (0.5f * inv_pi);
    pixels_per_solid_angle = pixel_count(camera) * (0.5f * inv_pi * inv_pi) / std::max(sin_t, 1e-6f);
    return Vec2(turn < 0.0f ? turn + 1.0f : turn, theta * inv_pi) * resolution;
}

// The raster area per parameter q of the head comment at a point in camera space; s: the point's depth there.
float raster_density(const Camera& camera, const Vec3& p, float& s)
{
    if (camera.kind != Camera::Kind::spherical) {
        s = p.z;
        const float density = pixels_per_window_area(camera);
        return camera.kind == Camera::Kind::perspective ? density / (s * s) : density;
    }
    s = length(p);
    if (!(s > 0.0f)) return 0.0f;
    float density;
    raster_from_spherical(camera, p * (1.0f / s), density);
    return density / (s * s);
}

bool inside_image(const Camera& camera, const Vec2& raster, float margin)
{
    return raster.x >= -margin && raster.x <= static_cast<float>(camera.resolution.x) + margin && raster.y >= -margin &&
           raster.y <= static_cast<float>(camera.resolution.y) + margin;
}

}  // namespace

Camera make_perspective(const AnimatedTransform& world_from_camera, const Int2& resolution, float fov_degrees,
                        std::optional<float> frame_aspect, const std::optional<Box2>& screen_window, float lens_radius,
                        float focal_distance)
{
    Camera camera =
        make_orthographic(world_from_camera, resolution, frame_aspect, screen_window, lens_radius, focal_distance);
    camera.kind = Camera::Kind::perspective;
    const float scale = std::tan(0.5f * radians(fov_degrees));
    camera.screen_window.min *= scale;
    camera.screen_window.max *= scale;
    return camera;
}

Camera make_orthographic(const AnimatedTransform& world_from_camera, const Int2& resolution,
                         std::optional<float> frame_aspect, const std::optional<Box2>& screen_window, float lens_radius,
                         float focal_distance)
{
    Camera camera;
    camera.kind = Camera::Kind::orthographic;
    camera.world_from_camera = world_from_camera;
    camera.resolution = resolution;
    camera.screen_window = window_of(resolution, frame_aspect, screen_window);
    camera.lens_radius = lens_radius;
    camera.focal_distance = focal_distance;
    return camera;
}

Camera make_spherical(const AnimatedTransform& world_from_camera, const Int2& resolution,
                      Camera::SphericalMapping mapping)
{
    Camera camera;
    camera.kind = Camera::Kind::spherical;
    camera.mapping = mapping;
    camera.world_from_camera = world_from_camera;
    camera.resolution = resolution;
    return camera;
}

CameraRay generate_ray(const Camera& camera, const Vec2& raster, const Vec2& u_lens, float time)
{
    Vec3 origin(0.0f, 0.0f, 0.0f);
    Vec3 direction;
    switch (camera.kind) {
        case Camera::Kind::perspective: {
            const Vec2 p = window_from_raster(camera, raster);
            const Vec2 lens = lens_point(camera, u_lens);
            const float shift = 1.0f / camera.focal_distance;
            origin = Vec3(lens.x, lens.y, 0.0f);
            direction = Vec3(p.x - lens.x * shift, p.y - lens.y * shift, 1.0f);
            break;
        }
        case Camera::Kind::orthographic: {
            const Vec2 p = window_from_raster(camera, raster);
            const Vec2 lens = lens_point(camera, u_lens);
            const float shift = 1.0f / camera.focal_distance;
            origin = Vec3(p.x + lens.x, p.y + lens.y, 0.0f);
            direction = Vec3(-lens.x * shift, -lens.y * shift, 1.0f);
            break;
        }
        case Camera::Kind::spherical: direction = spherical_from_raster(camera, raster); break;
    }
    return camera.world_from_camera.with(time, [&](const Transform& world_from_camera) {
        CameraRay result;
        result.ray.origin = world_from_camera.point(origin);
        result.ray.direction = normalize(world_from_camera.vector(direction));
        result.ray.time = time;
        return result;
    });
}

namespace {

bool connect_from(const Camera& camera, const Transform& world_from_camera, const Vec3& point, const Vec2& u_lens,
                  float margin, CameraConnection& connection)
{
    const Vec3 p = Transform::apply_point(world_from_camera.inverse_matrix(), point);
    const float det = static_cast<float>(std::abs(determinant3(world_from_camera.matrix())));
    Vec3 origin(0.0f, 0.0f, 0.0f);
    float s;
    const float density = raster_density(camera, p, s);
    if (!(s > 0.0f)) return false;
    if (camera.kind == Camera::Kind::spherical) {
        float unused;
        connection.raster = raster_from_spherical(camera, p * (1.0f / s), unused);
    } else {
        const Vec2 lens = lens_point(camera, u_lens);
        const float inv_focal = 1.0f / camera.focal_distance;
        Vec2 window;
        if (camera.kind == Camera::Kind::perspective) {
            origin = Vec3(lens.x, lens.y, 0.0f);
            window = (Vec2(p.x, p.y) - lens) * (1.0f / s) + lens * inv_focal;
        } else {
            window = Vec2(p.x, p.y) - lens * (1.0f - s * inv_focal);
            origin = Vec3(window.x + lens.x, window.y + lens.y, 0.0f);
        }
        connection.raster = raster_from_window(camera, window);
        if (!inside_image(camera, connection.raster, margin)) return false;
    }
    connection.position = world_from_camera.point(origin);
    // From the difference in camera space: the world positions would lose digits far from the world's origin.
    const Vec3 to_camera = world_from_camera.vector(origin - p);
    connection.distance = length(to_camera);
    if (!(connection.distance > 0.0f)) return false;
    connection.wi = to_camera * (1.0f / connection.distance);
    connection.importance = density * (connection.distance / s) / det;
    return std::isfinite(connection.importance);
}

}  // namespace

bool connect(const Camera& camera, const Vec3& point, const Vec2& u_lens, float time, float margin,
             CameraConnection& connection)
{
    return camera.world_from_camera.with(time, [&](const Transform& world_from_camera) {
        return connect_from(camera, world_from_camera, point, u_lens, margin, connection);
    });
}

float importance_at(const Camera& camera, const Vec3& point, float distance, float time)
{
    return camera.world_from_camera.with(time, [&](const Transform& world_from_camera) {
        const Vec3 p = Transform::apply_point(world_from_camera.inverse_matrix(), point);
        const float det = static_cast<float>(std::abs(determinant3(world_from_camera.matrix())));
        float s;
        const float density = raster_density(camera, p, s);
        return s > 0.0f ? density * (distance / s) / det : 0.0f;
    });
}

float pixel_footprint(const Camera& camera, float distance)
{
    const Transform world_from_camera = camera.world_from_camera.at(0.5f);
    const float det = static_cast<float>(std::abs(determinant3(world_from_camera.matrix())));
    const float axis = length(world_from_camera.vector(Vec3(0.0f, 0.0f, 1.0f)));
    float pixels_per_area;  // facing the camera, as in connect
    if (camera.kind == Camera::Kind::orthographic) {
        pixels_per_area = pixels_per_window_area(camera) * axis / det;
    } else {
        float density = pixels_per_window_area(camera);
        if (camera.kind == Camera::Kind::spherical) raster_from_spherical(camera, Vec3(0.0f, 0.0f, 1.0f), density);
        pixels_per_area = density * axis * axis * axis / (det * distance * distance);
    }
    return 1.0f / std::sqrt(pixels_per_area);
}

}  // namespace dapple
