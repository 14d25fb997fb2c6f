#include "dapple/integrators/photon_discs.h"

#include "../transport/small_scene.h"

#include <cstdio>

namespace dapple {
namespace {

constexpr Vec3 up(0, 0, 1);

// The square [-1, 1]^2 at z = 0 with a thin wall of height 1 on it along y = 0.
std::unique_ptr<World> square_with_wall()
{
    test::SmallScene scene;
    scene::MeshData mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {-1, 0, 0}, {1, 0, 0}, {1, 0, 1}, {-1, 0, 1}};
    mesh.triangles = {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
    scene.shape(scene::Mesh{std::make_shared<scene::MeshData>(std::move(mesh))},
                scene.material(scene::DiffuseMaterial{scene::SpectrumInput(0.5f)}));
    return scene.world();
}

// Where light lands on the half y > 0.
Vec3 on_bright_half(uint64_t trial, uint32_t i)
{
    const Vec2 u = RandomStream(12, hash_words(trial, uint64_t(i)), 0).next_2d();
    return {2.0f * u.x - 1.0f, u.y, 0.0f};
}

// Light that falls evenly on one half of a floor, up to a wall. All of it stays there, though it moves away from the
// edges and the foot of the wall; hardly any comes to the other half.
TEST(PhotonDiscs, SpreadAllFluxOverWhatTheySee)
{
    const auto world = square_with_wall();
    constexpr uint32_t photon_count = 800;
    constexpr int trials = 40, steps = 40;
    double near_edges = 0.0, all = 0.0, squares = 0.0, beyond = 0.0;
    int edge_places = 0, hidden = 0;
    Statistics statistics;
    const PassContext context{*world, 0, 0, statistics};
    std::vector<WeightedPhoton> found;
    for (uint64_t trial = 0; trial < trials; ++trial) {
        std::vector<std::vector<Photon>> batches(1);
        std::vector<SurfacePlace> given;
        for (uint32_t i = 0; i < photon_count; ++i) {
            Photon photon;
            photon.position = on_bright_half(2 * trial, i);
            photon.flux = Spectrum(2.0f);
            batches[0].push_back(photon);
            if (i % 4 == 0) given.push_back({on_bright_half(2 * trial + 1, i), up});
        }
        const PhotonMap map(std::move(batches), photon_count);
        const PhotonDiscs discs(context, map, SurfacePlaces(given, 13), KernelKind::epanechnikov, 0.5f);
        double sum = 0.0;
        for (int i = 0; i < 2 * steps * steps; ++i) {
            const auto center = [](int k) { return 2.0f * (static_cast<float>(k) + 0.5f) / (2 * steps) - 1.0f; };
            const SurfaceRegion region{Vec3(center(i % (2 * steps)), center(steps + i / (2 * steps)), 0.0f), up};
            discs.find(*world, map, region, found);
            double value = 0.0;
            for (const WeightedPhoton& photon : found)
                value += static_cast<double>(map.flux(photon.first)[0] * photon.second);
            sum += value / (2 * steps * steps);
            if (region.position.y < 0.06f || region.position.y > 0.94f || std::fabs(region.position.x) > 0.94f) {
                near_edges += value;
                ++edge_places;
            }
            // Those who ask for both sides get the same, from the other side, too.
            discs.find(*world, map, {region.position, i % 2 ? up : -up, PhotonSide::both}, found);
            for (const WeightedPhoton& photon : found)
                value -= static_cast<double>(map.flux(photon.first)[0] * photon.second);
            EXPECT_NEAR(value, 0.0, 1e-4);
            const SurfaceRegion mirrored{Vec3(region.position.x, -region.position.y, 0.0f), up};
            hidden += discs.find(*world, map, mirrored, found);
            for (const WeightedPhoton& photon : found)
                beyond += static_cast<double>(map.flux(photon.first)[0] * photon.second) / (2 * steps * steps * trials);
        }
        all += sum / trials;
        squares += sum * sum / trials;
    }
    const double error = std::sqrt((squares - all * all) / trials);
    std::printf("[ measured ] light of the half %.4f +- %.4f, at its edges %.4f, beyond the wall %.5f\n", all, error,
                near_edges / edge_places, beyond);
    EXPECT_LT(error, 0.003) << "too noisy to tell";
    EXPECT_NEAR(all, 1.0, 4.0 * error);
    EXPECT_NEAR(near_edges / edge_places, 0.7, 0.05);
    EXPECT_LT(beyond, 0.003) << "what the three looks along a disc miss";
    EXPECT_GT(hidden, 100);
}

// Two squares that meet at an angle, lit evenly: what discs near the crease lose to the other plane's height they do
// not spread.
TEST(PhotonDiscs, SpreadAllFluxAcrossACrease)
{
    constexpr float angle = 0.5f;
    const float cosine = std::cos(angle), sine = std::sin(angle);
    // y along the surface, -1 to 1.
    const auto on_surface = [&](float x, float y) {
        return y < 0.0f ? Vec3(x, y, 0.0f) : Vec3(x, y * cosine, y * sine);
    };
    const auto normal = [&](float y) { return y < 0.0f ? up : Vec3(0.0f, -sine, cosine); };
    test::SmallScene scene;
    scene::MeshData mesh;
    mesh.positions = {on_surface(-1, -1), on_surface(1, -1), on_surface(1, 0),
                      on_surface(-1, 0),  on_surface(1, 1),  on_surface(-1, 1)};
    mesh.triangles = {0, 1, 2, 0, 2, 3, 3, 2, 4, 3, 4, 5};
    scene.shape(scene::Mesh{std::make_shared<scene::MeshData>(std::move(mesh))},
                scene.material(scene::DiffuseMaterial{scene::SpectrumInput(0.5f)}));
    const auto world = scene.world();
    Statistics statistics;
    const PassContext context{*world, 0, 0, statistics};
    constexpr uint32_t photon_count = 800;
    constexpr int trials = 40, steps = 80;
    double all = 0.0, squares = 0.0;
    std::vector<WeightedPhoton> found;
    for (uint64_t trial = 0; trial < trials; ++trial) {
        const auto fallen = [&](uint64_t purpose, uint32_t i) {
            const Vec2 u = RandomStream(14 + purpose, hash_words(trial, uint64_t(i)), 0).next_2d();
            return Vec2(2.0f * u.x - 1.0f, 2.0f * u.y - 1.0f);
        };
        std::vector<std::vector<Photon>> batches(1);
        std::vector<SurfacePlace> given;
        for (uint32_t i = 0; i < photon_count; ++i) {
            const Vec2 p = fallen(0, i);
            Photon photon;
            photon.position = on_surface(p.x, p.y);
            photon.normal = normal(p.y);
            photon.flux = Spectrum(1.0f);
            batches[0].push_back(photon);
            const Vec2 q = fallen(1, i);
            if (i % 4 == 0) given.push_back({on_surface(q.x, q.y), normal(q.y)});
        }
        const PhotonMap map(std::move(batches), photon_count);
        const PhotonDiscs discs(context, map, SurfacePlaces(given, 13), KernelKind::epanechnikov, 0.5f);
        double sum = 0.0;
        for (int i = 0; i < steps * steps; ++i) {
            const auto center = [](int k) { return 2.0f * (static_cast<float>(k) + 0.5f) / steps - 1.0f; };
            const float y = center(i / steps);
            discs.find(*world, map, {on_surface(center(i % steps), y), normal(y)}, found);
            for (const WeightedPhoton& photon : found) sum += static_cast<double>(photon.second) * sqr(2.0 / steps);
        }
        all += sum / trials;
        squares += sum * sum / trials;
    }
    const double error = std::sqrt((squares - all * all) / trials);
    std::printf("[ measured ] light of the bent surface %.4f +- %.4f\n", all, error);
    EXPECT_LT(error, 0.003) << "too noisy to tell";
    EXPECT_NEAR(all, 1.0, 4.0 * error);
}

}  // namespace
}  // namespace dapple
