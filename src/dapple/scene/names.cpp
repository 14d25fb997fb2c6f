// The words of pbrt-v4 (facts from its source: util/spectrum.cpp, media.cpp, film.cpp, util/colorspace.cpp).
#include "dapple/scene/names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

namespace dapple::scene {
namespace {

constexpr std::string_view spectra[] = {
    "glass-BK7",    "glass-BAF10",    "glass-FK51A",  "glass-LASF9",   "glass-F5",     "glass-F10",      "glass-F11",
    "metal-Ag-eta", "metal-Ag-k",     "metal-Al-eta", "metal-Al-k",    "metal-Au-eta", "metal-Au-k",     "metal-Cu-eta",
    "metal-Cu-k",   "metal-CuZn-eta", "metal-CuZn-k", "metal-MgO-eta", "metal-MgO-k",  "metal-TiO2-eta", "metal-TiO2-k",
    "stdillum-A",   "stdillum-D50",   "stdillum-D65", "stdillum-F1",   "stdillum-F2",  "stdillum-F3",    "stdillum-F4",
    "stdillum-F5",  "stdillum-F6",    "stdillum-F7",  "stdillum-F8",   "stdillum-F9",  "stdillum-F10",   "stdillum-F11",
    "stdillum-F12", "illum-acesD60"};

constexpr std::string_view medium_presets[] = {"Apple",
                                               "Chicken1",
                                               "Chicken2",
                                               "Cream",
                                               "Ketchup",
                                               "Marble",
                                               "Potato",
                                               "Skimmilk",
                                               "Skin1",
                                               "Skin2",
                                               "Spectralon",
                                               "Wholemilk",
                                               "Lowfat Milk",
                                               "Reduced Milk",
                                               "Regular Milk",
                                               "Espresso",
                                               "Mint Mocha Coffee",
                                               "Lowfat Soy Milk",
                                               "Regular Soy Milk",
                                               "Lowfat Chocolate Milk",
                                               "Regular Chocolate Milk",
                                               "Coke",
                                               "Pepsi",
                                               "Sprite",
                                               "Gatorade",
                                               "Chardonnay",
                                               "White Zinfandel",
                                               "Merlot",
                                               "Budweiser Beer",
                                               "Coors Light Beer",
                                               "Clorox",
                                               "Apple Juice",
                                               "Cranberry Juice",
                                               "Grape Juice",
                                               "Ruby Grapefruit Juice",
                                               "White Grapefruit Juice",
                                               "Shampoo",
                                               "Strawberry Shampoo",
                                               "Head & Shoulders Shampoo",
                                               "Lemon Tea Powder",
                                               "Orange Powder",
                                               "Pink Lemonade Powder",
                                               "Cappuccino Powder",
                                               "Salt Powder",
                                               "Sugar Powder",
                                               "Suisse Mocha Powder",
                                               "Pacific Ocean Surface Water"};

constexpr std::string_view sensors[] = {
    "cie1931",       "canon_eos_100d",     "canon_eos_1dx_mkii", "canon_eos_200d",    "canon_eos_200d_mkii",
    "canon_eos_5d",  "canon_eos_5d_mkii",  "canon_eos_5d_mkiii", "canon_eos_5d_mkiv", "canon_eos_5ds",
    "canon_eos_m",   "hasselblad_l1d_20c", "nikon_d810",         "nikon_d850",        "sony_ilce_6400",
    "sony_ilce_7m3", "sony_ilce_7rm3",     "sony_ilce_9"};

constexpr std::string_view color_spaces[] = {"srgb", "rec2020", "aces2065-1", "dci-p3"};

}  // namespace

std::span<const std::string_view> spectrum_names() { return spectra; }
std::span<const std::string_view> medium_preset_names() { return medium_presets; }
std::span<const std::string_view> sensor_names() { return sensors; }
std::span<const std::string_view> color_space_names() { return color_spaces; }

bool contains(std::span<const std::string_view> names, std::string_view name)
{
    return std::find(names.begin(), names.end(), name) != names.end();
}

std::optional<ColorSpace> color_space_from_name(std::string_view name)
{
    std::string lower(name);
    for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    for (size_t i = 0; i < std::size(color_spaces); ++i)
        if (color_spaces[i] == lower) return static_cast<ColorSpace>(i);
    return std::nullopt;
}

std::string_view color_space_name(ColorSpace space) { return color_spaces[static_cast<size_t>(space)]; }

}  // namespace dapple::scene
