// Media and numbers for the tests of this room.
#pragma once

#include "dapple/media/medium.h"
#include "dapple/spectrum/make_spectrum.h"
#include "numbers.h"

namespace dapple::testing_support {

// A medium of random density with empty regions in a rotated, stretched box, of 12 x 7 x 40 samples.
struct GridScene {
    SpectrumPool pool;
    Media media;
    Medium medium;
    Transform world_from_medium;

    explicit GridScene(Medium::Kind kind = Medium::Kind::uniform_grid)
    {
        world_from_medium =
            Transform(translation(Vec3(0.3f, -2, 1)) * rotation(40, Vec3(1, 2, 3)) * scaling(Vec3(1, 2, 0.7f)));
        medium.kind = kind;
        medium.medium_from_world = world_from_medium.inverse();
        medium.grid_bounds = Box3(Vec3(-1, -0.5f, 0), Vec3(1, 1, 3));
        const int channels = kind == Medium::Kind::uniform_grid ? 1 : 3;
        Grid grid{12, 7, 40, channels, {}};
        for (int i = 0; i < 12 * 7 * 40 * channels; ++i) {
            const float value = to_unit_float(mix64(static_cast<uint64_t>(i)));
            const bool empty = (i / channels / (12 * 7)) % 20 > 13;
            grid.values.push_back(empty ? 0.0f : 3.0f * value * value);
        }
        media.grids.push_back(grid);
        if (kind == Medium::Kind::uniform_grid) {
            medium.density = 0;
            medium.sigma_a = make_unbounded(pool, srgb(), Vec3(0.1f, 0.5f, 0.9f));
            medium.sigma_s = make_constant(0.4f);
        } else {
            for (float& value : grid.values) value = 1.5f - 0.5f * value;
            media.grids.push_back(grid);
            medium.sigma_a_grid = 0;
            medium.sigma_s_grid = 1;
            medium.sigma_scale = 0.7f;
        }
        pool.prepare_rgb(srgb());
        build_majorants(media, medium);
    }

    Spectrum sigma_t(const Vec3& p, const Wavelengths& wavelengths) const
    {
        const MediumPoint point = evaluate(media, pool, medium, p, wavelengths);
        return point.sigma_a + point.sigma_s;
    }

    // A ray that starts within a few metres of the box, inside or outside, towards a point in it.
    Ray random_ray(Numbers& numbers) const
    {
        Ray ray;
        ray.origin = Vec3(numbers.next(), numbers.next(), numbers.next()) * 8.0f - Vec3(4, 6, 3);
        const Vec3 inside(lerp(numbers.next(), -1, 1), lerp(numbers.next(), -0.5f, 1), 3 * numbers.next());
        ray.direction = normalize(world_from_medium.point(inside) - ray.origin);
        return ray;
    }
};

}  // namespace dapple::testing_support
