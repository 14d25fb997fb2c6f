// The light of an environment does not depend on which objects there are, and is there if there are none (mitsuba#80).
#include "peers/peers.h"

namespace dapple::testing {
namespace {

constexpr const char* floor_text = R"(Material "diffuse" "rgb reflectance" [0.5 0.5 0.5]
Shape "bilinearmesh" "point3 P" [-0.6 -0.6 0  0.6 -0.6 0  -0.6 0.6 0  0.6 0.6 0]
)";
// A ball beneath the floor, where it neither shades nor lights the side that is seen.
std::string ball(double depth, double radius)
{
    return fmt::format(
        "AttributeBegin\nMaterial \"diffuse\"\nTranslate 0 0 {}\nShape \"sphere\" \"float radius\" [{}]\n"
        "AttributeEnd\n",
        -depth, radius);
}

TestScene under_the_sky(const std::string& objects)
{
    return TestScene::from_text(R"(LookAt 0 0 0.25  0 0 0  0 1 0
Camera "orthographic" "float screenwindow" [-0.3 0.3 -0.3 0.3]
Film "rgb" "integer xresolution" [8] "integer yresolution" [8]
PixelFilter "box"
WorldBegin
LightSource "infinite" "rgb L" [2 2 2]
)" + objects);
}

class Environment : public PeerTest {};

TEST_P(Environment, DoesNotDependOnWhichObjectsThereAre)
{
    const std::pair<const char*, std::string> scenes[] = {
        {"floor alone", floor_text},
        {"a ball beneath", floor_text + ball(0.5, 0.3)},
        {"a ball added first", ball(0.5, 0.3) + floor_text},
        {"three balls", floor_text + ball(0.5, 0.3) + ball(1, 0.1) + ball(1.5, 0.2)},
        {"a ball far away", floor_text + ball(5, 0.3)}};
    for (const auto& [name, objects] : scenes) {
        // Particles are spread over all that there is: more of them where it is large.
        const int light_paths = std::string(name).find("far") != std::string::npos ? 20000 : 2000;
        expect_value(peer_mean(under_the_sky(objects), peer_request(GetParam(), 4, light_paths)), 1.0, 0.01, 0.03,
                     fmt::format("{}, {}", GetParam(), name));
    }
}

// Strategies must know each other's densities whatever the size of the scene is: none of those who sample the sky from
// the floor may lose or double it when an object is a kilometre away.
TEST_P(Environment, DoesNotFadeWithAnObjectFarAway)
{
    for (const char* blind : {"lightpath", "sppm", "photonsplat"})
        if (GetParam() == blind) GTEST_SKIP() << "particles alone bring this light: one in 1e7 would meet the floor";
    expect_value(peer_mean(under_the_sky(floor_text + ball(1000, 1)), peer_request(GetParam(), 16)), 1.0, 0, 0.02,
                 GetParam());
}

TEST_P(Environment, IsThereWithoutObjects)
{
    const Rendered rendered = under_the_sky("").render(peer_request(GetParam(), 2));
    for (float v : rendered.beauty.pixels) ASSERT_NEAR(v, 2.0f, 1e-5f);
    EXPECT_EQ(rendered.accidents, 0u);
}

// White furnace: clear and matte objects of reflectance 1 vanish before a sky of radiance 2.
TEST_P(Environment, HidesWhiteObjects)
{
    const std::string white = R"(Material "diffuse" "rgb reflectance" [1 1 1]
Shape "sphere" "float radius" [0.2]
)";
    const std::string clear = R"(Material "dielectric"
Translate 0.1 0 0.05
Shape "sphere" "float radius" [0.15]
)";
    const std::pair<const char*, std::string> scenes[] = {{"matte", white}, {"clear", clear}, {"both", white + clear}};
    for (const auto& [name, objects] : scenes) {
        // Light tracing cannot see a matte object through glass.
        if (GetParam() == "lightpath" && std::string(name) == "both") continue;
        // The disc of a photon estimate is larger than it looks on a ball.
        const bool merges = has_setting(GetParam(), "radius");
        RenderRequest request = peer_request(GetParam(), 4, 4000);
        if (merges) request.settings.emplace_back("radius", "0.5");
        expect_value(peer_mean(under_the_sky(objects), request), 2.0, merges ? 0.02 : 0, 0.02,
                     fmt::format("{}, {}", GetParam(), name));
    }
}

INSTANTIATE_TEST_SUITE_P(Integrators, Environment, ::testing::ValuesIn(integrator_names()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace dapple::testing
