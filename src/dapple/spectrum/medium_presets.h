// Measured scattering parameters by name.
#pragma once

#include "dapple/base/error.h"
#include "dapple/math/vec.h"

#include <string_view>
#include <vector>

namespace dapple {

// Coefficients as linear sRGB, per millimetre as measured. A front end that takes them as "per scene unit" (pbrt does)
// gets a medium a thousand times denser than the real one in a scene in metres; the factor is the caller's.
struct MediumPreset {
    std::string_view name;
    Vec3 sigma_s;  // reduced: (1 - g) sigma_s, to be used with g = 0
    Vec3 sigma_a;
};

// All names, in the order of pbrt's list.
std::vector<std::string_view> medium_preset_names();

// The preset of that exact name; throws a UserError at `where` that names the nearest known one.
const MediumPreset& find_medium_preset(std::string_view name, const SourceLocation& where = {});

}  // namespace dapple
