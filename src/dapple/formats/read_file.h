// Whole files in memory, and the limits that readers keep to.
#pragma once

#include "dapple/base/error.h"

#include <filesystem>
#include <string>
#include <string_view>

namespace dapple {

// What a reader may do besides parsing the text it was given.
struct ReadLimits {
    bool other_files = true;          // false: any further file (Include, PLY, SPD) is a UserError
    int include_depth = 64;           // nested Include and Import
    int64_t include_count = 1000000;  // files included in total, repeats counted
};

// Returns the content of a regular file; gzip'ed ones (by their first bytes) are expanded. Throws UserError at
// `where`, the place that names the file, when it cannot be read, is damaged, or expands beyond all proportion.
std::string read_file(const std::filesystem::path& path, const SourceLocation& where);

// The text as it may appear within a one-line message: shortened, control characters replaced.
std::string shown(std::string_view text);

}  // namespace dapple
