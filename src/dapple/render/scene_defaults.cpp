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
constexpr std::array<Substitute, 10> substitutes = {{{"volpath", "path", false},
                                                     {"simplepath", "path", false},
                                                     {"simplevolpath", "path", false},
                                                     {"mlt", "vcm", true},
                                                     {"randomwalk", "path", true},
                                                     {"ambientocclusion", "path", true},
                                                     {"function", "path", true},
                                                     {"ao", "path", true},  // pbrt-v3's, and the next two
                                                     {"whitted", "path", true},
                                                     {"directlighting", "path", true}}};

bool has_setting(const IntegratorEntry& entry, std::string_view name)
{
    return std::any_of(entry.settings.begin(), entry.settings.end(),
                       [&](const SettingInfo& info) { return info.name == name; });
}

// What stands for the scene's integrator; another algorithm is noted.
const IntegratorEntry& stand_in(const scene::Integrator& integrator, std::vector<std::string>& notes)
{
    std::vector<std::string_view> known;
    for (const Substitute& substitute : substitutes) {
        known.push_back(substitute.pbrt);
        if (substitute.pbrt != integrator.name) continue;
        if (substitute.note)
            notes.push_back(fmt::format(
                "{}{}the scene asks for integrator '{}'; '{}' is used in its place (-i chooses another)",
                integrator.at.to_string(), integrator.at.file.empty() ? "" : ": ", integrator.name, substitute.dapple));
        return find_integrator(substitute.dapple);
    }
    for (const IntegratorEntry& entry : integrator_registry()) {
        if (entry.name == integrator.name) return entry;
        known.push_back(entry.name);
    }
    throw UserError(integrator.at, fmt::format("unknown integrator '{}'{} (-i NAME renders with another)",
                                               integrator.name, did_you_mean(integrator.name, known)));
}

// "sppm, vcm"; empty where no algorithm has the setting.
std::string owners_of(std::string_view setting)
{
    std::string owners;
    for (const IntegratorEntry& entry : integrator_registry())
        if (has_setting(entry, setting)) owners.append(owners.empty() ? "" : ", ").append(entry.name);
    return owners;
}

// Throws UserError: the nearest setting that the integrator has, or whose the setting is.
[[noreturn]] void refuse_setting(const IntegratorEntry& integrator, const std::string& name)
{
    std::vector<std::string_view> own, all;
    for (const SettingInfo& info : integrator.settings) own.push_back(info.name);
    for (const IntegratorEntry& entry : integrator_registry())
        for (const SettingInfo& info : entry.settings) all.push_back(info.name);
    std::string hint = did_you_mean(name, own);
    if (const std::string owners = owners_of(name); !owners.empty())
        hint = fmt::format("; it is a setting of {}{}", owners, hint);
    else if (const std::string_view nearest = nearest_word(name, all); hint.empty() && !nearest.empty())
        hint = fmt::format("; '{}' is a setting of {}", nearest, owners_of(nearest));
    throw UserError(fmt::format("{0} has no setting '{1}'{2} ('dapple integrators {0}' lists its own)", integrator.name,
                                name, hint));
}

}  // namespace

IntegratorChoice choose_integrator(const scene::Integrator& scene_integrator, const std::string& asked,
                                   const std::vector<std::pair<std::string, std::string>>& definitions)
{
    IntegratorChoice choice;
    choice.entry = asked.empty() ? &stand_in(scene_integrator, choice.notes) : &find_integrator(asked);
    choice.settings = Settings(choice.entry->settings);
    for (const scene::IntegratorParameter& parameter : scene_integrator.parameters)
        if (parameter.name == "maxdepth" && has_setting(*choice.entry, "maxdepth")) {
            try {
                choice.settings.set("maxdepth", parameter.value);
            } catch (const UserError& error) {
                throw UserError(parameter.at, error.what());
            }
        }
    for (const auto& [setting, value] : definitions) {
        if (!has_setting(*choice.entry, setting)) refuse_setting(*choice.entry, setting);
        choice.settings.set(setting, value);
    }
    return choice;
}

}  // namespace dapple
