// Any bytes as a pbrt scene: the reader must return a scene or throw a UserError of one line. It opens no other files.
#include "dapple/formats/pbrt.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    try {
        dapple::read_pbrt_string(std::string(reinterpret_cast<const char*>(data), size), "fuzz.pbrt", "",
                                 {.other_files = false});
    } catch (const dapple::UserError& error) {
        if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
    }
    return 0;
}
