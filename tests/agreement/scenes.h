// The scenes of this ring, and settings that suit pictures of a thousand pixels.
#pragma once

#include "support/render_scene.h"

#include <algorithm>

namespace dapple::testing {

inline std::vector<std::string> agreement_scenes()
{
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(DAPPLE_AGREEMENT_SCENES))
        if (entry.path().extension() == ".pbrt") names.push_back(entry.path().stem());
    std::sort(names.begin(), names.end());
    return names;
}

inline TestScene agreement_scene(const std::string& name)
{
    return TestScene::from_file(std::filesystem::path(DAPPLE_AGREEMENT_SCENES) / (name + ".pbrt"));
}

// One set of photon maps for all passes of a batch, or photons for each pass.
inline SettingList small_settings(const std::string& integrator, uint32_t passes)
{
    const SettingList wanted = {{"photons", has_setting(integrator, "epoch") ? "20000" : "5000"},
                                {"causticphotons", "20000"},
                                {"epoch", std::to_string(passes)},
                                {"gatherrays", "2"}};
    SettingList known;
    for (const auto& setting : wanted)
        if (has_setting(integrator, setting.first)) known.push_back(setting);
    return known;
}

}  // namespace dapple::testing
