// Cameras: rays from the sensor, and the sensor seen from the scene (importance), for every kind both ways.
// Raster coordinates: pixels, (0,0) the top left corner of the full image, y down. Camera space as in pbrt: x right,
// y up, looking along +z; the spherical camera has its pole along +y. Reflecting and scaling camera transforms are
// allowed, as pbrt's scenes use them.
#pragma once

#include "dapple/math/ray.h"
#include "dapple/math/transform.h"

#include <cstdint>
#include <optional>

namespace dapple {

struct Camera {
    enum class Kind : uint8_t { perspective, orthographic, spherical };
    enum class SphericalMapping : uint8_t { equirectangular, equal_area };
    Kind kind = Kind::perspective;
    SphericalMapping mapping = SphericalMapping::equal_area;
    AnimatedTransform world_from_camera;
    Int2 resolution{1280, 720};
    Box2 screen_window{Vec2(-1, -1),
                       Vec2(1, 1)};  // on the plane z = 1 (perspective: scaled by tan(fov/2)) [camera units]
    float lens_radius = 0.0f;        // 0: pinhole; spherical cameras have no lens
    float focal_distance = 1e6f;     // z of the plane in focus [camera units]
    float shutter_open = 0.0f, shutter_close = 1.0f;  // [s]; ray times are in [0,1] over the interval
};

// The makers below build cameras from a scene's parameters. frame_aspect is the width of the image over its height in
// space (nothing: that of the pixels); screen_window replaces the window [-a,a] x [-1,1] (or [-1,1] x [-1/a,1/a] when
// the aspect a is below 1) that follows from it. They throw nothing; the parameters must make sense (positive
// resolution and aspect, 0 < fov < 180, a window with an area), which whoever reads the scene checks.

// Pinhole or thin lens; fov_degrees is the angle that the window's [-1,1] spans, the shorter axis of the image.
Camera make_perspective(const AnimatedTransform& world_from_camera, const Int2& resolution, float fov_degrees,
                        std::optional<float> frame_aspect = {}, const std::optional<Box2>& screen_window = {},
                        float lens_radius = 0.0f, float focal_distance = 1e6f);
// Parallel projection; with a lens every point of the plane of focus is sharp and the projection stays parallel
// (telecentric). pbrt instead sends all rays through one lens at the origin, which turns the view into a perspective.
Camera make_orthographic(const AnimatedTransform& world_from_camera, const Int2& resolution,
                         std::optional<float> frame_aspect = {}, const std::optional<Box2>& screen_window = {},
                         float lens_radius = 0.0f, float focal_distance = 1e6f);
// All directions around a point.
Camera make_spherical(const AnimatedTransform& world_from_camera, const Int2& resolution,
                      Camera::SphericalMapping mapping);

struct CameraRay {
    Ray ray;              // unit direction in world space, carrying the time given
    float weight = 1.0f;  // 1 for all kinds here
};
// The ray through a raster position; u_lens in [0,1)^2, time in [0,1].
CameraRay generate_ray(const Camera& camera, const Vec2& raster, const Vec2& u_lens, float time);

// The sensor as seen from a scene point.
struct CameraConnection {
    Vec2 raster{0, 0};
    Vec3 wi{0, 0, 1};        // unit, from the point to the camera
    float distance = 0.0f;   // to the lens point (orthographic: along wi to the camera plane) [m]
    Vec3 position{0, 0, 0};  // the lens point (orthographic: where the line of sight meets the camera plane)
    // Importance [pixel/m^2]: a particle of flux Phi at a vertex with BSDF f contributes
    //     f * |cos at the vertex| * Phi * importance
    // to the pixel around `raster`, and an emitting surface element dA of radiance L contributes
    //     L * |cos at the element| * dA * importance,
    // so that pixels become mean radiances: the raster area per area facing the camera at the point. For a pinhole that
    // is the raster area per solid angle over the squared distance. No cosine at the vertex is included.
    float importance = 0.0f;
};
// False when the point is behind the camera or outside the image (by more than `margin` pixels). For one uniform u_lens
// and a uniform time the connection is an unbiased sample of the pixels' mean over lens and shutter. The images of
// spherical cameras are closed: the raster is inside always and the margin unused.
bool connect(const Camera& camera, const Vec3& point, const Vec2& u_lens, float time, float margin,
             CameraConnection& connection);

// CameraConnection::importance at a point that an eye ray of generate_ray has met `distance` away from its origin: the
// raster area per area facing the camera there, so that importance * |cos at the point| is the density per area with
// which one eye ray per pixel meets it.
float importance_at(const Camera& camera, const Vec3& point, float distance, float time);

// Width on a surface at `distance` from the camera, facing it, that one pixel covers [m]: the scale of default radii.
// It is the root of the area a pixel covers at the middle of the image (spherical: on the horizon), at half time.
float pixel_footprint(const Camera& camera, float distance);

}  // namespace dapple
