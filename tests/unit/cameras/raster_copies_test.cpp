#include "dapple/cameras/raster_copies.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

// All copies see the same direction, and where the filter of a border pixel reaches out there is exactly one copy of
// everything: a grid over the image and its margin is the set of copies of the grid over the image.
TEST(RasterCopies, CoverTheMarginOfClosedImagesOnce)
{
    for (const auto mapping : {Camera::SphericalMapping::equirectangular, Camera::SphericalMapping::equal_area}) {
        const Camera camera = make_spherical(AnimatedTransform(Transform()), Int2(16, 8), mapping);
        constexpr int margin = 3;
        constexpr int width = 16 + 2 * margin, height = 8 + 2 * margin;
        std::array<int, width * height> found{};
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 16; ++x) {
                const Vec2 raster(x + 0.375f, y + 0.375f);
                const Vec3 seen = generate_ray(camera, raster, Vec2(0.5f), 0.5f).ray.direction;
                for (const Vec2& copy : raster_copies(camera, raster, margin)) {
                    const Vec3 again = generate_ray(camera, copy, Vec2(0.5f), 0.5f).ray.direction;
                    EXPECT_LT(length(again - seen), 1e-3f) << x << ' ' << y << " at " << copy.x << ' ' << copy.y;
                    const int column = static_cast<int>(std::floor(copy.x)) + margin;
                    const int row = static_cast<int>(std::floor(copy.y)) + margin;
                    ASSERT_TRUE(column >= 0 && column < width && row >= 0 && row < height);
                    ++found[static_cast<size_t>(row * width + column)];
                }
            }
        for (const int times : found) EXPECT_EQ(times, 1);
    }
}

TEST(RasterCopies, OfOpenImagesAreNone)
{
    const Camera camera = make_perspective(AnimatedTransform(Transform()), Int2(16, 8), 40.0f);
    EXPECT_EQ(raster_copies(camera, Vec2(0.1f, 0.1f), 3.0f).count, 1);
}

}  // namespace
}  // namespace dapple
