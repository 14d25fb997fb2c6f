// Reading sparse volumes from NanoVDB files (.nvdb) into dense grids.
#pragma once

#include "dapple/math/transform.h"
#include "dapple/scene/appearance.h"

#include <string>
#include <vector>

namespace dapple {

// Float values on a regular grid over the unit cube, sample i of n at (i + 1/2) / n. One layer of background around the
// active voxels is included, so that trilinear interpolation of the dense grid (zero outside) equals that of the
// sparse.
struct NanoVdbGrid {
    std::string name;
    int nx = 0, ny = 0, nz = 0;
    std::vector<float> values;  // x fastest
    Transform world_from_unit;  // from the unit cube to the file's world space
    Box3 bounds;                // of the unit cube in the file's world space
};

// All float grids of the file, uncompressed or zip-compressed, of file format 32; other grids are left out with a
// warning. Grids with the same index-to-world map are given the same box and resolution, so that they can serve as
// density and temperature of one medium. Throws a UserError when the file cannot be read, is damaged, holds no float
// grid, a level set, or more than nanovdb_voxel_limit values in the box around the active voxels of one grid.
std::vector<NanoVdbGrid> read_nanovdb(const std::string& path);

inline constexpr int64_t nanovdb_voxel_limit = int64_t(1) << 29;  // 2 GiB per grid

// Turns a NanoVdbMedium into the UniformGridMedium of its file, in the file's space; leaves other media alone. To be
// called before a description is compiled. Throws a UserError when the file cannot be used, lacks the density grid, or
// gives density and temperature different transforms. A temperature grid that the file lacks is no error.
void expand_nanovdb(scene::Medium& medium);

}  // namespace dapple
