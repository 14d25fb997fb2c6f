// What a scattering event costs: making the Bsdf of a point, its value, its density, a sample. Time per call;
// directions and points change from call to call.
#include "dapple/materials/material.h"
#include "dapple/math/hash.h"
#include "dapple/spectrum/make_spectrum.h"

#include <benchmark/benchmark.h>

using namespace dapple;

namespace {

constexpr int points = 1024;

FloatTextureId constant(Materials& materials, float value)
{
    TextureNode node;
    node.value[0] = value;
    materials.textures.floats.push_back(node);
    return FloatTextureId(static_cast<uint32_t>(materials.textures.floats.size() - 1));
}

SpectrumTextureId constant(Materials& materials, const SpectrumValue& value)
{
    TextureNode node;
    node.spectrum[0] = value;
    materials.textures.spectra.push_back(node);
    return SpectrumTextureId(static_cast<uint32_t>(materials.textures.spectra.size() - 1));
}

// One material, as the compiler makes it, and points to look it up at.
struct Scene {
    SpectrumPool pool;
    Materials materials;
    std::vector<SurfacePoint> at;
    std::vector<Vec3> directions;
    Wavelengths wavelengths = Wavelengths::sample_visible(0.3f);

    Scene(Material::Kind kind, float roughness)
    {
        Material m;
        m.kind = kind;
        m.reflectance = constant(materials, make_albedo(pool, srgb(), Vec3(0.4f, 0.5f, 0.3f)));
        m.eta = constant(materials, make_named(pool, "metal-Au-eta"));
        m.k = constant(materials, make_named(pool, "metal-Au-k"));
        m.dielectric_eta = make_constant(1.5f);
        m.u_roughness = constant(materials, roughness);
        m.v_roughness = m.u_roughness;
        m.coat_u_roughness = m.u_roughness;
        m.coat_v_roughness = m.u_roughness;
        m.thickness = constant(materials, 0.01f);
        m.g = constant(materials, 0.0f);
        m.albedo = constant(materials, make_constant(0.0f));
        materials.list.push_back(m);
        const auto number = [](int i) { return to_unit_float(mix64(static_cast<uint64_t>(i))); };
        for (int i = 0; i < points; ++i) {
            SurfacePoint p;
            p.position = Vec3(number(4 * i), number(4 * i + 1), 0.0f);
            p.n_geometric = p.n_shading = Vec3(0, 0, 1);
            at.push_back(p);
            const float z = 0.1f + 0.9f * number(4 * i + 2);
            directions.push_back(spherical_direction(safe_sqrt(1.0f - z * z), z, 2.0f * pi * number(4 * i + 3)));
        }
    }
    Bsdf bsdf(int i) const { return make_bsdf(materials, pool, MaterialId(0u), at[i % points], wavelengths, 0); }
};

Scene make_scene(const benchmark::State& state)
{
    return Scene(static_cast<Material::Kind>(state.range(0)), static_cast<float>(state.range(1)) / 1000.0f);
}

void make(benchmark::State& state)
{
    const Scene scene = make_scene(state);
    int i = 0;
    for (auto _ : state) benchmark::DoNotOptimize(scene.bsdf(i++));
}

// Times call(scene, bsdf, i) on one Bsdf, whose layers are walked anew at each call.
template <class Call>
void time_calls(benchmark::State& state, const Call& call)
{
    const Scene scene = make_scene(state);
    Bsdf bsdf = scene.bsdf(0);
    int i = 0;
    for (auto _ : state) {
        bsdf.layer_seed = static_cast<uint32_t>(++i);
        benchmark::DoNotOptimize(call(scene, bsdf, i));
    }
}

void value(benchmark::State& state)
{
    time_calls(state, [](const Scene& scene, const Bsdf& bsdf, int i) {
        return evaluate(bsdf, scene.directions[i % points], scene.directions[(i + 7) % points],
                        TransportMode::radiance);
    });
}

void density(benchmark::State& state)
{
    time_calls(state, [](const Scene& scene, const Bsdf& bsdf, int i) {
        return pdf(bsdf, scene.directions[i % points], scene.directions[(i + 7) % points], TransportMode::radiance);
    });
}

void sample(benchmark::State& state)
{
    BsdfSample drawn;
    time_calls(state, [&](const Scene& scene, const Bsdf& bsdf, int i) {
        const Vec3& u = scene.at[i % points].position;
        const bool valid =
            sample_bsdf(bsdf, scene.directions[(i + 7) % points], u.x, Vec2(u.y, u.x), TransportMode::radiance, drawn);
        benchmark::DoNotOptimize(drawn);
        return valid;
    });
}

// Kind and roughness in thousandths.
void cases(benchmark::internal::Benchmark* bench)
{
    const auto add = [&](Material::Kind kind, int roughness) { bench->Args({static_cast<int>(kind), roughness}); };
    add(Material::Kind::diffuse, 0);
    add(Material::Kind::conductor, 100);
    add(Material::Kind::dielectric, 100);
    add(Material::Kind::coated_diffuse, 0);
    add(Material::Kind::coated_diffuse, 100);
    add(Material::Kind::coated_conductor, 100);
    bench->ArgNames({"kind", "roughness"});
}

BENCHMARK(make)->Apply(cases);
BENCHMARK(value)->Apply(cases);
BENCHMARK(density)->Apply(cases);
BENCHMARK(sample)->Apply(cases);

}  // namespace

BENCHMARK_MAIN();
