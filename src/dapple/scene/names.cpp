// The words are those of the tables in the room spectrum, which hold all that pbrt-v4 knows and some more.
#include "dapple/scene/names.h"

#include "dapple/scene/output.h"
#include "dapple/spectrum/make_spectrum.h"
#include "dapple/spectrum/medium_presets.h"
#include "dapple/spectrum/standard_tables.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <vector>

namespace dapple::scene {
namespace {

constexpr std::string_view color_spaces[] = {"srgb", "rec2020", "aces2065-1", "dci-p3"};

}  // namespace

std::span<const std::string_view> spectrum_names()
{
    static const std::vector<std::string_view> names = named_spectrum_names();
    return names;
}

std::span<const std::string_view> medium_preset_names()
{
    static const std::vector<std::string_view> names = dapple::medium_preset_names();
    return names;
}

std::span<const std::string_view> sensor_names()
{
    static const std::vector<std::string_view> names = [] {
        std::vector<std::string_view> all = dapple::sensor_names();
        std::stable_partition(all.begin(), all.end(), [](std::string_view name) { return name == Film{}.sensor; });
        return all;
    }();
    return names;
}

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
