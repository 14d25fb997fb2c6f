// From the grids of a NanoVDB file to a medium of the description.
#include "dapple/base/error.h"
#include "dapple/formats/nanovdb.h"

#include <algorithm>

namespace dapple {

namespace {

NanoVdbGrid* find_grid(std::vector<NanoVdbGrid>& grids, const std::string& name)
{
    const auto found = std::find_if(grids.begin(), grids.end(), [&](const auto& grid) { return grid.name == name; });
    return found != grids.end() ? &*found : nullptr;
}

scene::GridData take_values(NanoVdbGrid& grid) { return {grid.nx, grid.ny, grid.nz, std::move(grid.values)}; }

}  // namespace

void expand_nanovdb(scene::Medium& medium)
{
    const auto* kind = std::get_if<scene::NanoVdbMedium>(&medium.kind);
    if (kind == nullptr) return;
    const scene::NanoVdbMedium source = *kind;
    std::vector<NanoVdbGrid> grids;
    try {
        grids = read_nanovdb(source.file.string());
    } catch (const UserError& error) {
        throw UserError(medium.at, error.what());
    }
    NanoVdbGrid* density = find_grid(grids, source.density_grid);
    if (density == nullptr) {
        std::vector<std::string_view> names;
        for (const NanoVdbGrid& grid : grids) names.push_back(grid.name);
        throw UserError(medium.at, source.file.string() + " has no grid '" + source.density_grid + "' of floats" +
                                       did_you_mean(source.density_grid, names));
    }
    scene::UniformGridMedium out;
    out.sigma_a = source.sigma_a;
    out.sigma_s = source.sigma_s;
    out.temperature_scale = source.temperature_scale;
    out.temperature_offset = source.temperature_offset;
    if (NanoVdbGrid* temperature = find_grid(grids, source.temperature_grid); temperature && temperature != density) {
        if (!(temperature->world_from_unit.matrix() == density->world_from_unit.matrix()))
            throw UserError(medium.at, "grids '" + density->name + "' and '" + temperature->name + "' of " +
                                           source.file.string() + " have different transforms");
        out.temperature = take_values(*temperature);
        if (source.emission_scale != 1.0f) {
            out.emission_scale = {density->nx, density->ny, density->nz, {}};
            out.emission_scale.values.assign(density->values.size(), source.emission_scale);
        }
    }
    out.density = take_values(*density);
    medium.world_from_medium = medium.world_from_medium * density->world_from_unit.matrix();
    medium.kind = std::move(out);
}

}  // namespace dapple
