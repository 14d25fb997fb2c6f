// The render job with integrators that only sleep and count: how it stops, and which image it returns.
#include "dapple/render/render_job.h"

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <stdexcept>
#include <thread>

namespace dapple {
namespace {

constexpr int image_size = 4;

void sleep_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

// Adds `value(pass)` to every pixel, after `work`; leaves early without a trace in the lower half when cancelled.
class FakeIntegrator final : public Integrator {
public:
    std::function<void(const PassContext&)> work = [](const PassContext&) {};
    std::function<void(const PassContext&)> before_pixels = [](const PassContext&) {};
    bool eye_samples_alone = false;

    bool adds_eye_samples_alone() const override { return eye_samples_alone; }

    void render_pass(const PassContext& context, Film& film) override
    {
        before_pixels(context);
        for (int y = 0; y < image_size; ++y) {
            if (y == image_size / 2) work(context);
            if (context.cancelled()) return;
            for (int x = 0; x < image_size; ++x) {
                PixelSample sample(0);
                sample.add(Vec3(static_cast<float>(context.pass + 1)), PathClass::direct, LightGroup(0u));
                film.add_pixel(Int2(x, y), sample, 1);
                ++context.statistics.eye_paths;
            }
        }
    }
};

class RenderJobTest : public testing::Test {
protected:
    RenderJobTest() : film_(settings()), progress_(make_progress(ProgressKind::none)) {}

    static FilmSettings settings()
    {
        FilmSettings made;
        made.resolution = made.crop_max = Int2(image_size, image_size);
        made.filter = Filter(FilterShape{Filter::Kind::box, Vec2(0.5f, 0.5f)});
        return made;
    }

    RenderResult render(const StopRule& stop)
    {
        return run(RenderJob{world_, integrator_, film_, "fake", 0, stop}, requests_, *progress_);
    }

    // Waits inside of a pass until it is cancelled, for at most two seconds.
    static void wait_for_cancel(const PassContext& context)
    {
        for (int i = 0; i < 400 && !context.cancelled(); ++i) sleep_ms(5);
    }

    World world_;
    FakeIntegrator integrator_;
    Film film_;
    StopRequests requests_;
    std::unique_ptr<Progress> progress_;
};

TEST_F(RenderJobTest, ReturnsTheMeanOfAllPasses)
{
    const RenderResult result = render(StopRule{3, 0});
    EXPECT_EQ(result.passes, 3u);
    EXPECT_EQ(result.eye_paths, 3u * image_size * image_size);
    EXPECT_EQ(result.incomplete, "");
    EXPECT_EQ(result.reason, "all passes done");
    EXPECT_FLOAT_EQ(result.image.at(0, 0, 0), 2.0f);
    EXPECT_FLOAT_EQ(result.image.at(3, 3, 0), 2.0f);
}

TEST_F(RenderJobTest, FirstRequestFinishesThePass)
{
    integrator_.work = [&](const PassContext& context) {
        if (context.pass == 1) requests_.add();
        sleep_ms(120);  // long enough for the watcher to see the request
    };
    const RenderResult result = render(StopRule{100, 0});
    EXPECT_EQ(result.passes, 2u);
    EXPECT_EQ(result.passes_lost, 0u);
    EXPECT_FLOAT_EQ(result.image.at(3, 3, 0), 1.5f);
    EXPECT_EQ(result.reason, "stopped by request");
}

// Half of a first pass, by its eye paths, and a good part of a second one, by the time that the first took.
TEST_F(RenderJobTest, ProgressAfterARequestIsThatOfThePass)
{
    struct Recorder final : Progress {
        void begin(const std::string&, const std::vector<std::string>&) override {}
        void update(const ProgressState& state) override { last = state; }
        void note(const std::string&) override {}
        void end(const ProgressState&, const std::string&) override {}
        void written(const std::string&) override {}
        ProgressState last;
    };
    const auto last_update = [&](uint32_t last_pass) {
        Film film(settings());
        StopRequests requests;
        Recorder recorder;
        integrator_.work = [&](const PassContext& context) {
            if (context.pass == last_pass) requests.add();
            sleep_ms(700);
        };
        run(RenderJob{world_, integrator_, film, "fake", 0, StopRule{1000, 0}}, requests, recorder);
        EXPECT_TRUE(recorder.last.stopping);
        return recorder.last;
    };
    EXPECT_DOUBLE_EQ(last_update(0).fraction, 0.5);
    const ProgressState second = last_update(1);
    EXPECT_GT(second.fraction, 0.5);
    EXPECT_LE(second.fraction, 0.99);
    EXPECT_LT(second.remaining, 0.5);
}

// Pixels that were finished have another sample, the others show the copy that was made before the pass.
TEST_F(RenderJobTest, SecondRequestKeepsWhatIsFinished)
{
    integrator_.work = [&](const PassContext& context) {
        if (context.pass < 1) return;
        requests_.add();
        requests_.add();
        wait_for_cancel(context);
    };
    const RenderResult result = render(StopRule{100, 0});
    EXPECT_EQ(result.passes, 1u);
    EXPECT_EQ(result.incomplete, "");
    EXPECT_FALSE(result.film_whole);
    for (int y = 0; y < image_size; ++y)
        EXPECT_FLOAT_EQ(result.image.at(0, y, 0), y < image_size / 2 ? 1.5f : 1.0f) << y;
    for (int y = 0; y < image_size; ++y) EXPECT_EQ(film_.beauty().at(0, y, 0), result.image.at(0, y, 0)) << y;
}

// What an integrator cannot finish does not count.
TEST_F(RenderJobTest, APassMayGiveItselfUp)
{
    integrator_.work = [&](const PassContext& context) {
        if (context.pass < 1) return;
        requests_.add();
        requests_.add();
        wait_for_cancel(context);
        film_.give_up_pass();
    };
    const RenderResult result = render(StopRule{100, 0});
    EXPECT_EQ(result.passes, 1u);
    EXPECT_EQ(result.reason, "stopped at once by request, the last pass was given up");
    for (int y = 0; y < image_size; ++y) EXPECT_FLOAT_EQ(result.image.at(0, y, 0), 1.0f) << y;
}

TEST_F(RenderJobTest, CancelledFirstPassIsMarkedIncomplete)
{
    integrator_.work = [&](const PassContext& context) {
        requests_.add();
        requests_.add();
        wait_for_cancel(context);
    };
    const RenderResult result = render(StopRule{100, 0});
    EXPECT_NE(result.incomplete, "");
    EXPECT_EQ(result.passes, 0u);
    EXPECT_FLOAT_EQ(result.image.at(0, 0, 0), 1.0f);
    EXPECT_FLOAT_EQ(result.image.at(0, 3, 0), 0.0f);
}

TEST_F(RenderJobTest, KeepsATimeLimit)
{
    integrator_.work = [](const PassContext&) { sleep_ms(10); };
    const RenderResult result = render(StopRule{0, 0.5});
    EXPECT_NEAR(result.seconds, 0.5, 0.025);
    EXPECT_EQ(result.reason.substr(0, 10), "time is up");
}

TEST_F(RenderJobTest, GivesUpAPassThatOverruns)
{
    integrator_.work = [](const PassContext& context) {
        if (context.pass < 4)
            sleep_ms(80);
        else
            wait_for_cancel(context);
    };
    const RenderResult result = render(StopRule{0, 0.4});
    EXPECT_EQ(result.passes, 4u);
    EXPECT_EQ(result.passes_lost, 0u);
    EXPECT_LT(result.seconds, 0.6);
    EXPECT_FLOAT_EQ(result.image.at(3, 3, 0), 2.5f);
}

// Where passes bring eye samples alone, time is kept however long they take, and what a cut pass has done counts: the
// upper half has the mean of five passes, 3, the lower one that of four.
TEST_F(RenderJobTest, CutsAPassWhenTimeIsUp)
{
    integrator_.eye_samples_alone = true;
    integrator_.work = [](const PassContext& context) {
        if (context.pass == 4) wait_for_cancel(context);
    };
    const RenderResult result = render(StopRule{0, 0.5});
    EXPECT_EQ(result.passes, 4u);
    EXPECT_EQ(result.passes_lost, 0u);
    EXPECT_EQ(result.incomplete, "");
    EXPECT_FALSE(result.film_whole);
    EXPECT_GE(result.seconds, 0.5);  // not a matter of luck: nothing but the time ends the pass
    EXPECT_EQ(result.reason, "time is up, with 50 % of another pass");
    for (int y = 0; y < image_size; ++y) EXPECT_FLOAT_EQ(result.image.at(1, y, 1), y < image_size / 2 ? 3.0f : 2.5f);
}

// Where light comes otherwise, too, pixels that the pass did not reach show the image before it, although they have
// light of the pass.
TEST_F(RenderJobTest, CutsAPassOfSplats)
{
    integrator_.before_pixels = [&](const PassContext&) {
        for (int y = 0; y < image_size; ++y) film_.add_to_pixel({2, y}, Vec3(8), PathClass::caustic, LightGroup(0u));
    };
    integrator_.work = [](const PassContext& context) {
        if (context.pass == 4) wait_for_cancel(context);
        if (context.pass < 4) sleep_ms(50);
    };
    const RenderResult result = render(StopRule{0, 0.26});
    ASSERT_EQ(result.passes, 4u);
    EXPECT_EQ(result.reason, "time is up, with 50 % of another pass");
    EXPECT_FALSE(result.film_whole);
    for (int y = 0; y < image_size; ++y) {
        EXPECT_FLOAT_EQ(result.image.at(1, y, 0), y < image_size / 2 ? 3.0f : 2.5f) << y;
        EXPECT_FLOAT_EQ(result.image.at(2, y, 0), y < image_size / 2 ? 11.0f : 10.5f) << y;
    }
}

// The first pass, too, once it has reached all parts of the image; what it did not reach shows what is next to it.
class FirstPassCut : public RenderJobTest, public ::testing::WithParamInterface<bool> {};

TEST_P(FirstPassCut, WhenTimeIsUp)
{
    integrator_.eye_samples_alone = GetParam();
    integrator_.work = wait_for_cancel;
    const RenderResult result = render(StopRule{0, 0.2});
    EXPECT_EQ(result.passes, 0u);
    EXPECT_FALSE(result.film_whole);
    EXPECT_EQ(result.reason, "time is up, with 50 % of the first pass");
    EXPECT_NE(result.incomplete, "");
    for (int y = 0; y < image_size; ++y) EXPECT_FLOAT_EQ(result.image.at(1, y, 1), 1.0f) << y;
}

INSTANTIATE_TEST_SUITE_P(Splats, FirstPassCut, ::testing::Bool(),
                         [](const auto& test) { return test.param ? "None" : "Some"; });

// Half of what is left for a pass is announced, so that one with light paths after its eye paths can end those.
TEST_F(RenderJobTest, AnnouncesHalfTime)
{
    double half = 0, whole = 0;
    const auto start = std::chrono::steady_clock::now();
    const auto now = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
    integrator_.work = [&](const PassContext& context) {
        ASSERT_NE(context.half_time, nullptr);
        while (!*context.half_time && now() < 2) sleep_ms(1);
        half = now();
        EXPECT_FALSE(context.cancelled());
        while (!context.cancelled() && now() < 4) sleep_ms(1);
        whole = now();
    };
    render(StopRule{0, 0.4});
    EXPECT_GE(half, 0.2);
    EXPECT_GE(whole, 0.4);
}

TEST_F(RenderJobTest, DoesNotCutTheFirstPassBeforeItsFirstRound)
{
    integrator_.eye_samples_alone = true;
    integrator_.before_pixels = [](const PassContext& context) {
        EXPECT_EQ(context.coarse_to_fine, context.pass == 0);
        if (context.pass == 0) sleep_ms(275);  // between two looks of the watcher
    };
    const RenderResult result = render(StopRule{0, 0.1});
    EXPECT_EQ(result.incomplete, "");
    EXPECT_EQ(result.passes, 1u);
}

TEST_F(RenderJobTest, KeepsACutPassOfASecondRequest)
{
    integrator_.eye_samples_alone = true;
    integrator_.work = [&](const PassContext& context) {
        if (context.pass < 2) return;
        requests_.add();
        requests_.add();
        wait_for_cancel(context);
    };
    const RenderResult result = render(StopRule{100, 0});
    EXPECT_EQ(result.passes, 2u);
    EXPECT_EQ(result.passes_lost, 0u);
    EXPECT_FLOAT_EQ(result.image.at(0, 0, 0), 2.0f);
    EXPECT_FLOAT_EQ(result.image.at(0, 3, 0), 1.5f);
}

// A pass that has not reached any pixel leaves a film of whole passes, which may be continued.
TEST_F(RenderJobTest, ACutBeforeTheFirstPixelLeavesTheFilmWhole)
{
    integrator_.eye_samples_alone = true;
    integrator_.before_pixels = [](const PassContext& context) {
        if (context.pass == 1) wait_for_cancel(context);
    };
    const RenderResult result = render(StopRule{0, 0.2});
    EXPECT_EQ(result.passes, 1u);
    EXPECT_TRUE(result.film_whole);
    EXPECT_EQ(result.reason, "time is up, the last pass was given up");
    EXPECT_FLOAT_EQ(result.image.at(3, 3, 0), 1.0f);
}

// A film that is to be kept gets whole passes alone, whatever the integrator.
TEST_F(RenderJobTest, DoesNotCutAFilmThatIsKept)
{
    integrator_.eye_samples_alone = true;
    integrator_.work = [](const PassContext& context) {
        for (int i = 0; i < 40 && context.pass == 1 && !context.cancelled(); ++i) sleep_ms(10);
    };
    RenderJob job{world_, integrator_, film_, "fake", 0, StopRule{0, 0.3}};
    job.keep_film_whole = true;
    const RenderResult result = run(job, requests_, *progress_);
    EXPECT_EQ(result.passes, 2u);
    EXPECT_TRUE(result.film_whole);
    EXPECT_FLOAT_EQ(result.image.at(3, 3, 0), 1.5f);
}

TEST_F(RenderJobTest, LaterErrorKeepsTheImage)
{
    integrator_.work = [](const PassContext& context) {
        if (context.pass == 1) throw std::runtime_error("out of luck");
    };
    const RenderResult result = render(StopRule{10, 0});
    EXPECT_TRUE(result.failed);
    EXPECT_EQ(result.passes, 1u);
    EXPECT_FLOAT_EQ(result.image.at(3, 3, 0), 1.0f);
    EXPECT_NE(result.reason.find("out of luck"), std::string::npos);
}

TEST_F(RenderJobTest, ErrorInTheFirstPassIsThrownOn)
{
    integrator_.work = [](const PassContext&) { throw std::runtime_error("out of luck"); };
    EXPECT_THROW(render(StopRule{10, 0}), std::runtime_error);
}

}  // namespace
}  // namespace dapple
