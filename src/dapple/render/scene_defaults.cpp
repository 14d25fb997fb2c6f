// pbrt-v4's integrators and what stands for them here.
#include "dapple/render/scene_defaults.h"

#include "dapple/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace dapple {
namespace {

struct Substitute {
    std::string_view pbrt;
    std::string_view dapple;
    bool note;  // another algorithm: the user should know
};
constexpr std::array<Substitute, 12> substitutes = {{{"path", "path", false},
                                                     {"volpath", "path", false},
                                                     {"simplepath", "path", false},
                                                     {"simplevolpath", "path", false},
                                                     {"lightpath", "lightpath", false},
                                                     {"bdpt", "bdpt", false},
                                                     {"mlt", "vcm", true},
                                                     {"sppm", "sppm", false},
                                                     {"randomwalk", "path", true},
                                                     {"ambientocclusion", "path", true},
                                                     {"function", "path", true},
                                                     {"photonmap", "photonmap", false}}};

bool has_setting(const IntegratorEntry& entry, std::string_view name)
{
    return std::any_of(entry.settings.begin(), entry.settings.end(),
                       [&](const SettingInfo& info) { return info.name == name; });
}

}  // namespace

IntegratorChoice choose_integrator(const scene::Integrator& scene_integrator, const std::string& asked,
                                   const std::vector<std::pair<std::string, std::string>>& definitions)
{
    IntegratorChoice choice;
    std::string name = asked;
    if (name.empty()) {
        const auto found = std::find_if(substitutes.begin(), substitutes.end(),
                                        [&](const Substitute& s) { return s.pbrt == scene_integrator.name; });
        name = found != substitutes.end() ? std::string(found->dapple) : scene_integrator.name;
        if (found != substitutes.end() && found->note)
            choice.notes.push_back(
                fmt::format("the scene asks for integrator '{}'; '{}' is used in its place "
                            "(--integrator chooses another)",
                            scene_integrator.name, name));
    }
    choice.entry = &find_integrator(name);
    choice.settings = Settings(choice.entry->settings);
    for (const scene::IntegratorParameter& parameter : scene_integrator.parameters)
        if (parameter.name == "maxdepth" && has_setting(*choice.entry, "maxdepth"))
            choice.settings.set("maxdepth", parameter.value);
    for (const auto& [setting, value] : definitions) choice.settings.set(setting, value);
    return choice;
}

}  // namespace dapple
