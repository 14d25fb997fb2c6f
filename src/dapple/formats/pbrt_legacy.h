// Words of pbrt-v3 and older, and what pbrt-v4 says instead.
#pragma once

#include <string>
#include <string_view>

namespace dapple {

// What kind of word is looked up.
enum class LegacyKind {
    directive,
    parameter_type,
    parameter,
    film,
    sampler,
    material,
    shape,
    area_light,
    texture_type
};

// Returns "; pbrt-v3's 'matte' is now 'diffuse'" or the like, or an empty string for a word that never was.
std::string legacy_hint(LegacyKind kind, std::string_view word);

}  // namespace dapple
