// Meshes in the PLY format (Turk 1994): ascii, binary in either byte order, and gzip'ed files of these.
#pragma once

#include "dapple/base/error.h"
#include "dapple/scene/geometry.h"

#include <filesystem>
#include <string>

namespace dapple {

// Reads element "vertex" (x y z, nx ny nz, and u v or s t) and element "face" (vertex_indices or vertex_index with
// three or four entries). Quadrangles become bilinear patches. Other elements and properties are skipped.
// `where` names the file in the scene. Throws UserError for anything out of form; memory is bounded by the file's size.
scene::MeshData read_ply(const std::filesystem::path& path, const SourceLocation& where);

// The same for a file's content; `name` stands for it in messages.
scene::MeshData parse_ply(const std::string& content, const std::string& name);

}  // namespace dapple
