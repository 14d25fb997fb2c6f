// Cameras: rays from the sensor, and the sensor seen from the scene (importance), for every kind both ways.
// Raster coordinates: pixels, (0,0) the top left corner of the full image, y down.
#pragma once

#include "dapple/math/ray.h"
#include "dapple/math/transform.h"

#include <cstdint>

namespace dapple {

struct Camera {
    enum class Kind : uint8_t { perspective, orthographic, spherical };
    enum class SphericalMapping : uint8_t { equirectangular, equal_area };
    Kind kind = Kind::perspective;
    SphericalMapping mapping = SphericalMapping::equal_area;
    AnimatedTransform world_from_camera;
    Int2 resolution{1280, 720};
    Box2 screen_window{Vec2(-1, -1), Vec2(1, 1)};  // on the plane z = 1 (perspective: scaled by tan(fov/2)) [camera units]
    float lens_radius = 0.0f;
    float focal_distance = 1e6f;
    float shutter_open = 0.0f, shutter_close = 1.0f;  // [s]; ray times are in [0,1] over the interval
};

struct CameraRay {
    Ray ray;
    float weight = 1.0f;  // 1 for all kinds here
};
// The ray through a raster position; u_lens in [0,1)^2, time in [0,1].
CameraRay generate_ray(const Camera& camera, const Vec2& raster, const Vec2& u_lens, float time);

// The sensor as seen from a scene point.
struct CameraConnection {
    Vec2 raster{0, 0};
    Vec3 wi{0, 0, 1};       // unit, from the point to the camera
    float distance = 0.0f;  // to the lens point (orthographic: to the camera plane)
    Vec3 position{0, 0, 0}; // the lens point
    // Importance: a particle of flux Phi at a vertex with BSDF f contributes  f * |cos at the vertex| * Phi * importance
    // to the pixel integral around `raster` [pixel^2 sr^-1 .. so that the mean radiance of pixels results]: the raster
    // area per solid angle, over squared distance (orthographic: raster area per area).
    float importance = 0.0f;
};
// False when the point is behind the camera or outside the image (by more than `margin` pixels).
bool connect(const Camera& camera, const Vec3& point, const Vec2& u_lens, float time, float margin,
             CameraConnection& connection);

// Width on a surface at `distance` from the camera, facing it, that one pixel covers [m]: the scale of default radii.
float pixel_footprint(const Camera& camera, float distance);

}  // namespace dapple
