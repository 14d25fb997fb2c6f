// Any bytes as a PLY mesh: the reader must return a mesh with indices in range or throw a UserError of one line.
#include "dapple/formats/ply.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    try {
        const auto mesh = dapple::parse_ply(std::string(reinterpret_cast<const char*>(data), size), "fuzz.ply");
        for (const auto* faces : {&mesh.triangles, &mesh.quads})
            for (uint32_t index : *faces)
                if (index >= mesh.positions.size()) std::abort();
    } catch (const dapple::UserError& error) {
        if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
    }
    return 0;
}
