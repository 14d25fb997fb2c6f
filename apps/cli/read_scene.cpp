// Scene files in: what every sub-command does with the name of a scene.
#include "commands.h"
#include "dapple/formats/nanovdb.h"
#include "dapple/formats/pbrt.h"

namespace dapple::cli {

scene::Description read_scene(const std::string& path)
{
    scene::Description description = read_pbrt(path);
    for (scene::Medium& medium : description.media) expand_nanovdb(medium);
    return description;
}

}  // namespace dapple::cli
