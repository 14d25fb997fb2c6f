// First passes that a time limit cuts: the pixels that they reach are those of the whole pass, the others show a
// neighbour, and the image is as bright as it should be. And renders whose automatic numbers were lowered for time.
#include "agreement/scenes.h"

#include "dapple/render/film_settings.h"
#include "dapple/render/pilot.h"
#include "dapple/render/scene_defaults.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <thread>

namespace dapple::testing {
namespace {

// One that can be cut, of a scene that all integrators know.
class FirstPass {
public:
    FirstPass(const TestScene& scene, const std::string& name, uint64_t seed)
        : FirstPass(scene, name, seed, small_settings(name, 1))
    {
    }
    FirstPass(const TestScene& scene, const std::string& name, uint64_t seed, const SettingList& settings)
        : scene_(scene),
          seed_(seed),
          choice_(choose_integrator({}, name, settings)),
          integrator_(choice_.entry->create(scene.world(), choice_.settings)),
          film_(film_settings(scene.description(), scene.world(), LayerChoice(), choice_.entry->photon_layers,
                              ColorModel::spectral))
    {
    }

    // Cancelled as soon as the statistics say so; half_time if it may be cut at all.
    void render(const std::function<bool(const Statistics&)>& enough)
    {
        Statistics statistics;
        std::atomic<bool> cancel{false}, half_time{false};
        PassContext context{scene_.world(), seed_, 0, statistics, &cancel, true, &half_time};
        const std::jthread watcher([&](const std::stop_token& done) {
            while (!done.stop_requested() && !cancel) {
                if (statistics.eye_paths >= pixels() / 2) half_time = true;
                if (enough(statistics)) cancel = true;
                std::this_thread::yield();
            }
        });
        integrator_->render_pass(context, film_);
    }
    // By a limit that is over before photon splatting traces its light paths: all eye paths, a round of light paths.
    void render_first_round()
    {
        Statistics statistics;
        const std::atomic<bool> cancel{true}, half_time{false};
        integrator_->render_pass({scene_.world(), seed_, 0, statistics, &cancel, true, &half_time}, film_);
    }
    // The same in a later pass, which photon splatting gives up for lack of light paths.
    void render_too_few_light_paths()
    {
        Statistics statistics;
        const std::atomic<bool> cancel{true}, half_time{false};
        integrator_->render_pass({scene_.world(), seed_, 1, statistics, &cancel, false, &half_time}, film_);
    }
    void render_whole()
    {
        Statistics statistics;
        integrator_->render_pass({scene_.world(), seed_, 0, statistics}, film_);
    }

    uint64_t pixels() const { return uint64_t(film_.resolution().x) * uint64_t(film_.resolution().y); }
    Film& film() { return film_; }
    const Integrator& integrator() const { return *integrator_; }

private:
    const TestScene& scene_;
    uint64_t seed_;
    IntegratorChoice choice_;
    std::unique_ptr<Integrator> integrator_;
    Film film_;
};

double mean(const Image& image)
{
    double sum = 0.0;
    for (float value : image.pixels) sum += value;
    return sum / static_cast<double>(image.pixels.size());
}

class Cut : public ::testing::TestWithParam<std::string> {};

// Wherever the cut happens to be: whatever else the pass has done, these pixels are finished.
TEST_P(Cut, ReachedPixelsAreThoseOfTheWholePass)
{
    if (GetParam() == "photonsplat") GTEST_SKIP() << "its light paths are as many as time allows";
    const TestScene scene = agreement_scene("glass_and_mirror");
    FirstPass whole(scene, GetParam(), 1), cut(scene, GetParam(), 1);
    whole.render_whole();
    whole.film().end_pass();
    cut.render([&](const Statistics& so_far) { return so_far.eye_paths >= cut.pixels() / 16; });
    cut.film().end_cut_pass();
    const Image a = whole.film().beauty(), b = cut.film().beauty();
    for (int y = 0; y < a.height; y += 4)  // what the first rounds reach
        for (int x = 0; x < a.width; x += 4)
            for (int c = 0; c < 3; ++c) ASSERT_EQ(a.at(x, y, c), b.at(x, y, c)) << x << ' ' << y;
}

// The means of cut first passes and of whole ones, over as many seeds: within their noise, and no pixel is black that
// is not in the whole ones.
TEST_P(Cut, IsAsBrightAsTheWholePass)
{
    const TestScene scene = agreement_scene("diffuse_room");
    constexpr int seeds = 24;
    double sums[2] = {}, squares[2] = {};
    for (int seed = 0; seed < seeds; ++seed)
        for (const bool is_cut : {false, true}) {
            FirstPass pass(scene, GetParam(), uint64_t(seed) + (is_cut ? 100 : 0));
            if (is_cut) {
                pass.render([&](const Statistics& so_far) {
                    return so_far.eye_paths >= pass.pixels() / 3 &&
                           (GetParam() != "photonsplat" || so_far.light_paths >= 2048);
                });
                pass.film().end_cut_pass();
            } else {
                pass.render_whole();
                pass.film().end_pass();
            }
            const double brightness = mean(pass.film().beauty());
            sums[is_cut] += brightness;
            squares[is_cut] += brightness * brightness;
        }
    double means[2], variance = 0.0;
    for (const int i : {0, 1}) {
        means[i] = sums[i] / seeds;
        variance += (squares[i] / seeds - means[i] * means[i]) / (seeds - 1);
    }
    EXPECT_LT(std::abs(means[1] - means[0]), 4.0 * std::sqrt(variance)) << means[1] / means[0];
    EXPECT_NEAR(means[1] / means[0], 1.0, 0.1);
}

// Without a watcher's luck: the same bits for the same cut.
TEST(CutPhotonSplatting, IsAFunctionOfTheCut)
{
    const TestScene scene = agreement_scene("diffuse_room");
    FirstPass one(scene, "photonsplat", 1), other(scene, "photonsplat", 1), whole(scene, "photonsplat", 1);
    for (FirstPass* pass : {&one, &other}) {
        pass->render_first_round();
        EXPECT_EQ(pass->film().reached_part(), 1.0);
        pass->film().end_cut_pass();
    }
    whole.render_whole();
    whole.film().end_pass();
    EXPECT_EQ(one.film().beauty().pixels, other.film().beauty().pixels);
    EXPECT_NEAR(mean(one.film().beauty()) / mean(whole.film().beauty()), 1.0, 0.05);
}

// A later pass that had no time for its photons would darken what the others made.
TEST(CutPhotonSplatting, GivesUpAPassOfFewLightPaths)
{
    const TestScene scene = agreement_scene("diffuse_room");
    FirstPass passes(scene, "photonsplat", 1, {{"photons", "40000"}});
    passes.render_whole();
    passes.film().end_pass();
    passes.render_too_few_light_paths();
    EXPECT_EQ(passes.film().reached_part(), 0.0);
}

// The numbers of a short limit make a picture of the right brightness, too, and say what they are.
TEST_P(Cut, LoweredNumbersAreAsBright)
{
    const TestScene scene = agreement_scene("diffuse_room");
    RenderRequest request;
    request.integrator = GetParam();
    request.passes = 4;
    const double whole = mean(scene.render(request).beauty);
    IntegratorChoice choice = choose_integrator({}, GetParam(), {});
    const FilmSettings film = film_settings(scene.description(), scene.world(), LayerChoice(),
                                            choice.entry->photon_layers, ColorModel::spectral);
    const std::vector<std::string> lines = fit_to_time(choice, scene.world(), film, 1, 1e-6);
    // A limit that is over before it began leaves the least of everything that is automatic.
    Statistics unused;
    const auto automatic = choose_integrator({}, GetParam(), {});
    for (const Effort& effort :
         automatic.entry->create(scene.world(), automatic.settings)->efforts({scene.world(), 1, 0, unused}, film))
        if (effort.automatic > effort.least) {
            EXPECT_EQ(choice.settings.integer(effort.setting), effort.least) << effort.setting;
        }
    for (const auto& [name, value] : choice.settings.values()) request.settings.emplace_back(name, value);
    const double lowered = mean(scene.render(request).beauty);
    EXPECT_NEAR(lowered / whole, 1.0, 0.05) << (lines.empty() ? "" : lines.front());
    // What was set is not changed again.
    EXPECT_TRUE(fit_to_time(choice, scene.world(), film, 1, 1e-6).empty());
}

INSTANTIATE_TEST_SUITE_P(Integrators, Cut, ::testing::ValuesIn(integrator_names()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace dapple::testing
