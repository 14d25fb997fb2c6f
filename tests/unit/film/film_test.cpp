#include "dapple/film/film.h"

#include "dapple/base/error.h"
#include "dapple/math/hash.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <thread>

namespace dapple {
namespace {

FilmSettings small_film(int width = 12, int height = 8)
{
    FilmSettings settings;
    settings.resolution = {width, height};
    settings.crop_max = {width, height};
    return settings;
}

Image layer(const Film& film, const std::vector<std::string>& names)
{
    std::vector<std::string> all;
    const Image image = film.layers(all);
    EXPECT_EQ(image.channels, static_cast<int>(all.size()));
    Image result(image.width, image.height, static_cast<int>(names.size()));
    for (size_t c = 0; c < names.size(); ++c) {
        const auto found = std::find(all.begin(), all.end(), names[c]);
        EXPECT_NE(found, all.end()) << names[c];
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                result.at(x, y, static_cast<int>(c)) = image.at(x, y, static_cast<int>(found - all.begin()));
    }
    return result;
}

TEST(Film, PixelIsTheMeanOverSamplesAndPasses)
{
    Film film(small_film());
    PixelSample sample(0);
    for (int pass = 0; pass < 4; ++pass) {
        sample.clear();
        for (int i = 0; i < 2; ++i) {
            sample.add(Vec3(1.0f, 2.0f, 3.0f) * float(pass), PathClass::direct, LightGroup(0));
            sample.add(Vec3(0.5f), PathClass::caustic, LightGroup(0));
            sample.guides.albedo += Vec3(0.25f, 0.5f, 0.75f);
            sample.guides.normal += Vec3(0, 0, -1);
            sample.guides.position += Vec3(10, 20, 30);
            sample.guides.depth += 5.0f;
        }
        film.add_pixel({3, 2}, sample, 2);
        film.end_pass();
    }
    EXPECT_EQ(film.passes(), 4u);
    const Image beauty = film.beauty();
    EXPECT_EQ(beauty.at(3, 2, 0), 2.0f);
    EXPECT_EQ(beauty.at(3, 2, 1), 3.5f);
    EXPECT_EQ(beauty.at(3, 2, 2), 5.0f);
    EXPECT_EQ(beauty.at(2, 2, 0), 0.0f);
    const Image rest = layer(film, {"direct.G", "caustic.B", "indirect.R", "Albedo.B", "N.Z", "P.Y", "Z"});
    const float expected[] = {3.0f, 0.5f, 0.0f, 0.75f, -1.0f, 20.0f, 5.0f};
    for (int c = 0; c < 7; ++c) EXPECT_EQ(rest.at(3, 2, c), expected[c]) << c;
}

TEST(Film, ChannelNamesFollowTheSettings)
{
    FilmSettings settings = small_film(2, 2);
    std::vector<std::string> names;
    settings.class_layers = settings.guide_layers = false;
    Film(settings).layers(names);
    EXPECT_EQ(names, (std::vector<std::string>{"R", "G", "B"}));

    settings.light_groups = {"", "lamp"};
    settings.photon_layers = true;
    Film(settings).layers(names);
    EXPECT_EQ(names, (std::vector<std::string>{"R", "G", "B", "lightgroup_default.R", "lightgroup_default.G",
                                               "lightgroup_default.B", "lightgroup_lamp.R", "lightgroup_lamp.G",
                                               "lightgroup_lamp.B", "photons.density", "photons.radius"}));
    settings.class_layers = settings.guide_layers = true;
    Film(settings).layers(names);
    EXPECT_EQ(names.size(), 3u + 15 + 6 + 3 + 3 + 1 + 3 + 2);

    settings.light_groups = {"a", "a"};
    EXPECT_THROW(Film{settings}, UserError);
    settings = small_film();
    settings.crop_max = {13, 8};
    EXPECT_THROW(Film{settings}, UserError);
    settings.crop_max = {0, 8};
    EXPECT_THROW(Film{settings}, UserError);
}

// A constant field of splats gives a constant image, border pixels included, as positions reach beyond the raster. The
// grid of positions has a whole number of points per pixel, so the only error left is the quadrature's.
TEST(Film, ConstantSplatsGiveAConstantImage)
{
    for (const auto kind : {Filter::Kind::box, Filter::Kind::triangle, Filter::Kind::gaussian, Filter::Kind::mitchell,
                            Filter::Kind::sinc}) {
        FilmSettings settings = small_film();
        settings.resolution = {41, 22};  // more than one tile of Film::Sums both ways
        settings.crop_min = {2, 1};
        settings.crop_max = {40, 21};
        settings.filter = Filter({kind, FilterShape::default_radius(kind)});
        Film film(settings);
        const int grid = 8, margin = 5;
        for (int y = -margin * grid; y < (22 + margin) * grid; ++y)
            for (int x = -margin * grid; x < (41 + margin) * grid; ++x)
                film.splat({(x + 0.5f) / grid, (y + 0.5f) / grid}, Vec3(1, 2, 4) / float(grid * grid),
                           PathClass::indirect, LightGroup(0));
        film.end_pass();
        const Image image = film.beauty();
        EXPECT_EQ(image.width, 38);
        EXPECT_EQ(image.height, 20);
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.at(x, y, c), 1 << c, 2e-3f * (1 << c)) << int(kind);
    }
}

// Eye samples at filter offsets and splats at uniform positions estimate the same integral of a linear ramp.
TEST(Film, SplatsAndSamplesAgree)
{
    FilmSettings settings = small_film(5, 5);
    settings.filter = Filter({Filter::Kind::mitchell, Vec2(2.0f)});
    Film splats(settings), eyes(settings);
    const auto field = [](const Vec2& p) { return Vec3(p.x, p.y * p.y, 1.0f); };
    const int count = 400000;
    const float low = -3.0f, high = 8.0f, area = (high - low) * (high - low);
    for (int i = 0; i < count; ++i) {
        const uint64_t bits = hash_words(3, i);
        const Vec2 p(lerp(to_unit_float(bits), low, high), lerp(to_unit_float(mix64(bits)), low, high));
        splats.splat(p, field(p) * (area / count), PathClass::direct, LightGroup(0));
    }
    PixelSample sample(0);
    for (int i = 0; i < 20000; ++i) {
        const uint64_t bits = hash_words(4, i);
        const Filter::Sample drawn = settings.filter.sample({to_unit_float(bits), to_unit_float(mix64(bits))});
        sample.add(field(Vec2(2.5f, 2.5f) + drawn.offset) * drawn.weight, PathClass::direct, LightGroup(0));
    }
    eyes.add_pixel({2, 2}, sample, 20000);
    splats.end_pass();
    eyes.end_pass();
    // Standard errors of the splat estimates: about area * sqrt(integral (f w)^2 / area / count) = 1 to 1.5 %.
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(splats.beauty().at(2, 2, c), eyes.beauty().at(2, 2, c), 0.05f * eyes.beauty().at(2, 2, c)) << c;
}

// The share of one of several threads in contributions to a film of 36 x 20 pixels: every so-manieth splat, and the eye
// samples of every so-manieth pixel, since the film wants each pixel's from one thread.
void contribute(Film& film, int begin, int end, int thread = 0, int threads = 1)
{
    PixelSample sample(2);
    for (int i = begin; i < end; ++i) {
        const uint64_t a = hash_words(17, i), b = mix64(a), c = mix64(b);
        const Vec3 rgb(to_unit_float(c), std::exp2(20.0f * to_unit_float(b) - 10.0f), to_unit_float(a) - 0.3f);
        const PathClass path_class = static_cast<PathClass>(c % path_class_count);
        if (i % threads == thread)
            film.splat({36.0f * to_unit_float(a), 20.0f * to_unit_float(b)}, rgb, path_class,
                       LightGroup(uint32_t(a & 1)));
        const Int2 pixel(int(a % 36), int(b % 20));
        if ((pixel.x + 36 * pixel.y) % threads != thread) continue;
        sample.clear();
        sample.add(rgb, path_class, LightGroup(uint32_t(a & 1)));
        sample.guides.normal = rgb;
        film.add_pixel(pixel, sample, 3);
    }
}

// The same contributions by 1, 2 and 7 threads, and by 3 merged films one of which went through a file: the same bits.
TEST(Film, ThreadsAndMergesLeaveNoTrace)
{
    FilmSettings settings = small_film(36, 20);
    settings.light_groups = {"", "lamp"};
    const int count = 4000;
    Film one(settings);
    contribute(one, 0, count);
    one.end_pass();
    one.end_pass();
    one.end_pass();
    std::vector<std::string> names;
    const Image expected = one.layers(names);

    for (const int threads : {2, 7}) {
        Film film(settings);
        std::vector<std::thread> pool;
        for (int t = 0; t < threads; ++t) pool.emplace_back([&, t] { contribute(film, 0, count, t, threads); });
        for (std::thread& thread : pool) thread.join();
        for (int i = 0; i < 3; ++i) film.end_pass();
        EXPECT_EQ(film.layers(names).pixels, expected.pixels) << threads;
    }

    Film merged(settings), part(settings), copy(settings);
    contribute(merged, 1000, 2000);
    merged.end_pass();
    contribute(copy, 0, 1000);
    copy.end_pass();
    merged.merge(copy);
    contribute(part, 2000, count);
    part.end_pass();
    std::stringstream file;
    part.write_state(file);
    copy.read_state(file);
    merged.merge(copy);
    EXPECT_EQ(merged.passes(), 3u);
    EXPECT_EQ(merged.layers(names).pixels, expected.pixels);

    // Classes and groups both sum to the beauty.
    const Image parts = layer(one, {"R", "emission.R", "direct.R", "caustic.R", "indirect.R", "volume.R",
                                    "lightgroup_default.R", "lightgroup_lamp.R"});
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 36; ++x) {
            float classes = 0.0f;
            for (int c = 1; c <= 5; ++c) classes += parts.at(x, y, c);
            EXPECT_NEAR(classes, parts.at(x, y, 0), 1e-5f * parts.at(x, y, 0));
            EXPECT_NEAR(parts.at(x, y, 6) + parts.at(x, y, 7), parts.at(x, y, 0), 1e-5f * parts.at(x, y, 0));
        }
}

TEST(Film, DamagedStatesAreRefused)
{
    Film film(small_film()), other(small_film(13, 8));
    contribute(film, 0, 100);
    film.end_pass();
    const Image before = film.beauty();
    std::stringstream file;
    film.write_state(file);
    EXPECT_THROW(other.read_state(file), UserError);
    EXPECT_THROW(other.merge(film), UserError);
    std::stringstream shorter(file.str().substr(0, file.str().size() - 100));
    EXPECT_THROW(film.read_state(shorter), UserError);
    std::stringstream empty;
    EXPECT_THROW(film.read_state(empty), UserError);
    EXPECT_EQ(film.beauty().pixels, before.pixels);
    EXPECT_EQ(film.passes(), 1u);
}

// A cut first pass: pixels without a sample show the nearest that has one, in all layers.
TEST(Film, CutFirstPassIsFilledFromNeighbours)
{
    Film film(small_film(7, 3));
    PixelSample sample(0);
    for (const int x : {1, 5}) {
        sample.clear();
        sample.add(Vec3(static_cast<float>(x)), PathClass::direct, LightGroup(0));
        sample.guides.depth = 10.0f * x;
        film.add_pixel({x, 1}, sample, 1);
    }
    film.end_cut_pass();
    const Image image = layer(film, {"R", "direct.G", "Z"});
    for (int y = 0; y < 3; ++y)
        for (const int x : {0, 1, 2, 4, 5, 6}) {
            const float nearest = x < 3 ? 1.0f : 5.0f;
            EXPECT_EQ(image.at(x, y, 0), nearest) << x << ' ' << y;
            EXPECT_EQ(image.at(x, y, 1), nearest);
            EXPECT_EQ(image.at(x, y, 2), 10 * nearest);
            EXPECT_EQ(film.beauty().at(x, y, 2), nearest);
        }
}

TEST(Film, AccidentsAreDroppedAndCounted)
{
    Film film(small_film());
    PixelSample sample(0);
    sample.add(Vec3(1.0f), PathClass::direct, LightGroup(0));
    sample.add(Vec3(NAN, 1.0f, 1.0f), PathClass::direct, LightGroup(0));
    sample.add(Vec3(infinity), PathClass::volume, LightGroup(0));
    sample.guides.normal = Vec3(NAN);
    film.add_pixel({1, 1}, sample, 1);
    EXPECT_EQ(film.accidents().eye_sample, 3u);
    sample.clear();
    sample.add(Vec3(1e20f), PathClass::direct, LightGroup(0));
    film.add_pixel({1, 1}, sample, 1);
    EXPECT_EQ(film.accidents().eye_sample, 4u);

    film.splat({1.5f, 1.5f}, Vec3(0.0f, NAN, 0.0f), PathClass::direct, LightGroup(0));
    film.splat({1.5f, 1.5f}, Vec3(1e20f), PathClass::direct, LightGroup(0));
    film.splat({NAN, 1.5f}, Vec3(1.0f), PathClass::direct, LightGroup(0));
    EXPECT_EQ(film.accidents().splat, 3u);
    film.splat({1e30f, -1e30f}, Vec3(1.0f), PathClass::direct, LightGroup(0));
    film.add_pixel({-1, 3}, sample, 1);
    film.add_pixel({12, 3}, sample, 1);
    film.end_pass();
    EXPECT_EQ(film.accidents().splat, 3u);
    EXPECT_EQ(film.accidents().eye_sample, 4u);
    const Image image = film.beauty();
    for (int i = 0; i < 12 * 8 * 3; ++i) EXPECT_EQ(image.pixels[i], i / 3 == 13 ? 1.0f : 0.0f) << i;
}

}  // namespace
}  // namespace dapple
