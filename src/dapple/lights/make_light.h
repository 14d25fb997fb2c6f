// Making lights while a scene is compiled: their images with the distributions to sample them, their frames, and the
// factors behind the photometric parameters `power` and `illuminance`. Cold code.
#pragma once

#include "dapple/base/error.h"
#include "dapple/lights/light.h"

namespace dapple {

// The rotation and translation whose origin is `from` and whose z axis points along `direction` (any length but 0):
// what a spot, projection or distant light shines along.
Transform look_along(const Vec3& from, const Vec3& direction);

// The map of an environment light, from an equal-area octahedral image (1, 3 or more channels; those after the third
// are dropped, of two the second). Throws a UserError at `where` when it is not square, or holds infinities or NaN;
// negative values become 0.
LightImage make_environment_image(Image pixels, const SourceLocation& where = {});

// The same for a goniometric light, whose map is one number per direction: the mean of the channels.
LightImage make_goniometric_image(Image pixels, const SourceLocation& where = {});

// The image of a projection light whose shorter side spans `fov` degrees (0 < fov < 180); sets light.screen_half.
LightImage make_projection_image(Image pixels, float fov, Light& light, const SourceLocation& where = {});

// The image that an area light shows over its (u, v).
LightImage make_area_image(Image pixels, const SourceLocation& where = {});

// Whether an image has the shape of a latitude-longitude map (2 : 1).
bool is_latlong(const Image& image);

// Resamples a latitude-longitude map (top row z = +1, left edge phi = 0, the direction +x, then towards +y) to an
// equal-area octahedral one of about the same number of pixels per solid angle at the equator. Each pixel is the mean
// of 4 x 4 bilinear lookups.
Image equal_area_from_latlong(const Image& latlong);

// The flux [W/nm or lm] that the light emits per unit of its spectrum (radiance, intensity or, for distant lights,
// irradiance), exactly the mean of EmissionSample::flux; colour images count by their luminance, alpha not at all. Far
// lights: the flux through the disc of the scene's bounding sphere. Dividing by it gives pbrt's parameter `power` its
// meaning.
float power_factor(const Light& light, const Lights& lights);

// The irradiance that a distant light of unit spectrum makes on a surface facing it, or an environment on the plane
// z = 0 of its own space from above. Dividing by it gives the parameter `illuminance` its meaning. (pbrt-v4 has half
// of this for image environments.)
float illuminance_factor(const Light& light, const Lights& lights);

}  // namespace dapple
