// Strategies of bidirectional methods, each alone: over a bumpy floor every one of them has the picture of path tracing
// (pbrt-v4#13, #385), and none depends on how far light and camera are (LuxCore#678).
#include "peers/peers.h"

#include "dapple/integrators/integrator.h"
#include "dapple/integrators/technique_films.h"
#include "dapple/render/film_settings.h"
#include "dapple/render/scene_defaults.h"

#include <map>

namespace dapple::testing {
namespace {

// A strongly bumped floor under a large lamp, and a wall that keeps its distance from it: no two surfaces touch, so
// that strategies that join vertices at any distance have a finite spread. Each path of two or three edges can be found
// by every strategy.
constexpr const char* bumpy_floor = R"(LookAt 0 1 2.5  0 -0.6 -0.3  0 1 0
Camera "perspective" "float fov" [30]
Film "rgb" "integer xresolution" [8] "integer yresolution" [8]
PixelFilter "box"
WorldBegin
AttributeBegin
Material "diffuse" "rgb reflectance" [0 0 0]
AreaLightSource "diffuse" "rgb L" [1 1 1]
Translate 0 1.2 0.6
Rotate 90 1 0 0
Shape "disk" "float radius" [0.8]
AttributeEnd
Material "diffuse" "rgb reflectance" [0.8 0.8 0.8]
Shape "bilinearmesh" "point3 P" [-1 -0.3 -1.5  1 -0.3 -1.5  -1 1.4 -1.5  1 1.4 -1.5]
Texture "height" "float" "imagemap" "string filename" "DAPPLE/waves_normal.png" "float scale" [0.3]
Material "diffuse" "rgb reflectance" [0.6 0.6 0.6] "texture displacement" "height"
Shape "bilinearmesh" "point3 P" [-1.5 -1 1.5  1.5 -1 1.5  -1.5 -1 -1.2  1.5 -1 -1.2] "point2 uv" [0 0 3 0 0 3 3 3]
)";

std::string with_scenes(std::string text)
{
    const std::string word = "DAPPLE";
    for (size_t at; (at = text.find(word)) != std::string::npos;)
        text.replace(at, word.size(), DAPPLE_AGREEMENT_SCENES);
    return text;
}

// What each strategy brings without weights, by name ("s1t2"), one value per batch; empty if the integrator has none.
std::map<std::string, std::vector<double>> alone(const TestScene& scene, const RenderRequest& request, int batches)
{
    const IntegratorChoice choice =
        choose_integrator(scene.description().integrator, request.integrator, request.settings);
    std::map<std::string, std::vector<double>> means;
    for (int batch = 0; batch < batches; ++batch) {
        const FilmSettings settings = film_settings(scene.description(), scene.world(), {false, false, false, false},
                                                    choice.entry->photon_layers, request.color_model);
        Film film(settings);
        TechniqueFilms films(settings, 3);
        const std::unique_ptr<Integrator> integrator = choice.entry->create(scene.world(), choice.settings);
        if (!integrator->record_techniques(films)) return {};
        Statistics statistics;
        for (uint32_t pass = 0; pass < request.passes; ++pass) {
            integrator->render_pass(
                {scene.world(), request.seed + static_cast<uint64_t>(batch), pass, statistics, nullptr}, film);
            film.end_pass();
            films.end_pass();
        }
        std::vector<std::string> channels;
        const Image layers = films.layers(channels);
        const std::string begin = "unweighted.", end = ".G";
        for (size_t c = 0; c < channels.size(); ++c)
            if (channels[c].starts_with(begin) && channels[c].ends_with(end))
                means[channels[c].substr(begin.size(), channels[c].size() - begin.size() - end.size())].push_back(
                    channel_mean(layers, static_cast<int>(c)));
    }
    return means;
}

// Light of paths of just this many edges, by path tracing.
Estimate path_of_edges(const TestScene& scene, int edges)
{
    const auto up_to = [&](int longest, uint64_t seed) {
        RenderRequest request = peer_request("path", 256);
        request.seed = seed;
        request.settings.emplace_back("maxdepth", std::to_string(longest - 1));
        return peer_mean(scene, request);
    };
    Estimate all = up_to(edges, 1);
    const Estimate shorter = up_to(edges - 1, 1001);
    all.mean -= shorter.mean;
    all.error = std::hypot(all.error, shorter.error);
    return all;
}

class Strategies : public PeerTest {};

TEST_P(Strategies, HaveEachAloneThePictureOfPathTracingOverABumpyFloor)
{
    const TestScene scene = TestScene::from_text(with_scenes(bumpy_floor));
    RenderRequest request = peer_request(GetParam(), 24, 1000);
    if (has_setting(GetParam(), "radius")) request.settings.emplace_back("radius", "0.5");
    const auto all = alone(scene, request, peer_batches);
    if (all.empty()) GTEST_SKIP() << GetParam() << " has no strategies of its own";
    // Merging is blurred at the edges of the floor's bumps and of its own.
    const bool merges = has_setting(GetParam(), "radius");
    for (const int edges : {2, 3}) {
        const Estimate wanted = path_of_edges(scene, edges);
        ASSERT_GT(wanted.mean, 0);
        int strategies = 0;
        for (const auto& [name, means] : all) {
            int s = 0, t = 0;
            char kind = 0;
            ASSERT_EQ(sscanf(name.c_str(), "%c%dt%d", &kind, &s, &t), name == "rest" ? 1 : 3) << name;
            if (name == "rest" || s + t - (kind == 'm' ? 2 : 1) != edges) continue;
            const Estimate found = estimate(means);
            if (found.mean == 0) continue;  // does not take part: lightpath has but one
            ++strategies;
            fmt::print("[ measured ] {}, {} alone / path: {:.4f} +- {:.4f}\n", GetParam(), name,
                       found.mean / wanted.mean, std::hypot(found.error, wanted.error) / wanted.mean);
            expect_same(wanted, found, kind == 'm' ? 0.05 : 0, s == 0 ? 0.2 : 0.07, GetParam() + ", " + name);
        }
        EXPECT_EQ(strategies, GetParam() == "lightpath" ? 1 : merges ? 2 * edges : edges + 1);
    }
}

INSTANTIATE_TEST_SUITE_P(Integrators, Strategies, ::testing::ValuesIn(integrator_names()),
                         [](const auto& test) { return test.param; });

// A small matte square, lit by a spot along its normal and seen by the same way back; a pane may hang before it, which
// leaves but one strategy to bidirectional methods. Light and camera move away while intensity and view grow, so that
// the picture stays: all but the direction of the light, which the integral below knows.
struct Distances {
    double light, camera;
    bool pane;
};

double thin_pane(double cosine)
{
    const double sine2 = (1 - cosine * cosine) / 2.25, inside = std::sqrt(1 - sine2);
    const double parallel = (1.5 * cosine - inside) / (1.5 * cosine + inside);
    const double across = (cosine - 1.5 * inside) / (cosine + 1.5 * inside);
    const double r = (parallel * parallel + across * across) / 2;
    return (1 - r) / (1 + r);
}

// Radiance of the picture: the square of half side 0.1 under intensity d^2.
double expected_radiance(const Distances& at)
{
    constexpr int n = 32;
    double sum = 0;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const double x = ((i + 0.5) / n - 0.5) * 0.2, y = ((j + 0.5) / n - 0.5) * 0.2;
            const double d2 = x * x + y * y + at.light * at.light, cosine = at.light / std::sqrt(d2);
            sum += at.light * at.light * cosine / d2 * (at.pane ? thin_pane(cosine) : 1);
        }
    return 0.5 / M_PI * sum / (n * n);
}

class Distance : public PeerTest {};

TEST_P(Distance, OfLightAndCameraDoesNotShow)
{
    for (bool pane : {false, true})
        for (double light : {1.0, 64.0})
            for (double camera : {0.3, 3.0, 100.0}) {
                if (pane && GetParam() == "path") continue;  // cannot find it
                // The camera looks beneath the pane, or sees the square past it where light tracing is blind.
                if (pane && camera > 0.5) continue;
                const double half = std::atan(0.1 / camera), cone = std::atan(0.2 / light);
                const std::string text = fmt::format(
                    "LookAt 0 0 {0}  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" [{1}]\n"
                    "Film \"rgb\" \"integer xresolution\" [8] \"integer yresolution\" [8]\nPixelFilter "
                    "\"box\"\nWorldBegin\n"
                    "LightSource \"spot\" \"rgb I\" [{2} {2} {2}] \"point3 from\" [0 0 {3}] \"point3 to\" [0 0 0] "
                    "\"float "
                    "coneangle\" [{4}] \"float conedeltaangle\" [{5}]\n"
                    "Material \"diffuse\" \"rgb reflectance\" [0.5 0.5 0.5]\n"
                    "Shape \"bilinearmesh\" \"point3 P\" [-0.4 -0.4 0  0.4 -0.4 0  -0.4 0.4 0  0.4 0.4 0]\n{6}",
                    camera, 2 * half * 180 / M_PI, light * light, light, cone * 180 / M_PI, cone * 9 / M_PI,
                    pane ? "Material \"thindielectric\"\nShape \"bilinearmesh\" \"point3 P\" [-2 -2 0.5  2 -2 0.5  -2 "
                           "2 0.5 "
                           " 2 2 0.5]\n"
                         : "");
                const TestScene scene = TestScene::from_text(text);
                expect_value(peer_mean(scene, peer_request(GetParam(), 2, 2000)),
                             expected_radiance({light, camera, pane}), 0.005, 0.03,
                             fmt::format("{}, light at {}, camera at {}{}", GetParam(), light, camera,
                                         pane ? ", a pane between" : ""));
            }
}

INSTANTIATE_TEST_SUITE_P(Integrators, Distance, ::testing::ValuesIn(integrator_names()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace dapple::testing
