// Refractive indices known by name. Cold code.
#pragma once

#include <string_view>
#include <vector>

namespace dapple {

// eta or k of "metal-Ag-eta", "metal-Ag-k", ..., eta of "glass-BK7", "water", ... on the grid of spectrum_table_size;
// empty for an unknown name. Measurements continue their ends where they do not reach 360 or 830 nm.
std::vector<float> refractive_index_table(std::string_view name);
std::vector<std::string_view> refractive_index_names();

}  // namespace dapple
