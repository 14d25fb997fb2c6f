// What stands for the integrators that scenes name.
#include "dapple/render/scene_defaults.h"

#include "dapple/base/error.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

scene::Integrator named(const std::string& name)
{
    scene::Integrator integrator;
    integrator.name = name;
    return integrator;
}

TEST(SceneDefaults, PathTracersBecomePath)
{
    for (const char* name : {"path", "volpath", "simplepath"}) {
        const IntegratorChoice choice = choose_integrator(named(name), "", {});
        EXPECT_EQ(choice.entry->name, "path") << name;
        EXPECT_TRUE(choice.notes.empty()) << name;
    }
    EXPECT_EQ(choose_integrator(named("lightpath"), "", {}).entry->name, "lightpath");
}

TEST(SceneDefaults, LightMethodsKeepTheirNames)
{
    for (const char* name : {"bdpt", "sppm"}) {
        const IntegratorChoice choice = choose_integrator(named(name), "", {});
        EXPECT_EQ(choice.entry->name, name);
        EXPECT_TRUE(choice.notes.empty()) << name;
    }
    const IntegratorChoice choice = choose_integrator(named("mlt"), "", {});
    EXPECT_EQ(choice.entry->name, "vcm");
    EXPECT_EQ(choice.notes.size(), 1u);
}

TEST(SceneDefaults, TheCommandLineWins)
{
    scene::Integrator integrator = named("sppm");
    integrator.parameters = {{"maxdepth", "7", {}}, {"radius", "1", {}}};
    IntegratorChoice choice = choose_integrator(integrator, "path", {});
    EXPECT_EQ(choice.entry->name, "path");
    EXPECT_TRUE(choice.notes.empty());
    EXPECT_EQ(choice.settings.integer("maxdepth"), 7);
    choice = choose_integrator(integrator, "path", {{"maxdepth", "3"}});
    EXPECT_EQ(choice.settings.integer("maxdepth"), 3);
}

TEST(SceneDefaults, UnknownNamesAreErrors)
{
    EXPECT_THROW(choose_integrator(named("path"), "pth", {}), UserError);
    EXPECT_THROW(choose_integrator(named("path"), "", {{"maxdeth", "3"}}), UserError);
    EXPECT_THROW(choose_integrator(named("path"), "", {{"maxdepth", "-3"}}), UserError);
}

// Every table of settings can be read: fallbacks have the form that they ask of the user.
TEST(Registry, FallbacksKeepTheirOwnRanges)
{
    for (const IntegratorEntry& entry : integrator_registry()) {
        Settings settings(entry.settings);
        for (const SettingInfo& info : entry.settings) {
            EXPECT_NO_THROW(settings.set(std::string(info.name), std::string(info.fallback)))
                << entry.name << "." << info.name;
            EXPECT_FALSE(info.text.empty()) << entry.name << "." << info.name;
        }
    }
}

}  // namespace
}  // namespace dapple
