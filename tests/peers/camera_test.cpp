// Cameras: borders of pictures are as bright as their middle by every strategy, camera and filter (LuxCore#237, #667);
// a caustic has the same flux at every zoom and in every crop (LuxCore#312); the camera may be within water or glass
// (pbrt-v4#395); no pixel stands out (pbrt-v3#73, mitsuba#132).
#include "peers/peers.h"

#include "dapple/base/path_class.h"

#include <algorithm>

namespace dapple::testing {
namespace {

struct View {
    const char* name;
    const char* text;
    double largest_error = 0.06;  // filters with negative weights are noisy
};
constexpr View cameras[] = {
    {"perspective", "Camera \"perspective\" \"float fov\" [70]"},
    {"thin lens", "Camera \"perspective\" \"float fov\" [70] \"float lensradius\" [0.1] \"float focaldistance\" [0.8]"},
    {"orthographic", "Camera \"orthographic\" \"float screenwindow\" [-0.6 0.6 -0.5 0.5]"},
    {"equirectangular", "Camera \"spherical\" \"string mapping\" \"equirectangular\""},
    {"equal area", "Camera \"spherical\" \"string mapping\" \"equalarea\""}};
constexpr View filters[] = {{"box", "PixelFilter \"box\""},
                            {"triangle", "PixelFilter \"triangle\""},
                            {"gaussian", "PixelFilter \"gaussian\""},
                            {"mitchell", "PixelFilter \"mitchell\"", 0.1},
                            {"sinc", "PixelFilter \"sinc\"", 0.25}};

// A closed matte box whose walls emit and reflect a half: radiance 2 everywhere, half of it reflected, so that every
// pixel of every camera within must be 2.
TestScene glowing_box(const View& camera, const View& filter)
{
    return TestScene::from_text(std::string("LookAt 0.1 0.05 0.2  0 0 -1  0 1 0\n") + camera.text +
                                "\nFilm \"rgb\" \"integer xresolution\" [8] \"integer yresolution\" [8]\n" +
                                filter.text + R"(
WorldBegin
AreaLightSource "diffuse" "rgb L" [1 1 1] "bool twosided" [true]
Material "diffuse" "rgb reflectance" [0.5 0.5 0.5]
)" + box_walls);
}

class Borders : public PeerTest {};

TEST_P(Borders, AreAsBrightAsTheMiddleForEachCameraAndFilter)
{
    const bool merges = has_setting(GetParam(), "radius");
    // Where light paths meet the camera all pairs are tried; where eye paths start in the pixel, the one or the other.
    const bool splats = GetParam() == "lightpath" || GetParam() == "bdpt" || GetParam() == "vcm";
    for (const View& camera : cameras)
        for (const View& filter : filters) {
            if (!splats && &camera != cameras && &filter != filters + 2) continue;
            const TestScene scene = glowing_box(camera, filter);
            RenderRequest request = peer_request(GetParam(), 3, GetParam() == "lightpath" ? 1000 : 600);
            if (merges) request.settings.emplace_back("radius", "0.5");
            const std::vector<Image> images = scene.render_batches(request, peer_batches);
            const int edges[][4] = {{0, 8, 0, 1}, {0, 8, 7, 8}, {0, 1, 0, 8}, {7, 8, 0, 8}, {2, 6, 2, 6}};
            for (const auto& [x0, x1, y0, y1] : edges)
                expect_value(region_estimate(images, 1, x0, x1, y0, y1), 2.0, merges ? 0.03 : 0, filter.largest_error,
                             fmt::format("{}, {}, {}, pixels {} to {}, {} to {}", GetParam(), camera.name, filter.name,
                                         x0, x1, y0, y1));
        }
}

// A point light, a ball that bends its light a little, and a floor; the camera hangs between ball and floor. `view`:
// the rest of the header.
TestScene ball_over_floor(const std::string& view)
{
    return TestScene::from_text("LookAt 0 0 0.2  0 0 0  0 1 0\n" + view + R"(
PixelFilter "box"
WorldBegin
LightSource "point" "rgb I" [1 1 1] "point3 from" [0 0 2.5]
Material "diffuse" "rgb reflectance" [0.5 0.5 0.5]
Shape "bilinearmesh" "point3 P" [-2 -2 0  2 -2 0  -2 2 0  2 2 0]
Material "dielectric" "float eta" [1.15]
Translate 0 0 0.7
Shape "sphere" "float radius" [0.4]
)");
}

// Mean radiance of the caustic in pixels of the crop window, times the pixels' area relative to those of zoom 1.
Estimate caustic_flux(const TestScene& scene, const RenderRequest& request, int x0, int x1, int y0, int y1, double area)
{
    std::vector<double> values;
    RenderRequest one = request;
    one.layers = true;
    for (int i = 0; i < peer_batches; ++i, ++one.seed) {
        const Rendered rendered = scene.render(one);
        const auto found = std::find(rendered.channels.begin(), rendered.channels.end(), "caustic.G");
        if (found == rendered.channels.end()) {
            ADD_FAILURE() << "no caustic layer";
            return {};
        }
        const auto channel = static_cast<int>(found - rendered.channels.begin());
        values.push_back(region_mean(rendered.layers, channel, x0, x1, y0, y1) * (x1 - x0) * (y1 - y0) * area);
    }
    return estimate(values);
}

class Caustics : public PeerTest {};

TEST_P(Caustics, HaveTheSameFluxAtEveryZoomAndInEveryCrop)
{
    if (GetParam() == "path") GTEST_SKIP() << "no ray through glass meets a light without extent";
    RenderRequest request = peer_request(GetParam(), 2, 6000);
    if (has_setting(GetParam(), "radius")) request.settings.emplace_back("radius", "0.5");
    const auto film = [](double half, int pixels, const std::string& crop) {
        return fmt::format(
            "Camera \"orthographic\" \"float screenwindow\" [-{0} {0} -{0} {0}]\n"
            "Film \"rgb\" \"integer xresolution\" [{1}] \"integer yresolution\" [{1}] {2}",
            half, pixels, crop);
    };
    // The patch is the square of half side 0.5.
    const Estimate wanted = caustic_flux(ball_over_floor(film(0.5, 16, "")), request, 0, 16, 0, 16, 1);
    EXPECT_GT(wanted.mean, 0);
    struct Case {
        double half;
        int pixels;
        const char* crop;
        int x0, x1, y0, y1;  // the patch within the crop window
    };
    const Case cases[] = {{1.0, 16, "", 4, 12, 4, 12},
                          {2.0, 32, "", 12, 20, 12, 20},
                          {1.0, 32, "\"integer pixelbounds\" [8 24 8 24]", 0, 16, 0, 16},
                          {1.0, 32, "\"integer pixelbounds\" [0 24 8 32]", 8, 24, 0, 16},
                          {1.0, 32, "\"integer pixelbounds\" [4 28 5 26]", 4, 20, 3, 19}};
    for (const Case& c : cases) {
        request.seed += peer_batches;
        const double pixel = 2 * c.half / c.pixels, area = pixel * pixel * 256;
        const TestScene scene = ball_over_floor(film(c.half, c.pixels, c.crop));
        expect_same(wanted, caustic_flux(scene, request, c.x0, c.x1, c.y0, c.y1, area), 0.02, 0.04,
                    fmt::format("{}, window {}, {} pixels, {}", GetParam(), c.half, c.pixels, c.crop));
    }
}

class WithinWater : public PeerTest {};

// Of a sky of radiance 1, n^2 arrives within glass of index n, from every direction: what is totally reflected comes
// from the sky as well. Bidirectional methods that forget which way their subpaths go are off by n^2 or n^4.
TEST_P(WithinWater, TheSkyIsBrighterByTheSquareOfTheIndex)
{
    const TestScene scene = TestScene::from_text(R"(LookAt 0 0 0  0.3 0.2 -1  0 1 0
Camera "perspective" "float fov" [60]
Film "rgb" "integer xresolution" [8] "integer yresolution" [8]
WorldBegin
LightSource "infinite" "rgb L" [1 1 1]
Material "dielectric" "float eta" [1.5]
Translate 0.2 0.1 0.1
Shape "sphere"
)");
    expect_value(peer_mean(scene, peer_request(GetParam(), 8)), 2.25, 0, 0.01, GetParam());
}

// The floor of a pool, lit by a lamp above it, seen by a camera in the water.
TEST_P(WithinWater, TheFloorIsLitAlikeByEveryStrategy)
{
    const TestScene scene = TestScene::from_text(R"(LookAt 0 0 0.5  0.1 0 0  0 1 0
Camera "perspective" "float fov" [60]
Film "rgb" "integer xresolution" [8] "integer yresolution" [8]
PixelFilter "box"
WorldBegin
AttributeBegin
AreaLightSource "diffuse" "rgb L" [1 1 1]
Translate 0 0 2
Rotate 180 1 0 0
Shape "disk" "float radius" [1.5]
AttributeEnd
Material "diffuse" "rgb reflectance" [0.6 0.5 0.4]
Shape "disk" "float radius" [2]
Material "dielectric" "float eta" [1.33]
Shape "disk" "float radius" [2] "float height" [1]
)");
    const Estimate wanted = peer_mean(scene, peer_request("lightpath", 8, 2000));
    if (GetParam() == "lightpath") {
        RenderRequest path = peer_request("path", 48);
        expect_same(peer_mean(scene, path), wanted, 0, 0.03, "path and lightpath");
        return;
    }
    const uint32_t passes = GetParam() == "path" ? 48 : 2;
    expect_same(wanted, peer_mean(scene, peer_request(GetParam(), passes, 2000)), 0.015, 0.04,
                "lightpath and " + GetParam());
}

class Spikes : public PeerTest {};

// A Cornell box with a point light and a bumpy ball: where connections of close vertices or shading normals were not
// weighed, single pixels would outshine all others.
TEST_P(Spikes, AreAbsentFromABoxWithAPointLightAndABumpyBall)
{
    const TestScene scene = TestScene::from_text(fmt::format(R"(LookAt 0 0 3.6  0 0 0  0 1 0
Camera "perspective" "float fov" [38]
Film "rgb" "integer xresolution" [64] "integer yresolution" [64]
PixelFilter "box"
WorldBegin
LightSource "point" "rgb I" [1 1 1] "point3 from" [0 0.6 0.2]
Include "{0}/room.inc"
Texture "height" "float" "imagemap" "string filename" "{0}/waves_normal.png" "float scale" [0.15]
Material "diffuse" "rgb reflectance" [0.6 0.6 0.6] "texture displacement" "height"
Translate -0.3 -0.6 0.2
Shape "sphere" "float radius" [0.4]
)",
                                                             DAPPLE_AGREEMENT_SCENES));
    RenderRequest request = peer_request(GetParam(), 16, 4096);
    const Image image = scene.render(request).beauty;
    std::vector<float> values;
    for (size_t i = 1; i < image.pixels.size(); i += 3) values.push_back(image.pixels[i]);
    std::sort(values.begin(), values.end());
    const double ratio = values.back() / values[static_cast<size_t>(0.999 * double(values.size()))];
    fmt::print("[ measured ] {}: brightest pixel / 99.9th percentile {:.3f}\n", GetParam(), ratio);
    EXPECT_GT(values.back(), 0.0f);
    EXPECT_LT(ratio, 1.5);
}

INSTANTIATE_TEST_SUITE_P(Integrators, Borders, ::testing::ValuesIn(integrator_names()),
                         [](const auto& test) { return test.param; });
INSTANTIATE_TEST_SUITE_P(Integrators, Caustics, ::testing::ValuesIn(integrator_names()),
                         [](const auto& test) { return test.param; });
INSTANTIATE_TEST_SUITE_P(Integrators, WithinWater, ::testing::ValuesIn(integrator_names()),
                         [](const auto& test) { return test.param; });
INSTANTIATE_TEST_SUITE_P(Integrators, Spikes, ::testing::ValuesIn(integrator_names()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace dapple::testing
