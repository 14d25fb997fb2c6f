// Solid angles are those of the maps themselves: 4 pi / n per texel of the equal-area map, and for projectors the
// closed form of a rectangle seen from a point. Luminance is that of linear sRGB (ITU-R BT.709).

#include "dapple/lights/make_light.h"

#include "dapple/base/parallel.h"
#include "dapple/lights/emission_profile.h"

#include <string>

namespace dapple {

namespace {

// Keeps 1 or 3 channels of finite values >= 0.
Image checked(Image image, const SourceLocation& where)
{
    if (image.empty()) throw UserError(where, "the image of a light is empty");
    const int channels = image.channels >= 3 ? 3 : 1;
    Image out(image.width, image.height, channels);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < channels; ++c) {
                const float value = image.at(x, y, c);
                if (!std::isfinite(value))
                    throw UserError(where, "the image of a light holds infinite values or NaN, at pixel " +
                                               std::to_string(x) + ", " + std::to_string(y));
                out.at(x, y, c) = std::max(0.0f, value);
            }
    return out;
}

void require_square(const Image& image, const SourceLocation& where)
{
    if (image.width == image.height) return;
    throw UserError(where, "the map of directions has " + std::to_string(image.width) + " x " +
                               std::to_string(image.height) + " pixels; an equal-area map is square");
}

float mean_of_channels(const Image& image, int x, int y)
{
    if (image.channels == 1) return image.at(x, y, 0);
    return (image.at(x, y, 0) + image.at(x, y, 1) + image.at(x, y, 2)) / 3.0f;
}

float luminance(const Vec3& rgb) { return 0.2126f * rgb.x + 0.7152f * rgb.y + 0.0722f * rgb.z; }

float luminance(const Image& image, int x, int y)
{
    if (image.channels == 1) return image.at(x, y, 0);
    return luminance(Vec3(image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)));
}

// With the share of each pixel in the solid angle (or area) of the whole, times the number of pixels.
template <class Share>
LightImage make_light_image(Image pixels, const Share& share)
{
    LightImage result;
    std::vector<float> weights(size_t(pixels.width) * pixels.height);
    double sum = 0.0;
    for (int y = 0; y < pixels.height; ++y)
        for (int x = 0; x < pixels.width; ++x) {
            const double s = share(x, y);
            weights[size_t(y) * pixels.width + x] = static_cast<float>(s * mean_of_channels(pixels, x, y));
            sum += s * luminance(pixels, x, y);
        }
    result.distribution = Distribution2D(weights, pixels.width, pixels.height);
    result.mean_luminance = static_cast<float>(sum / static_cast<double>(weights.size()));
    result.pixels = std::move(pixels);
    return result;
}

LightImage make_uniform_light_image(Image pixels)
{
    return make_light_image(std::move(pixels), [](int, int) { return 1.0; });
}

// Solid angle of the rectangle between the origin's foot and (x, y) on the plane z = 1, with the sign of x y.
double corner_solid_angle(double x, double y) { return std::atan(x * y / std::sqrt(1.0 + x * x + y * y)); }

double rectangle_solid_angle(double x0, double x1, double y0, double y1)
{
    return corner_solid_angle(x1, y1) - corner_solid_angle(x0, y1) - corner_solid_angle(x1, y0) +
           corner_solid_angle(x0, y0);
}

double projector_solid_angle(const Light& light)
{
    return 4.0 * corner_solid_angle(light.screen_half[0], light.screen_half[1]);
}

// Bilinear, around the circle in x, up to the poles in y.
void lookup_latlong(const Image& image, const Vec3& d, float* sum)
{
    const float fraction = std::atan2(d.y, d.x) * (0.5f * inv_pi);
    const float phi = fraction < 0.0f ? fraction + 1.0f : fraction;
    const float theta = angle_between(d, Vec3(0, 0, 1)) * inv_pi;
    const float x = phi * static_cast<float>(image.width) - 0.5f, y = theta * static_cast<float>(image.height) - 0.5f;
    const float left = std::floor(x), top = std::floor(y);
    for (int dy = 0; dy < 2; ++dy)
        for (int dx = 0; dx < 2; ++dx) {
            const float weight = (dx ? x - left : 1.0f - (x - left)) * (dy ? y - top : 1.0f - (y - top));
            const int ix = (static_cast<int>(left) + dx + image.width) % image.width;
            const int iy = std::clamp(static_cast<int>(top) + dy, 0, image.height - 1);
            for (int c = 0; c < image.channels; ++c) sum[c] += weight * image.at(ix, iy, c);
        }
}

}  // namespace

Transform look_along(const Vec3& from, const Vec3& direction)
{
    const Frame frame(normalize(direction));
    Matrix4 m;
    for (int row = 0; row < 3; ++row) {
        m.m[row][0] = frame.s[row];
        m.m[row][1] = frame.t[row];
        m.m[row][2] = frame.n[row];
        m.m[row][3] = from[row];
    }
    return Transform(m);
}

LightImage make_environment_image(Image pixels, const SourceLocation& where)
{
    require_square(pixels, where);
    return make_uniform_light_image(checked(std::move(pixels), where));
}

LightImage make_goniometric_image(Image pixels, const SourceLocation& where)
{
    require_square(pixels, where);
    pixels = checked(std::move(pixels), where);
    Image grey(pixels.width, pixels.height, 1);
    for (int y = 0; y < pixels.height; ++y)
        for (int x = 0; x < pixels.width; ++x) grey.at(x, y, 0) = mean_of_channels(pixels, x, y);
    return make_uniform_light_image(std::move(grey));
}

LightImage make_projection_image(Image pixels, float fov, Light& light, const SourceLocation& where)
{
    pixels = checked(std::move(pixels), where);
    const double half = std::tan(0.5 * radians(fov));
    const double aspect = static_cast<double>(pixels.width) / pixels.height;
    const double half_x = half * std::max(1.0, aspect), half_y = half * std::max(1.0, 1.0 / aspect);
    light.screen_half[0] = static_cast<float>(half_x);
    light.screen_half[1] = static_cast<float>(half_y);
    const double step_x = 2.0 * half_x / pixels.width, step_y = 2.0 * half_y / pixels.height;
    const double mean = projector_solid_angle(light) / (static_cast<double>(pixels.width) * pixels.height);
    return make_light_image(std::move(pixels), [&](int x, int y) {
        return rectangle_solid_angle(x * step_x - half_x, (x + 1) * step_x - half_x, y * step_y - half_y,
                                     (y + 1) * step_y - half_y) /
               mean;
    });
}

LightImage make_area_image(Image pixels, const SourceLocation& where)
{
    return make_uniform_light_image(checked(std::move(pixels), where));
}

bool is_latlong(const Image& image) { return !image.empty() && image.width == 2 * image.height; }

Image equal_area_from_latlong(const Image& latlong)
{
    // Texels of 4 pi / n^2 against (pi / height)^2 at the equator.
    const int n = std::max(1, static_cast<int>(std::ceil(2.0f / std::sqrt(pi) * static_cast<float>(latlong.height))));
    constexpr int samples = 4;
    Image out(n, n, latlong.channels);
    parallel_for(n, 8, [&](int64_t y) {
        for (int x = 0; x < n; ++x) {
            float* pixel = &out.at(x, static_cast<int>(y), 0);
            for (int j = 0; j < samples; ++j)
                for (int i = 0; i < samples; ++i) {
                    const float u = (static_cast<float>(x * samples + i) + 0.5f) / static_cast<float>(n * samples);
                    const float v = (static_cast<float>(y * samples + j) + 0.5f) / static_cast<float>(n * samples);
                    lookup_latlong(latlong, equal_area_square_to_sphere({u, v}), pixel);
                }
            for (int c = 0; c < out.channels; ++c) pixel[c] /= samples * samples;
        }
    });
    return out;
}

float power_factor(const Light& light, const Lights& lights)
{
    const float mean = lights_detail::has_image(light) ? lights.images[light.image].mean_luminance : 1.0f;
    const float disc = pi * sqr(lights.scene_radius);
    switch (light.kind) {
        case Light::Kind::point: return 4.0f * pi;
        case Light::Kind::spot: return lights_detail::spot_core(light) + lights_detail::spot_rim(light);
        case Light::Kind::distant: return disc;
        case Light::Kind::area: return pi * area(light.shape.primitive) * (light.two_sided ? 2.0f : 1.0f) * mean;
        case Light::Kind::environment: return 4.0f * pi * disc;
        case Light::Kind::environment_image: return 4.0f * pi * disc * mean;
        case Light::Kind::goniometric: return 4.0f * pi * mean;
        case Light::Kind::projection: return static_cast<float>(projector_solid_angle(light)) * mean;
    }
    return 0.0f;
}

float illuminance_factor(const Light& light, const Lights& lights)
{
    if (light.kind == Light::Kind::distant) return 1.0f;
    if (light.kind == Light::Kind::environment) return pi;
    const Image& image = lights.images[light.image].pixels;
    // Texels that the horizon cuts need several points; fine maps have few of them.
    const int samples = std::max(1, 256 / image.width);
    double sum = 0.0;
    for (int y = 0; y < image.height * samples; ++y)
        for (int x = 0; x < image.width * samples; ++x) {
            const Vec2 uv((static_cast<float>(x) + 0.5f) / static_cast<float>(image.width * samples),
                          (static_cast<float>(y) + 0.5f) / static_cast<float>(image.height * samples));
            const float cosine = equal_area_square_to_sphere(uv).z;
            if (cosine > 0.0f) sum += cosine * luminance(image, x / samples, y / samples);
        }
    const double count = static_cast<double>(image.width) * image.height * samples * samples;
    return static_cast<float>(4.0 * pi * sum / count);
}

float power(const Lights& lights, const SpectrumPool&, LightId id)
{
    const Light& light = lights.list[id.value];
    const float alpha = light.kind == Light::Kind::area && light.alpha > 0.0f ? light.alpha : 1.0f;
    return std::max(0.0f, luminance(light.spectrum.rgb)) * power_factor(light, lights) * alpha;
}

}  // namespace dapple
