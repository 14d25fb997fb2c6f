// Resolution and crop window from the command line.
#include "dapple/render/film_settings.h"

#include "dapple/base/error.h"

#include <gtest/gtest.h>

#include <string>

namespace dapple {
namespace {

scene::Film film_of(int width, int height)
{
    scene::Film film;
    film.resolution = film.crop_max = Int2(width, height);
    return film;
}

TEST(Crop, TakesPartsAsPbrtDoes)
{
    scene::Film film = film_of(100, 50);
    set_crop(film, parse_crop("0.25,0.5,0,1"));
    EXPECT_EQ(film.crop_min, Int2(25, 0));
    EXPECT_EQ(film.crop_max, Int2(50, 50));
}

TEST(Crop, NeighboursShareNoPixel)
{
    scene::Film left = film_of(101, 7), right = film_of(101, 7);
    set_crop(left, parse_crop("0,0.33,0,1"));
    set_crop(right, parse_crop("0.33,1,0,1"));
    EXPECT_EQ(left.crop_max.x, right.crop_min.x);
}

TEST(Crop, TakesPixels)
{
    scene::Film film = film_of(100, 50);
    set_crop(film, parse_crop("10,20,0,2000"));
    EXPECT_EQ(film.crop_min, Int2(10, 0));
    EXPECT_EQ(film.crop_max, Int2(20, 50));
}

TEST(Crop, TakesEveryPixelAsItIs)
{
    for (int edge = 0; edge < 270; ++edge) {
        scene::Film film = film_of(270, 270);  // 270 * (109.0 / 270) is above 109
        set_crop(film, parse_crop(std::to_string(edge) + ",270," + std::to_string(edge) + ",270"));
        set_resolution(film, Int2(270, 270));
        EXPECT_EQ(film.crop_min, Int2(edge, edge));
        EXPECT_EQ(film.crop_max, Int2(270, 270));
    }
}

TEST(Crop, RefusesWhatHoldsNoPixel)
{
    scene::Film film = film_of(100, 50);
    for (const char* text :
         {"", "1,2,3", "0.5,0.5,0,1", "20,10,0,5", "-1,5,0,5", "0,1,0,1,", "0 1 0 1", "a,b,c,d", "nan,1,0,1"})
        EXPECT_THROW(set_crop(film, parse_crop(text)), UserError) << "'" << text << "'";
}

TEST(Resolution, KeepsTheCroppedPart)
{
    scene::Film film = film_of(100, 50);
    set_crop(film, parse_crop("0.25,0.5,0,1"));
    set_resolution(film, Int2(400, 200));
    EXPECT_EQ(film.resolution, Int2(400, 200));
    EXPECT_EQ(film.crop_min, Int2(100, 0));
    EXPECT_EQ(film.crop_max, Int2(200, 200));
    set_resolution(film, Int2(1, 1));
    EXPECT_EQ(film.crop_min, Int2(0, 0));
    EXPECT_EQ(film.crop_max, Int2(1, 1));
}

TEST(Resolution, RefusesTheRest)
{
    scene::Film film = film_of(100, 50);
    for (const char* text : {"", "100", "100x", "0x5", "-4x4", "1.5x2", "100x50x3", "65537x1", "99999999x1"})
        EXPECT_THROW(set_resolution(film, parse_resolution(text)), UserError) << "'" << text << "'";
}

TEST(Layers, AreChosenByWord)
{
    const LayerChoice beauty = LayerChoice::parse("beauty");
    EXPECT_FALSE(beauty.guides || beauty.classes || beauty.groups || beauty.photons);
    const LayerChoice some = LayerChoice::parse("guides,groups");
    EXPECT_TRUE(some.guides && some.groups && !some.classes && !some.photons);
    const LayerChoice all = LayerChoice::parse("all");
    EXPECT_TRUE(all.guides && all.classes && all.groups && all.photons);
    EXPECT_THROW(LayerChoice::parse("guide"), UserError);
    EXPECT_THROW(LayerChoice::parse(""), UserError);
}

// The film of a scene without lights or shapes.
FilmSettings settings_of(const scene::Description& description, ColorModel model = ColorModel::spectral)
{
    const World world;
    return film_settings(description, world, LayerChoice{}, false, model);
}

TEST(FilmSettings, FollowTheGbufferFilmAndTheOptions)
{
    scene::Description description;
    EXPECT_FALSE(settings_of(description).guides_in_camera_space) << "pbrt's film 'rgb' has no guides to go by";
    EXPECT_FALSE(settings_of(description).pixel_centers);
    EXPECT_EQ(settings_of(description).color_model, ColorModel::spectral);
    description.film.kind = scene::Film::Kind::gbuffer;
    EXPECT_TRUE(settings_of(description).guides_in_camera_space);
    description.film.guides_in_camera_space = false;
    EXPECT_FALSE(settings_of(description).guides_in_camera_space);
    description.options.disable_pixel_jitter = true;
    EXPECT_TRUE(settings_of(description).pixel_centers);
    description.options.disable_wavelength_jitter = true;
    EXPECT_EQ(settings_of(description).color_model, ColorModel::fixed_spectral);
    EXPECT_EQ(settings_of(description, ColorModel::rgb).color_model, ColorModel::rgb);
}

}  // namespace
}  // namespace dapple
