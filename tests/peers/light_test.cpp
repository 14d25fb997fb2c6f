// Lights: each kind sends the same flux by each strategy, bare and through glass (povray#464); each of many lights is
// sampled (pbrt-v4#163); what a light's shape is made of does not change its flux, and no ray meets the emitter that it
// has just left (mitsuba3#42).
#include "peers/peers.h"

#include "dapple/transport/emission.h"

#include <functional>

namespace dapple::testing {
namespace {

// Of an area light facing down at height 1.2, transform included.
std::string area_light(const std::string& shape, const std::string& more = "")
{
    return "AttributeBegin\nMaterial \"diffuse\" \"rgb reflectance\" [0 0 0]\n"
           "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] " +
           more + "\nTranslate 0.1 0 1.2\nRotate 180 1 0 0\n" + shape + "\nAttributeEnd\n";
}

struct LightKind {
    const char* name;
    std::string text;
    bool delta = false;                                      // cannot be met by a ray
    std::function<double(double x, double y)> irradiance{};  // on the plane z = 0; none: not known in closed form
};

std::vector<LightKind> light_kinds()
{
    const auto point = [](double x0) {
        return [x0](double x, double y) { return 1.2 / std::pow((x - x0) * (x - x0) + y * y + 1.44, 1.5); };
    };
    const std::string image = std::string(" \"string filename\" \"") + DAPPLE_AGREEMENT_SCENES + "/sky.png\"";
    return {
        {"point", "LightSource \"point\" \"rgb I\" [1 1 1] \"point3 from\" [0.1 0 1.2]\n", true, point(0.1)},
        {"spot",
         "LightSource \"spot\" \"rgb I\" [1 1 1] \"point3 from\" [0 0 1.2] \"point3 to\" [0 0 0] \"float coneangle\" "
         "[60] \"float conedeltaangle\" [10]\n",
         true, point(0)},
        {"distant", "LightSource \"distant\" \"rgb L\" [1 1 1] \"point3 from\" [0.3 0.2 1] \"point3 to\" [0 0 0]\n",
         true, [](double, double) { return 1 / std::sqrt(1 + 0.09 + 0.04); }},
        {"infinite", "LightSource \"infinite\" \"rgb L\" [1 1 1]\n", false, [](double, double) { return M_PI; }},
        {"infinite_image", "LightSource \"infinite\"" + image + "\n"},
        {"goniometric",
         "AttributeBegin\nTranslate 0 0 1.2\nLightSource \"goniometric\" \"rgb I\" [1 1 1]" + image +
             "\nAttributeEnd\n",
         true},
        {"projection",
         "AttributeBegin\nTranslate 0 0 1.2\nRotate 180 1 0 0\nLightSource \"projection\" \"float fov\" [70]" + image +
             "\nAttributeEnd\n",
         true},
        {"sphere", area_light("Shape \"sphere\" \"float radius\" [0.2]"), false,
         [point](double x, double y) { return M_PI * 0.04 * point(0.1)(x, y); }},
        {"disk", area_light("Shape \"disk\" \"float radius\" [0.4]")},
        {"cylinder",
         area_light(
             "Rotate 90 0 1 0\nShape \"cylinder\" \"float radius\" [0.2] \"float zmin\" [-0.3] \"float zmax\" [0.3]")},
        {"rectangle",
         area_light("Shape \"bilinearmesh\" \"point3 P\" [-0.3 -0.3 0  0.3 -0.3 0  -0.3 0.3 0  0.3 0.3 0]")},
        {"mesh",
         area_light("Shape \"trianglemesh\" \"point3 P\" [-0.3 -0.3 0  0.3 -0.3 0  0.3 0.3 0  -0.3 0.3 0] \"integer "
                    "indices\" [0 1 2 0 2 3]")},
        {"two_sided", area_light("Shape \"disk\" \"float radius\" [0.4]", "\"bool twosided\" [true]")},
    };
}

// The camera hangs low over the floor, beneath a pane if there is one.
TestScene lit_floor(const std::string& lights, bool pane)
{
    std::string text = R"(LookAt 0 0 0.25  0 0 0  0 1 0
Camera "orthographic" "float screenwindow" [-0.3 0.3 -0.3 0.3]
Film "rgb" "integer xresolution" [8] "integer yresolution" [8]
PixelFilter "box"
WorldBegin
)" + lights + R"(Material "diffuse" "rgb reflectance" [0.5 0.5 0.5]
Shape "bilinearmesh" "point3 P" [-0.6 -0.6 0  0.6 -0.6 0  -0.6 0.6 0  0.6 0.6 0]
)";
    if (pane)
        text += R"(Material "thindielectric"
Shape "bilinearmesh" "point3 P" [-1.2 -1.2 0.5  1.2 -1.2 0.5  -1.2 1.2 0.5  1.2 1.2 0.5]
)";
    return TestScene::from_text(text);
}

// Radiance of the floor's picture for an irradiance known everywhere.
double mean_radiance(const std::function<double(double, double)>& irradiance)
{
    constexpr int n = 64;
    double sum = 0;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) sum += irradiance(((i + 0.5) / n - 0.5) * 0.6, ((j + 0.5) / n - 0.5) * 0.6);
    return 0.5 / M_PI * sum / (n * n);
}

// Blur of photon estimates over a floor of nearly even light.
constexpr double floor_bias = 0.01;

class EveryLightKind : public ::testing::TestWithParam<LightKind> {};

TEST_P(EveryLightKind, LightsAPlaneAlikeByEveryStrategy)
{
    const LightKind& kind = GetParam();
    for (bool pane : {false, true}) {
        const TestScene scene = lit_floor(kind.text, pane);
        // Light tracing can do all of them.
        const Estimate wanted = peer_mean(scene, peer_request("lightpath", 12, 2000));
        ASSERT_GT(wanted.mean, 0);
        if (kind.irradiance && !pane)
            expect_value(wanted, mean_radiance(kind.irradiance), 0, 0.02, fmt::format("{}, lightpath", kind.name));
        for (const std::string& integrator : integrator_names()) {
            if (integrator == "lightpath") continue;
            // No ray through glass meets a light without extent.
            if (pane && kind.delta && integrator == "path") continue;
            // Path tracing meets a small light through glass by chance.
            const uint32_t passes = pane && integrator == "path" ? 64 : 2;
            expect_same(wanted, peer_mean(scene, peer_request(integrator, passes, 2000)), floor_bias, 0.06,
                        fmt::format("{}{}, lightpath and {}", kind.name, pane ? " under glass" : "", integrator));
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Lights, EveryLightKind, ::testing::ValuesIn(light_kinds()),
                         [](const auto& test) { return std::string(test.param.name); });

class ManyLights : public PeerTest {};

TEST_P(ManyLights, AloneSumToAllTogether)
{
    // Each light with what stays of it when it is out: its body, which shades the others.
    std::vector<std::pair<std::string, std::string>> lights;
    const auto body = [&](const std::string& place, const std::string& shape) {
        const std::string begin = "AttributeBegin\nMaterial \"diffuse\" \"rgb reflectance\" [0 0 0]\n" + place;
        const std::string end = "\nRotate 180 1 0 0\n" + shape + "\nAttributeEnd\n";
        lights.emplace_back(begin + "\nAreaLightSource \"diffuse\" \"rgb L\" [3 3 3]" + end, begin + end);
    };
    for (const LightKind& kind : light_kinds())
        for (const char* wanted : {"point", "distant", "infinite", "infinite_image"})
            if (std::string(kind.name) == wanted) lights.emplace_back(kind.text, "");
    // A second sky, and one that is dim beside the others.
    lights.emplace_back("LightSource \"infinite\" \"rgb L\" [0.5 1 1.5]\n", "");
    lights.emplace_back("LightSource \"infinite\" \"rgb L\" [0.02 0.02 0.02]\n", "");
    body("Translate 0.5 0.3 0.9", "Shape \"sphere\" \"float radius\" [0.15]");
    body(
        "Translate -0.5 0 0.8",
        "Shape \"trianglemesh\" \"point3 P\" [-0.2 -0.2 0  0.2 -0.2 0  0.2 0.2 0  -0.2 0.2 0] \"integer indices\" [0 1 "
        "2 0 2 3]");
    ASSERT_EQ(lights.size(), 8u);
    Estimate sum{0, 0, peer_batches};
    RenderRequest request = peer_request(GetParam(), 2, 2000);
    std::string together;
    for (size_t lit = 0; lit < lights.size(); ++lit) {
        std::string text;
        for (size_t i = 0; i < lights.size(); ++i) text += i == lit ? lights[i].first : lights[i].second;
        together += lights[lit].first;
        const Estimate alone = peer_mean(lit_floor(text, false), request);
        EXPECT_GT(alone.mean, 0) << lights[lit].first;
        sum.mean += alone.mean;
        sum.error = std::hypot(sum.error, alone.error);
        request.seed += peer_batches;
    }
    request.passes *= 4;
    expect_same(sum, peer_mean(lit_floor(together, false), request), 0, 0.02, GetParam());
}

INSTANTIATE_TEST_SUITE_P(Integrators, ManyLights, ::testing::ValuesIn(integrator_names()),
                         [](const auto& test) { return test.param; });

struct Flux {
    double mean = 0, error = 0;
    int met_again = 0;  // particles whose first hit is a light
};

// All lights of the scene; each is a thing of its own that cannot see itself or another.
Flux emitted_flux(const TestScene& scene)
{
    constexpr uint32_t paths = 50000;
    double sum = 0, squares = 0;
    Flux flux;
    for (uint32_t i = 0; i < paths; ++i) {
        RandomStream random(5, 3, i);
        Walk walk;
        Departure departure;
        if (!emit(scene.world(), path_start(Wavelengths::rgb(), random.next_2d()), random, walk, departure)) continue;
        sum += walk.source()[1];
        squares += double(walk.source()[1]) * walk.source()[1];
        const Vertex* vertex = walk.next(scene.world(), random);
        if (vertex && vertex->emitter.valid()) ++flux.met_again;
    }
    flux.mean = sum / paths;
    flux.error = std::sqrt(std::max(0.0, squares / paths - flux.mean * flux.mean) / paths);
    return flux;
}

std::string emitter(const std::string& place, const std::string& shape, bool two_sided)
{
    return fmt::format(R"(WorldBegin
AttributeBegin
{}
AreaLightSource "diffuse" "rgb L" [1 1 1] "bool twosided" [{}]
{}
AttributeEnd
Material "diffuse" "rgb reflectance" [0.5 0.5 0.5]
Shape "sphere" "float radius" [1e6]
)",
                       place, two_sided, shape);
}

// The rays leave rectangles near and far from the origin, large and small, in any attitude: far away the rounding of
// coordinates would put them behind the surface that they leave.
TEST(Emitters, HaveTheFluxOfTheirShapeAndAreNotMetAgain)
{
    const std::pair<const char*, std::string> shapes[] = {
        {"bilinear", "Shape \"bilinearmesh\" \"point3 P\" [-0.5 -1 0  0.5 -1 0  -0.5 1 0  0.5 1 0]"},
        {"mesh",
         "Shape \"trianglemesh\" \"point3 P\" [-0.5 -1 0  0.5 -1 0  0.5 1 0  -0.5 1 0] \"integer indices\" [0 1 2 0 2 "
         "3]"}};
    struct Place {
        const char* text;
        double scale;
    };
    for (const Place& place : {Place{"", 1}, Place{"Translate 1000 -2000 3000 Rotate 37 1 2 3", 1},
                               Place{"Rotate 100 3 -1 0.5 Scale 1e-3 1e-3 1e-3", 1e-3},
                               Place{"Translate 20000 3e4 -5 Rotate 211 1 1 -3 Scale 200 200 200", 200}})
        for (bool two_sided : {false, true})
            for (const auto& [name, shape] : shapes) {
                const TestScene scene = TestScene::from_text(emitter(place.text, shape, two_sided));
                const Flux flux = emitted_flux(scene);
                const double expected = M_PI * 2 * place.scale * place.scale * (two_sided ? 2 : 1);
                EXPECT_NEAR(flux.mean, expected, 4.5 * flux.error + 1e-4 * expected) << name << " " << place.text;
                EXPECT_LT(flux.error, 1e-3 * expected);
                EXPECT_EQ(flux.met_again, 0) << name << " " << place.text << " two sided: " << two_sided;
            }
    // Round ones: their outside does not see itself.
    for (const char* shape : {"Shape \"sphere\"", "Shape \"cylinder\"", "Shape \"disk\""})
        for (const char* place : {"", "Translate 1000 -2000 3000 Rotate 37 1 2 3"}) {
            const Flux flux = emitted_flux(TestScene::from_text(emitter(place, shape, false)));
            const double area = std::string(shape).find("disk") == std::string::npos ? 4 * M_PI : M_PI;
            EXPECT_NEAR(flux.mean, M_PI * area, 4.5 * flux.error + 1e-4 * M_PI * area) << shape << " " << place;
            EXPECT_EQ(flux.met_again, 0) << shape << " " << place;
        }
}

}  // namespace
}  // namespace dapple::testing
