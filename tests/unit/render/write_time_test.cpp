// What is known of writing before it is done. How long it takes is measured by bench/time_limit.py.
#include "dapple/render/write_time.h"

#include "dapple/image/zip_time.h"

#include <gtest/gtest.h>

#include <random>

namespace dapple {
namespace {

Image noise(int width, int height, int channels)
{
    Image image(width, height, channels);
    std::minstd_rand random;
    for (float& value : image.pixels) value = static_cast<float>(random()) * 0x1p-31f;
    return image;
}

TEST(WriteTime, LiesBetweenThatOfBlackAndThatOfNoise)
{
    const Image black(400, 16, 6), noisy = noise(400, 16, 6);
    EXPECT_GT(zip_seconds(black), 0.0);
    EXPECT_GT(zip_seconds(noisy), 0.0);
    WriteTime time;
    time.black = 1;
    time.noise = 3;
    // Rows that take no time at all, and all the time that there is.
    time.zip_black = 1e3;
    time.zip_noise = 2e3;
    EXPECT_EQ(time.seconds(noisy), 1.0);
    time.zip_black = 0;
    time.zip_noise = 1e-12;
    EXPECT_EQ(time.seconds(black), 3.0);
}

// Nothing is known of files that could not be tried out.
TEST(WriteTime, IsNothingWithoutATrial)
{
    EXPECT_EQ(WriteTime().seconds(noise(10, 10, 3)), 0.0);
    EXPECT_EQ(WriteTime().expected(), 0.0);
}

TEST(WriteTime, IsTriedOutWithTheLayersOfTheFilm)
{
    FilmSettings film;
    film.resolution = film.crop_max = Int2(300, 200);
    const WriteTime time = time_to_write({"image.exr"}, film, false);
    EXPECT_GT(time.layers, 0.0);
    EXPECT_GT(time.black, time.layers);
    EXPECT_GE(time.noise, time.black);
    EXPECT_GT(time.zip_noise, 0.0);
}

}  // namespace
}  // namespace dapple
