// Scenes in the format of pbrt-v4 (its user's guide, and its source for defaults). Unknown words are errors with the
// nearest known one; features that exist in pbrt but not here are warnings that say what stands in for them.
#pragma once

#include "dapple/formats/read_file.h"
#include "dapple/scene/description.h"

#include <filesystem>
#include <string>

namespace dapple {

// Reads a scene file (plain or gzip'ed) with all that it includes. Throws UserError with file, line and column.
// Memory: a constant times the bytes read. Time: about 2 s per 100 MB.
scene::Description read_pbrt(const std::filesystem::path& file, const ReadLimits& limits = {});

// The same for a text in memory; `name` stands for the file in messages, other files are looked up in base_folder.
scene::Description read_pbrt_string(std::string text, const std::string& name, const std::filesystem::path& base_folder,
                                    const ReadLimits& limits = {});

}  // namespace dapple
