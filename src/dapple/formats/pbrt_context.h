// What look-ups of parameters need to know of the scene so far: its folder, its textures, and where warnings go.
#pragma once

#include "dapple/formats/read_file.h"
#include "dapple/scene/values.h"

#include <filesystem>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dapple {

class PbrtContext {
public:
    PbrtContext(std::filesystem::path base_folder, ReadLimits limits)
        : base_folder_(std::move(base_folder)), limits_(limits)
    {
    }

    const std::filesystem::path& base_folder() const { return base_folder_; }
    const ReadLimits& limits() const { return limits_; }
    // The path a scene means by `file`: relative to the folder of the main file. It counts as a file of the scene.
    std::filesystem::path resolve(const std::string& file);
    // The files resolved so far, in that order, each once.
    const std::vector<std::filesystem::path>& files() const { return files_; }
    // Throws unless the limits allow to open further files.
    void check_files_allowed(const SourceLocation& where) const;

    // Notes a warning; the same text again, elsewhere, is only counted.
    void warn(const SourceLocation& where, const std::string& text);
    // One line each: "file:line:column: text", and how often it came again.
    std::vector<std::string> warnings() const;

    std::map<std::string, scene::FloatTextureIndex, std::less<>> float_textures;
    std::map<std::string, scene::SpectrumTextureIndex, std::less<>> spectrum_textures;

private:
    struct Warning {
        SourceLocation where;
        std::string text;
        int repeats = 0;
    };
    std::filesystem::path base_folder_;
    ReadLimits limits_;
    std::vector<Warning> warnings_;
    std::map<std::string, size_t> warning_by_text_;
    std::vector<std::filesystem::path> files_;
    std::set<std::filesystem::path> known_files_;
};

// did_you_mean() for words out of files, which may be of any length.
std::string suggest(std::string_view word, std::span<const std::string_view> known);

// The keys of a map by name, for suggest().
template <class Map>
std::vector<std::string_view> names_of(const Map& map)
{
    std::vector<std::string_view> names;
    names.reserve(map.size());
    for (const auto& [name, value] : map) names.push_back(name);
    return names;
}

}  // namespace dapple
