// Rendering inside of tests: a scene (file or text), an integrator of the registry by name, its settings, a seed and a
// number of passes give images. It takes the same steps as `dapple render`, through the library.
#pragma once

#include "dapple/film/film.h"
#include "dapple/image/image.h"
#include "dapple/scene/description.h"
#include "dapple/world/world.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace dapple::testing {

using SettingList = std::vector<std::pair<std::string, std::string>>;

struct RenderRequest {
    std::string integrator = "path";
    SettingList settings;
    uint64_t seed = 1;
    uint32_t passes = 1;
    ColorModel color_model = ColorModel::spectral;
    bool layers = false;  // fill Rendered::layers too
};

struct Rendered {
    Image beauty;                       // RGB
    Image layers;                       // all layers; empty unless asked for
    std::vector<std::string> channels;  // names of the layers' channels
    uint64_t accidents = 0;             // samples that were not finite
};

// A scene that is read and compiled once and rendered many times.
class TestScene {
public:
    // Throw UserError as the readers do. `resolution`: replaces that of the scene, unless it is 0.
    static TestScene from_file(const std::filesystem::path& file, Int2 resolution = {0, 0});
    static TestScene from_text(const std::string& text, const std::filesystem::path& folder = ".",
                               Int2 resolution = {0, 0});

    TestScene(scene::Description description, Int2 resolution);

    const World& world() const { return *world_; }
    const scene::Description& description() const { return *description_; }
    // Whether the scene has only surfaces, or the integrator can do media.
    bool suits(const std::string& integrator) const;

    // Whether some eye path of the pixels [x0, x1) x [y0, y1), or of those beside them that filters reach, starts with
    // a surface that has a delta lobe; tried with 16 paths per pixel.
    bool sees_delta(int x0, int x1, int y0, int y1) const;

    Rendered render(const RenderRequest& request) const;

    // Independent images: `batches` renders of request.passes passes each, with seeds seed, seed + 1, ...
    std::vector<Image> render_batches(const RenderRequest& request, int batches) const;

private:
    std::unique_ptr<scene::Description> description_;
    std::unique_ptr<World> world_;
};

// The names of all integrators, in the order of the registry.
std::vector<std::string> integrator_names();
// Whether the integrator's table has the setting.
bool has_setting(const std::string& integrator, const std::string& setting);

// The text of a file; throws std::runtime_error when there is none.
std::string read_text(const std::filesystem::path& file);

}  // namespace dapple::testing
