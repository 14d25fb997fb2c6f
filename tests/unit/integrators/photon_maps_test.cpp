#include "dapple/integrators/photon_maps.h"

#include <gtest/gtest.h>

#include "dapple/base/parallel.h"
#include "dapple/integrators/light_subpaths.h"
#include "dapple/integrators/light_survey.h"
#include "dapple/transport/emission.h"
#include "dapple/transport/photon_tracing.h"
#include "dapple/world/compile.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace dapple {
namespace {

// A closed box of edge 2 with all walls of one grey, and a point light off its centre.
scene::Description grey_box(float reflectance)
{
    scene::Description description;
    description.materials.resize(1);
    description.materials[0].kind = scene::DiffuseMaterial{scene::SpectrumInput(reflectance)};
    auto data = std::make_shared<scene::MeshData>();
    for (int i = 0; i < 8; ++i)
        data->positions.push_back(Vec3(i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f));
    data->triangles = {0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1,
                       2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3};
    scene::Shape box;
    box.geometry = scene::Mesh{data};
    box.material = scene::MaterialIndex(0u);
    box.name = "box";
    description.shapes.push_back(box);
    scene::Light light;
    light.kind = scene::PointLight{scene::SpectrumSource(scene::White{}), Vec3(0.3f, -0.2f, 0.1f)};
    description.lights.push_back(light);
    return description;
}

double total_flux(const std::vector<std::vector<Photon>>& batches, int lane)
{
    double sum = 0.0;
    for (const auto& batch : batches)
        for (const Photon& photon : batch) sum += photon.flux[lane];
    return sum;
}

TEST(PhotonTracing, ConservesFluxInAClosedGreyBox)
{
    constexpr float reflectance = 0.6f;
    const auto world = compile(grey_box(reflectance));
    PhotonRequest request;
    request.wavelengths = Wavelengths::sample_visible(0.1f);
    request.seed = 3;
    request.paths = 200000;

    // First hits alone carry the emitted flux exactly: nothing has been scattered or ended yet.
    request.max_depth = 1;
    const double first = total_flux(trace_photons(*world, request), 2) / static_cast<double>(request.paths);
    RandomStream random(1, 1, 0);
    Walk walk;
    Departure departure;
    ASSERT_TRUE(emit(*world, path_start(request.wavelengths, random.next_2d()), random, walk, departure));
    EXPECT_NEAR(first, walk.source()[2], 1e-4 * walk.source()[2]);

    // All hits: the geometric series of the reflectance. Roulette ends paths; its spread is that of a geometric number
    // of hits, variance reflectance / (1 - reflectance)^2 per path.
    request.max_depth = 1000;
    const double all = total_flux(trace_photons(*world, request), 2) / static_cast<double>(request.paths);
    const double expected = first / (1.0 - reflectance);
    const double spread = first * std::sqrt(reflectance) / (1.0 - reflectance) / std::sqrt(double(request.paths));
    EXPECT_NEAR(all, expected, 4.0 * spread);
}

TEST(PhotonMaps, WavelengthSetsOfAnEpochInterleave)
{
    std::vector<float> all;
    for (int set = 0; set < 4; ++set) {
        const Wavelengths w = wavelengths_of_set(ColorModel::spectral, 5, 2, set, 4);
        all.insert(all.end(), w.lambda, w.lambda + Spectrum::lanes);
    }
    // In the variable that sample_visible inverts, sixteen wavelengths are spaced evenly by one sixteenth.
    std::vector<float> u;
    for (float lambda : all) u.push_back((0.85691062f - std::tanh((538.0f - lambda) / 138.888889f)) / 1.82750197f);
    std::sort(u.begin(), u.end());
    for (size_t i = 1; i < u.size(); ++i) EXPECT_NEAR(u[i] - u[i - 1], 1.0f / 16.0f, 1e-3f);
}

TEST(PhotonMaps, AnEpochDependsOnItsNumberAlone)
{
    const auto world = compile(grey_box(0.5f));
    Statistics statistics;
    PassContext context{*world, 11, 0, statistics};
    PhotonMapPlan plan;
    plan.global_paths = 20000;
    plan.precompute_irradiance = true;
    plan.nearest = 50;
    int records = 0;
    const auto digest = [&](uint32_t epoch) {
        uint64_t hash = 0;
        for (const PhotonMapSet& set : trace_photon_maps(context, ColorModel::spectral, plan, epoch))
            for (uint32_t slot = 0; slot < set.global.size(); ++slot) {
                const Photon photon = set.global.photon(slot);
                hash = hash_words(hash, float_bits(photon.position.x), float_bits(photon.flux[1]));
                const IrradianceRecord* record = set.irradiance.nearest(set.places, photon.position, photon.normal);
                if (record) hash = hash_words(hash, float_bits(record->irradiance[1]), float_bits(record->reach));
                records += record != nullptr;
            }
        return hash;
    };
    const int threads = thread_count();
    set_thread_count(1);
    const uint64_t alone = digest(3);
    set_thread_count(7);
    digest(2);
    EXPECT_EQ(digest(3), alone);
    EXPECT_NE(digest(2), alone);
    EXPECT_GT(records, 10000);
    set_thread_count(threads);
}

// The grey box with a bulb of thin glass around its light.
scene::Description bulb_in_a_box()
{
    scene::Description description = grey_box(0.5f);
    scene::Material glass;
    glass.kind = scene::ThinDielectricMaterial{};
    description.materials.push_back(glass);
    scene::Shape bulb = description.shapes[0];
    auto smaller = std::make_shared<scene::MeshData>(*std::get<scene::Mesh>(bulb.geometry).data);
    for (Vec3& position : smaller->positions) position *= 0.6f;
    bulb.geometry = scene::Mesh{smaller};
    bulb.material = scene::MaterialIndex(1u);
    description.shapes.push_back(bulb);
    return description;
}

TEST(LightSurvey, TellsLightThroughGlassFromOther)
{
    EXPECT_EQ(caustic_share(*compile(grey_box(0.5f))).all, 0.0);
    const CausticShare bulb = caustic_share(*compile(bulb_in_a_box()));
    EXPECT_EQ(bulb.all, 1.0);
    EXPECT_EQ(bulb.of_points, 1.0) << "the lamp is a point, which no eye path meets";
}

TEST(LightSurvey, FollowsTheMirrorReflectionOfSmoothCoats)
{
    // Light from inside the box meets walls at no more than 70 degrees or so: of it a coat of glass reflects 4 to 17 %,
    // which the next wall's coat does again.
    scene::Description description = grey_box(0.5f);
    description.materials[0].kind = scene::CoatedDiffuseMaterial{};
    const double share = caustic_share(*compile(description)).all;
    EXPECT_GT(share, 0.03);
    EXPECT_LT(share, 0.12);
}

TEST(PhotonMaps, KeepToTheMemoryCeiling)
{
    const auto world = compile(grey_box(0.8f));
    Statistics statistics;
    PassContext context{*world, 1, 0, statistics};
    PhotonMapPlan plan;
    plan.global_paths = 1'000'000'000;
    plan.caustic_paths = 1'000'000'000;
    plan.nearest = 50;
    plan.precompute_irradiance = true;
    constexpr int64_t ceiling = 64 << 20;
    limit_memory(plan, context, ColorModel::spectral, ceiling);
    EXPECT_LT(plan.global_paths, 1'000'000'000);
    size_t kept = 0;
    for (const PhotonMapSet& set : trace_photon_maps(context, ColorModel::spectral, plan, 0))
        kept += set.global.memory_bytes() + set.caustic.memory_bytes() + set.discs.memory_bytes() +
                set.places.memory_bytes() + set.irradiance.memory_bytes();
    EXPECT_LT(kept, static_cast<size_t>(ceiling));
    EXPECT_GT(kept, static_cast<size_t>(ceiling) / 8);  // the ceiling is used, not feared
}

TEST(PhotonMaps, CountEachPhotonAsOftenAsItIsKept)
{
    // Estimates are in the proportions of what is kept: with and without direct light (there is none in the bulb's
    // box), with and without a caustic map (nothing to keep there without a bulb).
    PhotonMapPlan whole;
    whole.global_paths = 40000;
    PhotonMapPlan indirect = whole, one_map = whole;
    indirect.keep_direct = false;
    one_map.caustic_map = false;
    const auto expect_same_share = [&](const scene::Description& description, const PhotonMapPlan& part) {
        const auto world = compile(description);
        Statistics statistics;
        PassContext context{*world, 1, 0, statistics};
        const auto kept = [&](const PhotonMapPlan& plan) {
            double photons = 0.0;
            for (const PhotonMapSet& set : trace_photon_maps(context, ColorModel::spectral, plan, 0))
                photons += set.global.size() + set.caustic.size();
            return photons;
        };
        const auto bytes = [&](const PhotonMapPlan& plan) {
            return photon_map_bytes(plan, context, ColorModel::spectral);
        };
        const double share = kept(part) / kept(whole);
        EXPECT_LT(share, 0.8);
        EXPECT_NEAR(bytes(part) / bytes(whole), share, 0.02);
    };
    expect_same_share(grey_box(0.5f), indirect);
    expect_same_share(bulb_in_a_box(), one_map);
}

TEST(LightSubpaths, MemoryCountsWhatBuildingTakes)
{
    const auto world = compile(grey_box(0.5f));
    Statistics statistics;
    PassContext context{*world, 1, 0, statistics};
    LightSubpathPlan plan;
    plan.paths = 64 * 64;
    plan.wavelength_sets = 1;
    plan.rules.light_paths = static_cast<double>(plan.paths);
    std::atomic<size_t> vertices{0};
    const auto bytes_per_vertex = [&](bool merging) {
        plan.merging = merging;
        plan.radius = MergeRadius::fixed(0.1f);
        vertices = 0;
        const LightSubpaths paths(context, ColorModel::spectral, {64, 64}, plan,
                                  [&](const LightSubpaths&, int64_t, const LightArrival&) { ++vertices; });
        return static_cast<double>(paths.memory_bytes()) / static_cast<double>(vertices);
    };
    const double kept = sizeof(MergePhoton) + 15.4, building = 16 + 12 + 4 + 32;
    EXPECT_NEAR(bytes_per_vertex(true) - bytes_per_vertex(false), kept + building, 2.0);
}

}  // namespace
}  // namespace dapple
