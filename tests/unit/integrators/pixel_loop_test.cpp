// The two orders of a pass's pixels.
#include "dapple/integrators/pixel_loop.h"

#include "../transport/small_scene.h"

#include <mutex>
#include <vector>

namespace dapple {
namespace {

constexpr int width = 37, height = 22;

FilmSettings cropped()
{
    FilmSettings settings;
    settings.resolution = {width + 5, height + 3};
    settings.crop_min = {3, 1};
    settings.crop_max = {3 + width, 1 + height};
    settings.sensor = make_sensor("cie1931", "srgb", 0.0f, 1.0f);
    return settings;
}

// How often each pixel of the crop window was traced, and what its random numbers began with.
struct Trace {
    std::vector<int> count = std::vector<int>(width * height, 0);
    std::vector<Vec2> numbers = std::vector<Vec2>(width * height);
    int traced = 0;
};

std::unique_ptr<World> floor_world()
{
    test::SmallScene scene;
    scene.square(0.0f, 20.0f, scene.material(scene::DiffuseMaterial{}));
    return scene.world();
}

// Cancelled after `limit` pixels.
Trace trace(bool coarse_to_fine, int limit = width * height)
{
    const auto world = floor_world();
    Film film(cropped());
    Statistics statistics;
    std::atomic<bool> cancel{false};
    const PassContext context{*world, 1, 0, statistics, &cancel, coarse_to_fine};
    Trace result;
    std::mutex mutex;
    for_each_pixel(
        context, film, [](Int2, RandomStream&) { return Wavelengths::rgb(); },
        [&](EyeSample& sample) {
            const std::lock_guard lock(mutex);
            const Int2 local = sample.pixel - film.settings().crop_min;
            const auto i = static_cast<size_t>(local.y * width + local.x);
            ++result.count[i];
            result.numbers[i] = sample.raster + sample.random.next_2d();
            if (++result.traced == limit) cancel = true;
        });
    return result;
}

TEST(PixelLoop, CoarseToFineIsAMatterOfOrder)
{
    const Trace rows = trace(false), rounds = trace(true);
    EXPECT_EQ(rows.count, std::vector<int>(width * height, 1));
    EXPECT_EQ(rounds.count, rows.count);
    EXPECT_EQ(rounds.numbers, rows.numbers);
}

// Every so-manieth round, each block of pixels has as many samples as any other.
TEST(PixelLoop, EveryRoundReachesAllParts)
{
    for (const int step : {4, 2}) {  // after the first round, and after the fourth
        const int blocks = ((width + step - 1) / step) * ((height + step - 1) / step);
        const Trace begun = trace(true, blocks);
        EXPECT_EQ(begun.traced, blocks);
        for (int y = 0; y < height; y += step)
            for (int x = 0; x < width; x += step) {
                int in_block = 0;
                for (int v = y; v < std::min(y + step, height); ++v)
                    for (int u = x; u < std::min(x + step, width); ++u)
                        in_block += begun.count[static_cast<size_t>(v * width + u)];
                EXPECT_EQ(in_block, 1) << step << " at " << x << ' ' << y;
            }
    }
}

}  // namespace
}  // namespace dapple
