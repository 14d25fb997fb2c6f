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

std::string error_of(const scene::Integrator& integrator, const std::string& asked,
                     const std::vector<std::pair<std::string, std::string>>& definitions)
{
    try {
        choose_integrator(integrator, asked, definitions);
    } catch (const UserError& error) {
        return error.what();
    }
    return "no error";
}

TEST(SceneDefaults, ErrorsAndNotesHaveThePlaceInTheScene)
{
    scene::Integrator integrator = named("vlpath");
    integrator.at = {"a.pbrt", 3, 1};
    EXPECT_EQ(error_of(integrator, "", {}),
              "a.pbrt:3:1: unknown integrator 'vlpath'; did you mean 'volpath'? (-i NAME renders with another)");
    EXPECT_EQ(error_of(integrator, "path", {}), "no error");
    integrator.name = "ao";
    const IntegratorChoice choice = choose_integrator(integrator, "", {});
    EXPECT_EQ(choice.entry->name, "path");
    ASSERT_EQ(choice.notes.size(), 1u);
    EXPECT_EQ(choice.notes[0],
              "a.pbrt:3:1: the scene asks for integrator 'ao'; 'path' is used in its place (-i chooses another)");
    integrator.parameters = {{"maxdepth", "-3", {"a.pbrt", 3, 17}}};
    EXPECT_EQ(error_of(integrator, "path", {}),
              "a.pbrt:3:17: setting 'maxdepth' takes a number of 0 or more, not '-3'");
}

TEST(SceneDefaults, UnknownSettingsNameTheNearestOrTheirOwner)
{
    EXPECT_EQ(error_of({}, "sppm", {{"radiustst", "true"}}),
              "sppm has no setting 'radiustst'; did you mean 'radiustest'? ('dapple integrators sppm' lists its own)");
    EXPECT_EQ(error_of({}, "bdpt", {{"kernel", "cone"}}),
              "bdpt has no setting 'kernel'; it is a setting of photonmap, irradiancecache, sppm, photonsplat, vcm "
              "('dapple integrators bdpt' lists its own)");
    EXPECT_EQ(error_of({}, "path", {{"radiustst", "true"}}),
              "path has no setting 'radiustst'; 'radiustest' is a setting of sppm ('dapple integrators path' lists its "
              "own)");
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
