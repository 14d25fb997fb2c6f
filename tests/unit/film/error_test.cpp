// Error estimates of the film against passes whose noise and bias are known.
#include "dapple/film/film.h"
#include "dapple/math/hash.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace dapple {
namespace {

constexpr int width = 32, height = 32;

FilmSettings settings_with(uint32_t batch, bool fading = false, uint32_t first_pass = 0)
{
    FilmSettings settings;
    settings.resolution = settings.crop_max = {width, height};
    settings.guide_layers = false;
    settings.error_layer = true;
    settings.first_pass = first_pass;
    settings.correlated_passes = batch;
    settings.fading_bias = fading;
    if (fading) settings.bias_scale = [batch](uint32_t pass) { return std::cbrt(1.0 / (1 + pass / batch)); };
    return settings;
}

// Uniform in [-1, 1), of variance 1/3.
float noise(uint32_t pass, int x, int y) { return 2 * to_unit_float(hash_words(pass, x, y)) - 1; }

template <class Value>
void add_passes(Film& film, uint32_t count, const Value& value)
{
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t pass = film.settings().first_pass + film.passes();
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                PixelSample sample(0);
                sample.add(Vec3(value(pass, x, y)), PathClass::direct, LightGroup(0));
                film.add_pixel({x, y}, sample, 1);
            }
        film.end_pass();
    }
}

double mean_of(const Film& film, const std::string& name)
{
    std::vector<std::string> names;
    const Image image = film.layers(names);
    const auto channel = std::find(names.begin(), names.end(), name) - names.begin();
    EXPECT_LT(channel, static_cast<std::ptrdiff_t>(names.size())) << name;
    double sum = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) sum += image.at(x, y, static_cast<int>(channel));
    return sum / (width * height);
}

const float scale_of_two = std::sqrt(1.01f) * 2.0f;  // sqrt(m^2 + (0.1 M)^2) of a grey image of 2

TEST(FilmError, NoiseIsTheStandardErrorOfTheMean)
{
    Film film(settings_with(1));
    add_passes(film, 300, [](uint32_t pass, int x, int y) { return 2 + 0.5f * noise(pass, x, y); });
    const double expected = 0.5 * std::sqrt(1.0 / 3 / 300) / scale_of_two;
    EXPECT_NEAR(film.error().noise, expected, 0.02 * expected);
    EXPECT_NEAR(mean_of(film, "error.noise"), expected, 0.02 * expected);
    EXPECT_EQ(film.error().bias, 0.0);
    EXPECT_EQ(film.error().batches, 300u);
}

TEST(FilmError, CorrelatedPassesCountAsOne)
{
    const auto value = [](uint32_t pass, int x, int y) { return 2 + 0.5f * noise(pass / 4, x, y); };
    Film film(settings_with(4)), naive(settings_with(1));
    add_passes(film, 400, value);
    add_passes(naive, 400, value);
    const double expected = 0.5 * std::sqrt(1.0 / 3 / 100) / scale_of_two;
    EXPECT_NEAR(film.error().noise, expected, 0.03 * expected);
    EXPECT_NEAR(naive.error().noise, expected / 2, 0.03 * expected);
}

TEST(FilmError, FadingBiasIsFoundAmongNoise)
{
    // In the left half light fades by 0.3 x(pass), in the right one it grows.
    const auto value = [](uint32_t pass, int x, int y) {
        const auto bias = static_cast<float>(0.3 * std::cbrt(1.0 / (1 + pass / 4)));
        return 2 + (x < width / 2 ? bias : -bias) + 0.1f * noise(pass / 4, x, y);
    };
    Film film(settings_with(4, true)), unbiased(settings_with(4, true));
    add_passes(film, 400, value);
    double left = 0;
    for (int epoch = 1; epoch <= 100; ++epoch) left += 0.3 * std::cbrt(1.0 / epoch) / 100;
    EXPECT_NEAR(film.error().bias, left / scale_of_two, 0.1 * left / scale_of_two);
    std::vector<std::string> names;
    const Image image = film.layers(names);
    ASSERT_EQ(names.back(), "error.bias");
    EXPECT_GT(image.at(0, 0, image.channels - 1), 0.8 * left / scale_of_two);
    EXPECT_LT(image.at(width - 1, 0, image.channels - 1), -0.8 * left / scale_of_two);

    add_passes(unbiased, 400, [](uint32_t pass, int x, int y) { return 2 + 0.1f * noise(pass / 4, x, y); });
    EXPECT_LT(unbiased.error().bias, 0.1 * film.error().bias);
}

TEST(FilmError, MergedAndResumedFilmsHaveTheBitsOfOne)
{
    const auto value = [](uint32_t pass, int x, int y) { return 2 + noise(pass, x, y); };
    const uint32_t batch = 4;
    Film whole(settings_with(batch, true));
    add_passes(whole, 23, value);

    // Cut within batches, merged out of order, by way of bytes.
    Film merged(settings_with(batch, true, 6));
    add_passes(merged, 7, value);
    for (const auto& [first, count] : {std::pair{17u, 2u}, {0u, 6u}, {13u, 4u}}) {
        Film part(settings_with(batch, true, first)), copy(settings_with(batch, true));
        add_passes(part, count, value);
        std::stringstream bytes;
        part.write_state(bytes);
        copy.read_state(bytes);
        merged.merge(copy);
    }
    std::stringstream bytes;
    merged.write_state(bytes);
    Film resumed(settings_with(batch, true));
    resumed.read_state(bytes);
    add_passes(resumed, 4, value);

    std::vector<std::string> names;
    EXPECT_EQ(resumed.layers(names).pixels, whole.layers(names).pixels);
    EXPECT_EQ(resumed.error().noise, whole.error().noise);
    EXPECT_EQ(resumed.error().bias, whole.error().bias);
    EXPECT_GT(whole.error().noise, 0.0);
    std::stringstream one, other;
    whole.write_state(one);
    resumed.write_state(other);
    EXPECT_EQ(one.str(), other.str());
}

TEST(FilmError, TooFewBatchesAndBlackImagesAreNoAccident)
{
    Film film(settings_with(4));
    EXPECT_EQ(mean_of(film, "error.noise"), 1.0);
    add_passes(film, 7, [](uint32_t, int, int) { return 0.0f; });
    EXPECT_EQ(mean_of(film, "error.noise"), 1.0);
    add_passes(film, 5, [](uint32_t, int, int) { return 0.0f; });
    EXPECT_EQ(mean_of(film, "error.noise"), 0.0);
    EXPECT_EQ(film.error().total(), 0.0);
}

}  // namespace
}  // namespace dapple
