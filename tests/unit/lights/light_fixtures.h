// One light of each kind, with numbers that make closed forms easy: spectra are constants, in the rgb model.
#pragma once

#include "../media/numbers.h"
#include "dapple/lights/make_light.h"
#include "dapple/math/frame.h"
#include "dapple/math/hash.h"
#include "dapple/spectrum/make_spectrum.h"

#include <string>

namespace dapple::testing_support {

// Mean and standard error of a series.
class Series {
public:
    void add(double value)
    {
        ++count_;
        const double delta = value - mean_;
        mean_ += delta / static_cast<double>(count_);
        squares_ += delta * (value - mean_);
    }
    double mean() const { return mean_; }
    double error() const
    {
        const auto n = static_cast<double>(count_);
        return std::sqrt(squares_ / (n * (n - 1.0)));
    }

private:
    int64_t count_ = 0;
    double mean_ = 0.0, squares_ = 0.0;
};

// A random map with a few bright pixels and a black quarter.
inline Image random_map(int width, int height, int channels)
{
    Image image(width, height, channels);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < channels; ++c) {
                const float value = to_unit_float(hash_words(9, x, y, c));
                image.at(x, y, c) = x < width / 2 && y < height / 2 ? 0.0f : (value > 0.9f ? 20.0f : value);
            }
    return image;
}

struct LightScene {
    SpectrumPool pool;
    Lights lights;
    Wavelengths wavelengths = Wavelengths::rgb();

    LightScene()
    {
        lights.scene_center = Vec3(0.2f, -0.1f, 0.3f);
        lights.scene_radius = 2.5f;
        pool.prepare_rgb(srgb());
    }
    LightId add(Light light, float value)
    {
        light.spectrum = make_constant(value);
        lights.list.push_back(light);
        return LightId(lights.list.size() - 1);
    }
    uint32_t add_image(LightImage image)
    {
        lights.images.push_back(std::move(image));
        return static_cast<uint32_t>(lights.images.size() - 1);
    }
    Light& operator[](LightId id) { return lights.list[id.value]; }
    const Light& operator[](LightId id) const { return lights.list[id.value]; }

    bool direct(LightId id, const Vec3& reference, Numbers& numbers, DirectSample& sample) const
    {
        return sample_direct(lights, pool, id, reference, 0.0f, numbers.next_2d(), wavelengths, sample);
    }
    bool emit(LightId id, Numbers& numbers, EmissionSample& sample) const
    {
        const Vec2 u = numbers.next_2d();
        return sample_emission(lights, pool, id, u, numbers.next_2d(), 0.0f, wavelengths, sample);
    }
};

inline float luminance_of(const Spectrum& rgb) { return 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2]; }

// A light placed at `from`, shining mainly towards the origin.
inline AnimatedTransform shining_at_origin(const Vec3& from) { return AnimatedTransform(look_along(from, -from)); }

inline Primitive sphere_at(const Vec3& center, float radius)
{
    Primitive sphere;
    sphere.kind = Primitive::Kind::sphere;
    sphere.world_from_object = Transform(translation(center));
    sphere.radius = radius;
    sphere.z_min = -radius;
    sphere.z_max = radius;
    return sphere;
}

// A disk at `center` whose outside faces `normal`.
inline Primitive disk_at(const Vec3& center, const Vec3& normal, float radius)
{
    Primitive disk;
    disk.kind = Primitive::Kind::disk;
    disk.world_from_object = look_along(center, normal);
    disk.radius = radius;
    return disk;
}

inline Primitive triangle(const Vec3& a, const Vec3& b, const Vec3& c)
{
    Primitive result;
    result.p[0] = a;
    result.p[1] = b;
    result.p[2] = c;
    return result;
}

struct NamedLight {
    std::string name;
    LightId id;
};

// One light of every kind and shape, each above the origin (far lights all around), with the value 3.
inline std::vector<NamedLight> all_lights(LightScene& scene)
{
    std::vector<NamedLight> result;
    const auto add = [&](const std::string& name, const Light& light) {
        result.push_back({name, scene.add(light, 3.0f)});
    };
    const Vec3 from(0.3f, -0.4f, 1.5f);
    Light light;
    light.world_from_light = shining_at_origin(from);
    light.kind = Light::Kind::point;
    add("point", light);
    light.kind = Light::Kind::spot;
    light.cos_total = std::cos(radians(40));
    light.cos_falloff = std::cos(radians(5));
    add("spot", light);
    light.kind = Light::Kind::distant;
    add("distant", light);
    light.kind = Light::Kind::environment;
    add("environment", light);
    light.kind = Light::Kind::environment_image;
    light.image = scene.add_image(make_environment_image(random_map(16, 16, 3)));
    add("environment_image", light);
    light.kind = Light::Kind::goniometric;
    light.image = scene.add_image(make_goniometric_image(random_map(12, 12, 3)));
    add("goniometric", light);
    light.kind = Light::Kind::projection;
    light.image = scene.add_image(make_projection_image(random_map(9, 6, 3), 70.0f, light));
    add("projection", light);

    Light area;
    area.kind = Light::Kind::area;
    area.shape = triangle(Vec3(-0.5f, 0, 1), Vec3(0.2f, 0.9f, 1.2f), Vec3(0.5f, -0.6f, 1.1f));
    add("triangle", area);
    area.two_sided = true;
    add("two-sided triangle", area);
    area.two_sided = false;
    area.shape = sphere_at(Vec3(0.1f, 0.2f, 1.2f), 0.4f);
    add("sphere", area);
    area.shape = disk_at(from, -from, 0.5f);
    add("disk", area);
    area.alpha = 0.5f;
    add("half transparent disk", area);
    area.alpha = 0.0f;
    add("invisible disk", area);
    area.alpha = 1.0f;
    area.image = scene.add_image(make_area_image(random_map(8, 4, 3)));
    add("disk with image", area);
    return result;
}

}  // namespace dapple::testing_support
