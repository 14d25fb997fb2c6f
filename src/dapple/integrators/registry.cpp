#include "dapple/integrators/registry.h"

#include "dapple/base/error.h"

#include <fmt/format.h>

#include <vector>

namespace dapple {

std::span<const IntegratorEntry> integrator_registry()
{
    static const std::vector<IntegratorEntry> entries = {path_tracing_entry,
                                                         light_tracing_entry,
                                                         photon_mapping_entry,
                                                         irradiance_caching_entry,
                                                         progressive_photon_mapping_entry,
                                                         photon_splatting_entry,
                                                         bdpt_entry,
                                                         vcm_entry};
    return entries;
}

const IntegratorEntry& find_integrator(std::string_view name)
{
    std::vector<std::string_view> names;
    for (const IntegratorEntry& entry : integrator_registry()) {
        if (entry.name == name) return entry;
        names.push_back(entry.name);
    }
    std::string hint = did_you_mean(name, names);
    if (hint.empty()) hint = fmt::format("; there are {}", fmt::join(names, ", "));
    throw UserError("unknown integrator '" + std::string(name) + "'" + hint);
}

}  // namespace dapple
