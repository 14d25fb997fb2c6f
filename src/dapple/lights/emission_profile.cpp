// Lookups in the images of lights (see emission_profile.h). Cost: one pixel, and the upsampling of its colour.

#include "dapple/lights/emission_profile.h"

namespace dapple::lights_detail {

namespace {

int pixel_index(float coordinate, int n)
{
    return std::clamp(static_cast<int>(coordinate * static_cast<float>(n)), 0, n - 1);
}

}  // namespace

Spectrum image_spectrum(const LightImage& image, const SpectrumPool& pool, const Vec2& uv,
                        const Wavelengths& wavelengths)
{
    const int x = pixel_index(uv.x, image.pixels.width);
    const int y = pixel_index(uv.y, image.pixels.height);
    if (image.pixels.channels == 1) return Spectrum(image.pixels.at(x, y, 0));
    const Vec3 rgb(image.pixels.at(x, y, 0), image.pixels.at(x, y, 1), image.pixels.at(x, y, 2));
    return pool.evaluate_rgb(RgbUse::unbounded, rgb, wavelengths);
}

Spectrum relative_intensity(const Lights& lights, const SpectrumPool& pool, const Light& light, const Vec3& w,
                            const Wavelengths& wavelengths)
{
    switch (light.kind) {
        case Light::Kind::spot: return Spectrum(spot_falloff(light, w.z));
        case Light::Kind::goniometric:
            return image_spectrum(lights.images[light.image], pool, equal_area_sphere_to_square(w), wavelengths);
        case Light::Kind::projection: {
            Vec2 uv;
            if (!projection_uv(light, w, uv)) return Spectrum(0.0f);
            return image_spectrum(lights.images[light.image], pool, uv, wavelengths);
        }
        default: return Spectrum(1.0f);
    }
}

Spectrum area_radiance(const Lights& lights, const SpectrumPool& pool, const Light& light, const Vec2& uv,
                       const Wavelengths& wavelengths)
{
    const Spectrum radiance = pool.evaluate(light.spectrum, wavelengths);
    if (!has_image(light)) return radiance;
    // Images lie on the unit square of (u, v), top at v = 1, and repeat.
    const Vec2 wrapped(uv.x - std::floor(uv.x), 1.0f - (uv.y - std::floor(uv.y)));
    return radiance * image_spectrum(lights.images[light.image], pool, wrapped, wavelengths);
}

}  // namespace dapple::lights_detail
