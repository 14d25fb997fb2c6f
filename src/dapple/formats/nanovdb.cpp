// The file format of Museth 2021, "NanoVDB: a GPU-friendly and portable VDB data structure", version 32, as laid out in
// NanoVDB.h and util/IO.h of OpenVDB 10 (all little-endian, structures aligned to 32 bytes):
//   segment: header (16 bytes), then per grid its metadata (176 bytes) and name, then per grid its data;
//   grid data: GridData (672), TreeData (64), and by offsets root, its tiles, upper (32^3), lower (16^3), leaf (8^3)
//   nodes.
// Read here without that library because it trusts its input: every offset below is checked against the data's size.
// Cost: the dense box, 4 bytes per voxel.

#include "dapple/formats/nanovdb.h"

#include "dapple/base/error.h"
#include "dapple/base/log.h"
#include "dapple/formats/read_file.h"

#include <zlib.h>

#include <array>
#include <cstring>
#include <span>

namespace dapple {

namespace {

constexpr uint64_t magic_number = 0x304244566f6e614eull;  // "NanoVDB0"
constexpr uint32_t supported_major = 32;
constexpr uint16_t codec_none = 0, codec_zip = 1;
constexpr uint32_t type_float = 1;
constexpr uint32_t class_unknown = 0, class_fog_volume = 2;

// Where the fields read here lie, in bytes from the start of their structure.
namespace metadata {
constexpr size_t grid_size = 0, file_size = 8, type = 32, grid_class = 36, name_size = 136, codec = 168, size = 176;
}
namespace grid_data {
constexpr size_t magic = 0, matrix = 296 + 88, translation = 296 + 232, size = 672;
}
namespace root {
constexpr size_t table_size = 24, background = 28, tiles = 64;
constexpr size_t tile_key = 0, tile_child = 8, tile_value = 20, tile_size = 32;
}  // namespace root
struct NodeLayout {
    int log2_dimension;  // of its table, per axis
    int log2_extent;     // of the voxels it spans, per axis
    size_t child_mask, table, entry_size, size;
};
constexpr NodeLayout leaf{3, 3, 0, 96, 4, 96 + 512 * 4};
constexpr NodeLayout lower{4, 7, 32 + 512, 1088, 8, 1088 + 4096 * 8};
constexpr NodeLayout upper{5, 12, 32 + 4096, 8256, 8, 8256 + 32768 * 8};

using Index = std::array<int64_t, 3>;
struct IndexBox {
    Index min{}, max{};  // both inclusive
    bool operator==(const IndexBox&) const = default;
    int64_t extent(int axis) const { return max[axis] - min[axis] + 1; }
};

// Bytes with bounds checks; every read beyond the end is an error of the file.
class Bytes {
public:
    Bytes(std::span<const std::byte> bytes, const std::string& path) : bytes_(bytes), path_(&path) {}

    template <class T>
    T get(uint64_t offset) const
    {
        T value;
        std::memcpy(&value, slice(offset, sizeof(T)).data(), sizeof(T));
        return value;
    }
    std::span<const std::byte> slice(uint64_t offset, uint64_t size) const
    {
        if (offset > bytes_.size() || size > bytes_.size() - offset) damaged("it ends too early");
        return bytes_.subspan(offset, size);
    }
    size_t size() const { return bytes_.size(); }
    const std::string& path() const { return *path_; }
    [[noreturn]] void damaged(const char* why) const
    {
        throw UserError(SourceLocation{*path_}, std::string("damaged NanoVDB file: ") + why);
    }

private:
    std::span<const std::byte> bytes_;
    const std::string* path_;
};

// One grid of the file, its data uncompressed.
struct SparseGrid {
    std::string name;
    std::vector<std::byte> data;
    Matrix4 world_from_index;
    IndexBox box;  // of the active voxels
};

// zlib gains at most about a factor of 1032; what claims more is not worth the memory it would take to disprove.
std::vector<std::byte> inflate_zip(std::span<const std::byte> packed, uint64_t size, const Bytes& file)
{
    if (size / 1100 > packed.size()) file.damaged("a grid's stated size cannot be true");
    std::vector<std::byte> out(size);
    uLongf length = size;
    const int status = uncompress(reinterpret_cast<Bytef*>(out.data()), &length,
                                  reinterpret_cast<const Bytef*>(packed.data()), packed.size());
    if (status != Z_OK || length != size) file.damaged("a grid cannot be uncompressed");
    return out;
}

// The data of the grid that begins at `position` in the file; advances position past it.
std::vector<std::byte> read_data(const Bytes& file, uint64_t& position, uint16_t codec, uint64_t size)
{
    if (codec == codec_none) {
        const auto slice = file.slice(position, size);
        position += size;
        return {slice.begin(), slice.end()};
    }
    const auto packed_size = file.get<uint64_t>(position);
    const auto packed = file.slice(position + 8, packed_size);
    position += 8 + packed_size;
    return inflate_zip(packed, size, file);
}

uint64_t root_offset(const Bytes& data)
{
    const uint64_t offset = data.get<uint64_t>(grid_data::size + 24);
    if (offset > data.size()) data.damaged("its root is outside of it");
    return grid_data::size + offset;
}

// Reads the header of a grid's data; data must stay where it is.
void read_grid_header(SparseGrid& grid, const std::string& path)
{
    const Bytes data(grid.data, path);
    if (data.get<uint64_t>(grid_data::magic) != magic_number) data.damaged("a grid does not begin as one");
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
            grid.world_from_index.m[row][column] = data.get<double>(grid_data::matrix + 8 * (3 * row + column));
        grid.world_from_index.m[row][3] = data.get<double>(grid_data::translation + 8 * row);
    }
    Matrix4 inverse;
    for (const auto& row : grid.world_from_index.m)
        for (const double value : row)
            if (!std::isfinite(value)) data.damaged("its transform is not finite");
    if (!invert(grid.world_from_index, inverse)) data.damaged("its transform is singular");

    const uint64_t at = root_offset(data);
    for (int axis = 0; axis < 3; ++axis) {
        grid.box.min[axis] = data.get<int32_t>(at + 4 * axis);
        grid.box.max[axis] = data.get<int32_t>(at + 12 + 4 * axis);
        if (grid.box.min[axis] > grid.box.max[axis])
            throw UserError(SourceLocation{path}, "NanoVDB grid '" + grid.name + "' has no active voxels");
    }
}

// Reads one segment (header, metadata, data) that begins at `position`, and appends its float grids.
void read_segment(const Bytes& file, const std::string& path, uint64_t& position, std::vector<SparseGrid>& grids)
{
    if (file.get<uint64_t>(position) != magic_number) throw UserError(SourceLocation{path}, "not a NanoVDB file");
    const uint32_t major = file.get<uint32_t>(position + 8) >> 21;
    if (major != supported_major)
        throw UserError(SourceLocation{path}, "NanoVDB file format " + std::to_string(major) +
                                                  "; only format 32 (OpenVDB 9 to 10) can be read");
    const auto count = file.get<uint16_t>(position + 12);
    const auto codec = file.get<uint16_t>(position + 14);
    if (codec != codec_none && codec != codec_zip)
        throw UserError(SourceLocation{path},
                        "NanoVDB file compressed with Blosc; convert it to zip or no compression");
    position += 16;

    struct Entry {
        uint64_t size;
        uint32_t type, grid_class;
        std::string name;
    };
    std::vector<Entry> entries(count);
    for (Entry& entry : entries) {
        entry.size = file.get<uint64_t>(position + metadata::grid_size);
        entry.type = file.get<uint32_t>(position + metadata::type);
        entry.grid_class = file.get<uint32_t>(position + metadata::grid_class);
        const auto name = file.slice(position + metadata::size, file.get<uint32_t>(position + metadata::name_size));
        entry.name.assign(reinterpret_cast<const char*>(name.data()), name.size());
        entry.name = shown(entry.name.c_str());  // up to the terminating zero, which is stored
        position += metadata::size + name.size();
    }
    for (Entry& entry : entries) {
        std::vector<std::byte> data = read_data(file, position, codec, entry.size);
        if (entry.type != type_float) {
            log_warning("{}: grid '{}' is left out: its values are not 32-bit floats", path, entry.name);
            continue;
        }
        if (entry.grid_class != class_fog_volume && entry.grid_class != class_unknown)
            throw UserError(SourceLocation{path}, "NanoVDB grid '" + entry.name + "' is not a fog volume");
        SparseGrid& grid = grids.emplace_back();
        grid.name = std::move(entry.name);
        grid.data = std::move(data);
        read_grid_header(grid, path);
    }
}

// Copies a sparse tree into the dense box.
class Expansion {
public:
    Expansion(const SparseGrid& grid, const std::string& path, const IndexBox& box, std::vector<float>& out)
        : data_(grid.data, path), box_(box), out_(&out)
    {
    }

    void run()
    {
        const uint64_t at = root_offset(data_);
        std::fill(out_->begin(), out_->end(), data_.get<float>(at + root::background));
        const auto tiles = data_.get<uint32_t>(at + root::table_size);
        for (uint64_t i = 0; i < tiles; ++i) {
            const uint64_t tile = at + root::tiles + i * root::tile_size;
            const auto key = data_.get<uint64_t>(tile + root::tile_key);
            const Index origin{from_key(key >> 42), from_key(key >> 21), from_key(key)};
            const auto child = data_.get<int64_t>(tile + root::tile_child);
            if (child == 0)
                fill(origin, upper.log2_extent, data_.get<float>(tile + root::tile_value));
            else
                expand(at + static_cast<uint64_t>(child), origin, upper, &lower);
        }
    }

private:
    // 21 bits of a key are the upper bits of a 32-bit coordinate.
    static int64_t from_key(uint64_t bits)
    {
        return static_cast<int32_t>(static_cast<uint32_t>(bits & 0x1fffffu) << upper.log2_extent);
    }

    // The part of a cube of 2^log2_extent voxels that lies in the box; false when empty.
    bool clip(const Index& origin, int log2_extent, IndexBox& part) const
    {
        for (int axis = 0; axis < 3; ++axis) {
            part.min[axis] = std::max(origin[axis], box_.min[axis]);
            part.max[axis] = std::min(origin[axis] + (int64_t(1) << log2_extent) - 1, box_.max[axis]);
            if (part.min[axis] > part.max[axis]) return false;
        }
        return true;
    }

    float* row(const IndexBox& part, int64_t y, int64_t z) const
    {
        const int64_t at = ((z - box_.min[2]) * box_.extent(1) + (y - box_.min[1])) * box_.extent(0);
        return out_->data() + at + (part.min[0] - box_.min[0]);
    }

    void fill(const Index& origin, int log2_extent, float value) const
    {
        IndexBox part;
        if (!clip(origin, log2_extent, part)) return;
        for (int64_t z = part.min[2]; z <= part.max[2]; ++z)
            for (int64_t y = part.min[1]; y <= part.max[1]; ++y) std::fill_n(row(part, y, z), part.extent(0), value);
    }

    void copy_leaf(uint64_t node, const Index& origin) const
    {
        const auto values = data_.slice(node, leaf.size).subspan(leaf.table);
        IndexBox part;
        if (!clip(origin, leaf.log2_extent, part)) return;
        for (int64_t z = part.min[2]; z <= part.max[2]; ++z)
            for (int64_t y = part.min[1]; y <= part.max[1]; ++y) {
                float* out = row(part, y, z);
                for (int64_t x = part.min[0]; x <= part.max[0]; ++x) {
                    const size_t n = size_t((x - origin[0]) << 6 | (y - origin[1]) << 3 | (z - origin[2]));
                    std::memcpy(out++, values.data() + n * leaf.entry_size, leaf.entry_size);
                }
            }
    }

    // Copies an upper or lower node; `below` is the layout of its children's level, none for leaves.
    void expand(uint64_t node, const Index& origin, const NodeLayout& layout, const NodeLayout* below)
    {
        // A sound file has each node once; this bounds the work on one that lets many entries share a node.
        if (++visited_ > data_.size() / leaf.size + 1) data_.damaged("its nodes overlap");
        const Bytes bytes(data_.slice(node, layout.size), data_.path());
        const int child_extent = layout.log2_extent - layout.log2_dimension;
        const int64_t mask = (int64_t(1) << layout.log2_dimension) - 1;
        for (int64_t n = 0; n < (int64_t(1) << (3 * layout.log2_dimension)); ++n) {
            const Index corner{origin[0] + ((n >> (2 * layout.log2_dimension)) << child_extent),
                               origin[1] + (((n >> layout.log2_dimension) & mask) << child_extent),
                               origin[2] + ((n & mask) << child_extent)};
            const uint64_t entry = layout.table + n * layout.entry_size;
            const bool child = bytes.get<uint64_t>(layout.child_mask + 8 * (n / 64)) >> (n % 64) & 1;
            if (!child) {
                fill(corner, child_extent, bytes.get<float>(entry));
                continue;
            }
            const uint64_t at = node + static_cast<uint64_t>(bytes.get<int64_t>(entry));
            if (below != nullptr)
                expand(at, corner, *below, nullptr);
            else
                copy_leaf(at, corner);
        }
    }

    Bytes data_;
    IndexBox box_;
    std::vector<float>* out_;
    uint64_t visited_ = 0;
};

NanoVdbGrid expand(const SparseGrid& grid, const IndexBox& box, const std::string& path)
{
    double voxels = 1.0;
    for (int axis = 0; axis < 3; ++axis) voxels *= static_cast<double>(box.extent(axis));
    if (voxels > static_cast<double>(nanovdb_voxel_limit))
        throw UserError(SourceLocation{path}, "NanoVDB grid '" + grid.name + "' spans more than " +
                                                  std::to_string(nanovdb_voxel_limit) + " voxels");
    NanoVdbGrid dense;
    dense.name = grid.name;
    dense.nx = static_cast<int>(box.extent(0));
    dense.ny = static_cast<int>(box.extent(1));
    dense.nz = static_cast<int>(box.extent(2));
    dense.values.resize(static_cast<size_t>(voxels));
    Expansion(grid, path, box, dense.values).run();
    for (const float value : dense.values)
        if (!std::isfinite(value)) Bytes({}, path).damaged("it holds values that are not finite");

    // Voxel i is centred on index i: the unit cube spans [min - 1/2, max + 1/2].
    Matrix4 index_from_unit;
    for (int axis = 0; axis < 3; ++axis) {
        index_from_unit.m[axis][axis] = static_cast<double>(box.extent(axis));
        index_from_unit.m[axis][3] = static_cast<double>(box.min[axis]) - 0.5;
    }
    dense.world_from_unit = Transform(grid.world_from_index * index_from_unit);
    for (int corner = 0; corner < 8; ++corner)
        dense.bounds.extendBy(dense.world_from_unit.point(Vec3(
            static_cast<float>(corner & 1), static_cast<float>(corner >> 1 & 1), static_cast<float>(corner >> 2))));
    return dense;
}

}  // namespace

std::vector<NanoVdbGrid> read_nanovdb(const std::string& path)
{
    const std::string content = read_file(path, SourceLocation{path});
    const Bytes file(std::as_bytes(std::span(content)), path);
    std::vector<SparseGrid> grids;
    uint64_t position = 0;
    do {
        read_segment(file, path, position, grids);
    } while (position < file.size());
    if (grids.empty()) throw UserError(SourceLocation{path}, "the NanoVDB file holds no grid of 32-bit floats");

    std::vector<NanoVdbGrid> result;
    for (const SparseGrid& grid : grids) {
        IndexBox box = grid.box;
        for (const SparseGrid& other : grids) {
            if (!(other.world_from_index == grid.world_from_index)) continue;
            for (int axis = 0; axis < 3; ++axis) {
                box.min[axis] = std::min(box.min[axis], other.box.min[axis]);
                box.max[axis] = std::max(box.max[axis], other.box.max[axis]);
            }
        }
        for (int axis = 0; axis < 3; ++axis) {
            --box.min[axis];
            ++box.max[axis];
        }
        result.push_back(expand(grid, box, path));
    }
    return result;
}

}  // namespace dapple
