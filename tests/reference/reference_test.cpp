// Ring 4. Pictures that pbrt-v4 made of shared/scenes, with standard errors per pixel (shared/references/README.md).
// Found beside the source folder, or where the environment variable DAPPLE_SHARED points.
//
// Each scene is rendered in 4 independent batches. Two tests, without the pixels of lamps where the table gives a
// limit:
//   means   |m - m_ref| <= picture bound x m_ref + 4 sigma, sigma from the batches and from the reference's errors;
//   blocks  of 32 x 32 pixels, |b - b_ref| <= block bound x b_ref + 5 sigma: at 64 blocks and three channels noise
//           alone fails that once in 3e4 (Gaussian); a floor of 0.1 % of the picture's mean covers black blocks.
// The bounds are relative deviations that may be systematic: 0.5 % of the mean and 1 % of blocks where both programs
// have the same model. Larger ones stand in the table with their reason.
// Short form: few passes, the whole ring within 4 minutes on 2 cores. Long form: environment DAPPLE_REFERENCE_PASSES=N
// multiplies the passes by N (scripts/reference-full).
#include "dapple/base/temp_folder.h"
#include "support/render_scene.h"
#include "support/statistics.h"

#include "dapple/formats/pbrt.h"
#include "dapple/image/image_file.h"
#include "dapple/image/metrics.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <optional>
#include <ostream>
#include <string_view>

namespace dapple::testing {
namespace {

namespace fs = std::filesystem;

constexpr int batches = 4;
constexpr int block = 32;

struct Reference {
    const char* name;
    const char* scene;  // below shared/scenes
    Int2 resolution;
    const char* integrator;
    uint32_t passes;  // of each batch, short form
    SettingList settings;
    double picture_bound, block_bound;
    float clamp;  // values of the reference from here on are left out; 0: none
    bool pbrt_coats;
    const char* reason;  // of bounds beyond 0.5 % and 1 %
};

const Reference references[] = {
    {"cornell-box", "cornell-box/pbrt/scene-v4.pbrt", {256, 256}, "path", 4, {}, 0.005, 0.01, 0, false, ""},
    {"veach-mis", "veach-mis/pbrt/scene-v4.pbrt", {320, 180}, "path", 6, {}, 0.005, 0.01, 10, false, ""},
    {"killeroo-simple",
     "killeroos/killeroo-simple.pbrt",
     {256, 256},
     "path",
     2,
     {},
     0.01,
     0.02,
     10,
     true,
     "rough coats with pbrt's weights"},
    {"killeroo-gold", "killeroos/killeroo-gold.pbrt", {342, 256}, "path", 2, {}, 0.005, 0.01, 10, false, ""},
    {"killeroo-moving",
     "killeroos/killeroo-moving.pbrt",
     {256, 256},
     "path",
     2,
     {},
     0.01,
     0.02,
     10,
     true,
     "rough coats with pbrt's weights"},
    {"killeroo-coated-gold",
     "killeroos/killeroo-coated-gold.pbrt",
     {342, 256},
     "path",
     2,
     {},
     0.01,
     0.03,
     10,
     true,
     "rough coats with pbrt's weights"},
    {"staircase2", "staircase2/pbrt/scene-v4.pbrt", {256, 256}, "path", 4, {}, 0.005, 0.01, 10, false, ""},
    {"fog-smallpt", "fog-cornell/smallpt.pbrt", {256, 256}, "path", 4, {}, 0.005, 0.01, 10, false, ""},
    {"fog-cornell-volume",
     "fog-cornell/cornell-box-volume.pbrt",
     {256, 256},
     "path",
     4,
     {},
     0.005,
     0.01,
     10,
     false,
     ""},
    {"volumetric-caustic",
     "volumetric-caustic/pbrt/scene-v4.pbrt",
     {256, 256},
     "bdpt",
     2,
     {{"maxdepth", "20"}},
     0.01,
     0.03,
     10,
     false,
     "the reference comes from one wavelength set per path and few samples"},
    {"caustic-glass",
     "caustic-glass/caustic-glass-v4.pbrt",
     {175, 250},
     "photonmap",
     4,
     {{"epoch", "4"}},
     0.02,
     0.1,
     10,
     true,
     "photon maps blur the caustic; rough coat of the floor"},
    {"caustic-glass-sppm",
     "caustic-glass/caustic-glass-v4.pbrt",
     {175, 250},
     "photonmap",
     4,
     {{"epoch", "4"}},
     0.02,
     0.1,
     10,
     true,
     "the reference's own colours are off by up to 1 % and both blur the caustic"},
    {"water-caustic",
     "water-caustic/pbrt/scene-v4.pbrt",
     {256, 256},
     "photonmap",
     4,
     {{"epoch", "4"}},
     0.02,
     0.1,
     10,
     false,
     "the reference's own colours are off by up to 1 % and both blur the caustic"},
    {"cornell-box",
     "cornell-box/pbrt/scene-v4.pbrt",
     {256, 256},
     "photonmap",
     2,
     {{"epoch", "2"}},
     0.005,
     0.02,
     0,
     false,
     "blur of the global map in corners"},
    {"staircase2",
     "staircase2/pbrt/scene-v4.pbrt",
     {256, 256},
     "photonmap",
     2,
     {{"epoch", "2"}},
     0.01,
     0.05,
     10,
     false,
     "blur of the global map among small things"},
};

std::optional<fs::path> shared_folder()
{
    const char* environment = std::getenv("DAPPLE_SHARED");
    const fs::path folder = environment ? fs::path(environment) : fs::path(DAPPLE_SOURCE_DIR) / ".." / "shared";
    if (!fs::is_directory(folder / "references") || !fs::is_directory(folder / "scenes")) return std::nullopt;
    return fs::canonical(folder);
}

uint32_t pass_factor()
{
    const char* text = std::getenv("DAPPLE_REFERENCE_PASSES");
    return text ? static_cast<uint32_t>(std::max(1, std::atoi(text))) : 1;
}

// staircase2 names a texture that its folder lacks and that its Mitsuba version has as a JPEG (README.md): a copy of
// the scene file in a folder of links reads that instead.
class PatchedStaircase {
public:
    explicit PatchedStaircase(const fs::path& original)
    {
        const fs::path source = original.parent_path();
        for (const char* name : {"models", "textures"}) fs::create_directory_symlink(source / name, folder_ / name);
        std::string text = read_text(original);
        const std::string missing = "textures/wood5.tga";
        const std::string there = (source.parent_path() / "mitsuba3" / "textures" / "wood5.jpg").string();
        for (size_t at = text.find(missing); at != std::string::npos; at = text.find(missing, at + there.size()))
            text.replace(at, missing.size(), there);
        description_ = read_pbrt_string(text, "staircase2", folder_.path());
    }
    scene::Description description() const { return description_; }

private:
    TempFolder folder_;
    scene::Description description_;
};

TestScene open_scene(const Reference& reference, const fs::path& shared)
{
    const fs::path file = shared / "scenes" / reference.scene;
    const auto adjusted = [&](scene::Description description) {
        description.options.pbrt_coat_weights = reference.pbrt_coats;
        return TestScene(std::move(description), reference.resolution);
    };
    if (std::string_view(reference.name) != "staircase2") return adjusted(read_pbrt(file));
    const PatchedStaircase patched(file);
    return adjusted(patched.description());
}

void limit(Image& image, float most)
{
    if (most > 0)
        for (float& value : image.pixels) value = std::min(value, most);
}

// Lamps that are seen: where the reference reaches the limit, and around there as far as filters reach (few samples see
// the lamp there, so that errors from few batches say nothing), all pictures get the reference's values.
void leave_out_lamps(std::vector<Image>& images, const Image& wanted, float most)
{
    constexpr int reach = 3;
    const auto near_lamp = [&](int x, int y) {
        for (int v = std::max(0, y - reach); v <= std::min(wanted.height - 1, y + reach); ++v)
            for (int u = std::max(0, x - reach); u <= std::min(wanted.width - 1, x + reach); ++u)
                for (int c = 0; c < 3; ++c)
                    if (wanted.at(u, v, c) >= most) return true;
        return false;
    };
    for (int y = 0; y < wanted.height; ++y)
        for (int x = 0; x < wanted.width; ++x) {
            if (!near_lamp(x, y)) continue;
            for (Image& image : images)
                for (int c = 0; c < 3; ++c) image.at(x, y, c) = wanted.at(x, y, c);
        }
}

// The mean over a block with its standard error, of the reference.
Estimate reference_estimate(const Image& image, const Image& error, int c, int x0, int x1, int y0, int y1)
{
    double variance = 0;
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) variance += double(error.at(x, y, c)) * error.at(x, y, c);
    return {region_mean(image, c, x0, x1, y0, y1), std::sqrt(variance) / (double(x1 - x0) * (y1 - y0)), 4};
}

// That two means differ by no more than `allowed` and so many standard errors.
void expect_near(const Estimate& ours, const Estimate& theirs, double allowed, double sigmas, const std::string& where)
{
    EXPECT_LE(std::abs(ours.mean - theirs.mean), allowed + sigmas * std::hypot(ours.error, theirs.error))
        << fmt::format("{}: {} +- {}, reference {} +- {}, ratio {:.4f}", where, ours.mean, ours.error, theirs.mean,
                       theirs.error, ours.mean / theirs.mean);
}

void PrintTo(const Reference& reference, std::ostream* out) { *out << reference.name << ' ' << reference.integrator; }

class References : public ::testing::TestWithParam<Reference> {};

TEST_P(References, AreMet)
{
    const Reference& r = GetParam();
    const std::optional<fs::path> shared = shared_folder();
    if (!shared) GTEST_SKIP() << "no shared/references beside the source folder and no DAPPLE_SHARED: nothing compared";
    const fs::path folder = *shared / "references";
    Image wanted = read_image((folder / (std::string(r.name) + ".exr")).string());
    Image error = read_image((folder / (std::string(r.name) + ".stderr.exr")).string());
    if (r.clamp > 0)
        for (size_t i = 0; i < wanted.pixels.size(); ++i)
            if (wanted.pixels[i] > r.clamp) error.pixels[i] = 0;
    limit(wanted, r.clamp);

    const TestScene scene = open_scene(r, *shared);
    RenderRequest request;
    request.integrator = r.integrator;
    request.passes = r.passes * pass_factor();
    request.settings = r.settings;
    if (r.settings.empty() || r.settings[0].first != "maxdepth") request.settings.emplace_back("maxdepth", "100");
    std::vector<Image> images = scene.render_batches(request, batches);
    ASSERT_EQ(images[0].width, wanted.width);
    ASSERT_EQ(images[0].height, wanted.height);
    if (r.clamp > 0) leave_out_lamps(images, wanted, r.clamp);

    const Image mean = mean_image(images);
    const ImageComparison comparison = compare_images(mean, wanted);
    fmt::print("[ measured ] {} / {}: ratios {:.4f} {:.4f} {:.4f}, relMSE {:.3g}\n", r.integrator, r.name,
               comparison.mean_ratio[0], comparison.mean_ratio[1], comparison.mean_ratio[2], comparison.relative_mse);
    EXPECT_EQ(comparison.non_finite, 0u);
    // Light tracing cannot see matter through delta surfaces: it is judged in the blocks where none is seen.
    const bool blind = std::string_view(r.integrator) == "lightpath";
    for (int c = 0; c < 3; ++c) {
        const Estimate ours = channel_estimate(images, c);
        const Estimate theirs = reference_estimate(wanted, error, c, 0, wanted.width, 0, wanted.height);
        if (!blind) expect_near(ours, theirs, r.picture_bound * theirs.mean, 4, fmt::format("channel {}", c));
        EXPECT_LT(ours.error, 0.02 * theirs.mean) << "too noisy to tell";
        // Errors of blocks from four batches are rough: the larger of a block's own and the root mean square of all.
        for (int y = 0; y < wanted.height; y += block)
            for (int x = 0; x < wanted.width; x += block) {
                const int x1 = std::min(x + block, wanted.width), y1 = std::min(y + block, wanted.height);
                if (blind && scene.sees_delta(x, x1, y, y1)) continue;
                Estimate a = region_estimate(images, c, x, x1, y, y1);
                const Estimate b = reference_estimate(wanted, error, c, x, x1, y, y1);
                const double spread =
                    ours.error * std::sqrt(double(wanted.width * wanted.height) / double((x1 - x) * (y1 - y)));
                a.error = std::max(a.error, spread);
                expect_near(a, b, r.block_bound * b.mean + 1e-3 * theirs.mean, 5,
                            fmt::format("block {},{} channel {}", x, y, c));
            }
    }
}

INSTANTIATE_TEST_SUITE_P(Shared, References, ::testing::ValuesIn(references), [](const auto& test) {
    std::string name = std::string(test.param.name) + "_" + test.param.integrator;
    for (char& c : name)
        if (c == '-') c = '_';
    return name;
});

}  // namespace
}  // namespace dapple::testing
