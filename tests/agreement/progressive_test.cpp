// What sppm and photonsplat promise beyond the ring: both make one picture, no roughness parts photons from eye paths,
// radii know nothing of photons, bias falls with the radius, and no radius is too odd.
#include "agreement/scenes.h"
#include "support/statistics.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

namespace dapple::testing {
namespace {

double sum_of(const Image& image)
{
    double sum = 0;
    for (float v : image.pixels) sum += std::abs(v);
    return sum;
}

double difference(const Image& a, const Image& b)
{
    double sum = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) sum += std::abs(double(a.pixels[i]) - b.pixels[i]);
    return sum;
}

RenderRequest request_of(const std::string& integrator, uint32_t passes)
{
    RenderRequest request;
    request.integrator = integrator;
    request.passes = passes;
    request.settings = small_settings(integrator, passes);
    return request;
}

// The same photons meet the same visible points; stored ones have directions and fluxes of fewer bits. A rough coat
// draws its walk from the bits of the directions: there another walk is another sample.
TEST(PhotonSplatting, MakesThePictureOfProgressivePhotonMapping)
{
    for (const std::string& name : agreement_scenes()) {
        const TestScene scene = agreement_scene(name);
        if (!scene.suits("sppm")) continue;
        const Image gathered = scene.render(request_of("sppm", 3)).beauty;
        const Image splatted = scene.render(request_of("photonsplat", 3)).beauty;
        const double relative = difference(gathered, splatted) / sum_of(gathered);
        fmt::print("[ measured ] {}: {:.2g} of the light differs\n", name, relative);
        EXPECT_LT(relative, name == "coated" ? 5e-3 : 1e-3) << name;
    }
}

class Progressive : public ::testing::TestWithParam<std::string> {};

// A glass ball above a metal plate, under a lamp; the camera looks at the plate from above, past the ball.
std::string plate(const std::string& material, const std::string& light)
{
    return R"(LookAt 0 1.5 2.5  0 0 0  0 1 0
Camera "perspective" "float fov" [32]
Film "rgb" "integer xresolution" [16] "integer yresolution" [16]
WorldBegin
)" + light +
           R"(
AttributeBegin
Material "dielectric" "float eta" [1.5]
Translate 0 0.55 0
Shape "sphere" "float radius" [0.3]
AttributeEnd
Material "diffuse" "rgb reflectance" [0.6 0.6 0.6]
Shape "bilinearmesh" "point3 P" [-3 -1 -3  3 -1 -3  -3 3 -3  3 3 -3]
)" + material +
           R"(
Shape "bilinearmesh" "point3 P" [-1 0 -1  1 0 -1  -1 0 1  1 0 1]
)";
}

constexpr const char* lamp = R"(AttributeBegin
AreaLightSource "diffuse" "rgb L" [1 1 1]
Shape "bilinearmesh" "point3 P" [-3 2.6 -2.9  3 2.6 -2.9  -3 2.6 2.9  3 2.6 2.9]
AttributeEnd)";

// The share of photons and that of eye paths change with roughness, their sum must not: against path tracing, which
// knows no such shares, through the whole range and across the threshold of delta lobes (0.001).
TEST_P(Progressive, NeedsNoThresholdOfRoughness)
{
    const std::pair<const char*, std::vector<const char*>> plates[] = {
        {"conductor", {"0", "0.0011", "0.01", "0.05", "0.15", "0.25", "0.4"}},
        {"coateddiffuse", {"0.05"}},
        {"coatedconductor", {"0.25"}}};
    for (const auto& [kind, roughnesses] : plates)
        for (const char* alpha : roughnesses) {
            // Its pixels are those of sppm; see above.
            if (GetParam() == "photonsplat" && roughnesses.size() > 1 && std::string(alpha) != "0.15") continue;
            const char* parameter = std::string(kind) == "coatedconductor" ? "interface.roughness" : "roughness";
            const TestScene scene = TestScene::from_text(
                plate(fmt::format("Material \"{}\" \"float {}\" [{}] \"bool remaproughness\" [false]", kind, parameter,
                                  alpha),
                      lamp));
            RenderRequest path = request_of("path", 96);
            RenderRequest photons = request_of(GetParam(), 12);
            path.color_model = photons.color_model = ColorModel::rgb;
            photons.seed = 77;
            const Estimate a = channel_estimate(scene.render_batches(path, 8), 1);
            const Estimate b = channel_estimate(scene.render_batches(photons, 8), 1);
            fmt::print("[ measured ] {} {}: {} / path {:.4f} +- {:.4f}\n", kind, alpha, GetParam(), b.mean / a.mean,
                       std::hypot(a.error / a.mean, b.error / b.mean));
            EXPECT_GT(p_value(a, b, 0.015 * a.mean), 1e-4) << kind << " " << alpha;
            EXPECT_LT(std::hypot(a.error / a.mean, b.error / b.mean), 0.02) << "too noisy to tell";
        }
}

// The light that a metal plate throws onto a wall does not jump as its roughness grows from 0: a point light, which
// only photons can bring there while the plate is a mirror.
TEST_P(Progressive, HasCausticsContinuousInTheRoughnessOfTheCaster)
{
    std::vector<std::pair<double, double>> flux;
    for (const double alpha : {0.0, 0.0009, 0.0011, 0.003, 0.01, 0.03, 0.06, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4}) {
        const TestScene scene = TestScene::from_text(fmt::format(R"(LookAt 0 1.4 1  0 1.4 -1  0 1 0
Camera "orthographic" "float screenwindow" [-0.9 0.9 -0.9 0.9]
Film "rgb" "integer xresolution" [12] "integer yresolution" [12]
WorldBegin
LightSource "spot" "point3 from" [0 1.2 1.2] "point3 to" [0 0 0] "float coneangle" [12] "rgb I" [9 9 9]
Material "diffuse" "rgb reflectance" [0.6 0.6 0.6]
Shape "bilinearmesh" "point3 P" [-3 -1 -1.2  3 -1 -1.2  -3 3 -1.2  3 3 -1.2]
Material "conductor" "float roughness" [{}] "bool remaproughness" [false]
Shape "bilinearmesh" "point3 P" [-1 0 -1  1 0 -1  -1 0 1  1 0 1]
)",
                                                                 alpha));
        RenderRequest request = request_of(GetParam(), 8);
        request.color_model = ColorModel::rgb;
        flux.emplace_back(alpha, channel_mean(scene.render(request).beauty, 1));
    }
    EXPECT_GT(flux[0].second, 0.01);
    for (size_t i = 1; i < flux.size(); ++i) {
        const double ratio = flux[i].second / flux[i - 1].second;
        fmt::print("[ measured ] roughness {}: {:.4f} of the one before\n", flux[i].first, ratio);
        // The lobe widens beyond what the camera sees; noise is below 1 %.
        EXPECT_GT(ratio, flux[i].first < 0.02 ? 0.97 : 0.75) << flux[i].first;
        EXPECT_LT(ratio, flux[i].first < 0.02 ? 1.03 : 1.1) << flux[i].first;
    }
}

// A thin sheet, lit from one side: photons on that side must not change the radius on the other (mitsuba issue 145).
TEST_P(Progressive, HasTheSameRadiusOnBothSidesOfASheet)
{
    std::vector<std::vector<double>> radii;
    for (const char* eye : {"1", "-1"}) {
        const TestScene scene = TestScene::from_text(fmt::format(R"(LookAt 0 0 {}  0 0 0  0 1 0
Camera "orthographic" "float screenwindow" [-0.4 0.4 -0.4 0.4]
Film "rgb" "integer xresolution" [8] "integer yresolution" [8]
WorldBegin
LightSource "point" "point3 from" [0 0 2] "rgb I" [10 10 10]
Material "diffuse" "rgb reflectance" [0.8 0.8 0.8]
Shape "bilinearmesh" "point3 P" [-1 -1 0  1 -1 0  -1 1 0  1 1 0]
Shape "bilinearmesh" "point3 P" [-1 -1 3  -1 1 3  1 -1 3  1 1 3]
)",
                                                                 eye));
        RenderRequest request = request_of(GetParam(), 4);
        request.layers = true;
        const Rendered rendered = scene.render(request);
        const auto channel = std::find(rendered.channels.begin(), rendered.channels.end(), "photons.radius");
        ASSERT_NE(channel, rendered.channels.end());
        radii.emplace_back();
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 8; ++x)
                radii.back().push_back(rendered.layers.at(x, y, static_cast<int>(channel - rendered.channels.begin())));
        if (eye[0] == '-')
            EXPECT_EQ(sum_of(rendered.beauty), 0.0) << "the dark side";
        else
            EXPECT_GT(sum_of(rendered.beauty), 0.0);
    }
    EXPECT_EQ(radii[0], radii[1]);
    // Three footprints of 0.1 in the first pass; then smaller ones, the fourth at 0.824 of it.
    EXPECT_GT(radii[0][0], 0.82 * 0.3);
    EXPECT_LT(radii[0][0], 0.3);
}

TEST_P(Progressive, SurvivesAnyRadius)
{
    const TestScene scene = agreement_scene("glass_and_mirror");
    RenderRequest request = request_of(GetParam(), 1);
    for (const char* name : {"radius", "fixedradius"})
        for (const char* value : {"1e-44", "1e-30", "1e-9", "1e9", "1e18", "1e38"}) {
            request.settings = {{"photons", "1000"}, {name, value}};
            const Rendered rendered = scene.render(request);
            EXPECT_EQ(rendered.accidents, 0u) << name << " " << value;
            EXPECT_GT(sum_of(rendered.beauty), 0.0) << name << " " << value;
        }
}

TEST_P(Progressive, HasLessBiasWithSmallerRadius)
{
    const TestScene scene = agreement_scene("glass_and_mirror");
    RenderRequest path = request_of("path", 32);
    path.color_model = ColorModel::rgb;
    const std::vector<Image> wanted = scene.render_batches(path, 6);
    double before = INFINITY;
    // Caustics, which a wide disc blurs.
    for (const char* radius : {"0.5", "0.15", "0.05"}) {
        RenderRequest request = request_of(GetParam(), 8);
        request.color_model = ColorModel::rgb;
        request.seed = 900;
        request.settings.emplace_back("fixedradius", radius);
        request.settings.emplace_back("alpha", "1");
        const std::vector<Image> images = scene.render_batches(request, 6);
        double squared = 0;
        for (int y = 0; y < 32; y += 4)
            for (int x = 0; x < 32; x += 4) {
                const Estimate p = region_estimate(wanted, 1, x, x + 4, y, y + 4);
                const Estimate q = region_estimate(images, 1, x, x + 4, y, y + 4);
                squared += (p.mean - q.mean) * (p.mean - q.mean) - p.error * p.error - q.error * q.error;
            }
        fmt::print("[ measured ] {}, radius {}: squared bias of blocks {:.3g}\n", GetParam(), radius, squared / 64);
        EXPECT_LT(squared, 0.5 * before);
        before = squared;
    }
}

INSTANTIATE_TEST_SUITE_P(Integrators, Progressive, ::testing::Values("sppm", "photonsplat"),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace dapple::testing
