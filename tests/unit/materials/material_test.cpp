// From materials to Bsdfs: ranges, roughness, indices, mixes, bump and normal maps.
#include "dapple/materials/material.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

struct MaterialTest : ::testing::Test {
    FloatTextureId number(float value)
    {
        TextureNode node;
        node.value[0] = value;
        materials.textures.floats.push_back(node);
        return FloatTextureId(materials.textures.floats.size() - 1);
    }
    SpectrumTextureId spectrum(float value)
    {
        TextureNode node;
        node.spectrum[0].scale = value;
        node.spectrum[0].rgb = Vec3(value);
        materials.textures.spectra.push_back(node);
        return SpectrumTextureId(materials.textures.spectra.size() - 1);
    }
    MaterialId add(const Material& material)
    {
        materials.list.push_back(material);
        return MaterialId(materials.list.size() - 1);
    }
    Bsdf make(const Material& material, const Wavelengths& wavelengths = Wavelengths(), int kept_lane = 0)
    {
        return make_bsdf(materials, pool, add(material), at, wavelengths, kept_lane);
    }

    Materials materials;
    SpectrumPool pool;
    SurfacePoint at;
};

TEST_F(MaterialTest, SharesOfLightStayInRange)
{
    Material material;
    material.reflectance = spectrum(1.7f);
    Bsdf bsdf = make(material);
    EXPECT_EQ(bsdf.kind, BsdfKind::diffuse);
    EXPECT_EQ(bsdf.a, Spectrum(1.0f));
    material.kind = Material::Kind::diffuse_transmission;
    material.reflectance = spectrum(0.4f);
    material.transmittance = spectrum(0.8f);
    material.scale = 0.5f;
    bsdf = make(material);
    EXPECT_FLOAT_EQ(bsdf.a[0], 0.2f);
    EXPECT_FLOAT_EQ(bsdf.b[3], 0.4f);
    EXPECT_TRUE(bsdf.transmits());
    EXPECT_FLOAT_EQ(guide_albedo(bsdf, {0, 0, 1})[0], 0.6f);
}

TEST_F(MaterialTest, RoughnessIsRemappedAndMayBeAnisotropic)
{
    Material material;
    material.kind = Material::Kind::dielectric;
    material.dielectric_eta.scale = 1.5f;
    EXPECT_TRUE(make(material).is_delta());
    material.u_roughness = number(0.25f);
    Bsdf bsdf = make(material);
    EXPECT_FLOAT_EQ(bsdf.roughness.x, 0.5f);
    EXPECT_FLOAT_EQ(bsdf.roughness.y, 0.5f);
    EXPECT_FLOAT_EQ(bsdf.eta, 1.5f);
    EXPECT_FALSE(bsdf.dispersive);
    EXPECT_FALSE(bsdf.is_delta());
    material.v_roughness = number(0.01f);
    EXPECT_FLOAT_EQ(make(material).roughness.y, 0.1f);
    material.remap_roughness = false;
    EXPECT_FLOAT_EQ(make(material).roughness.y, 0.01f);
}

TEST_F(MaterialTest, DispersionTakesTheIndexAtTheKeptLane)
{
    std::vector<float> index(spectrum_table_size);
    for (int i = 0; i < spectrum_table_size; ++i) index[i] = 1.6f - 0.0002f * float(i);  // 1.6 at 360 nm
    Material material;
    material.kind = Material::Kind::dielectric;
    material.dielectric_eta.kind = SpectrumValue::Kind::table;
    material.dielectric_eta.scale = 1.0f;
    material.dielectric_eta.table = pool.add_table(index);
    Wavelengths wavelengths;
    const float lambdas[] = {400, 500, 600, 700};
    std::copy(std::begin(lambdas), std::end(lambdas), wavelengths.lambda);
    const Bsdf bsdf = make(material, wavelengths, 2);
    EXPECT_TRUE(bsdf.dispersive);
    EXPECT_NEAR(bsdf.eta, 1.6f - 0.0002f * 240.0f, 1e-5f);
    const Bsdf rgb = make(material, Wavelengths::rgb(), 2);
    EXPECT_FALSE(rgb.dispersive);
    EXPECT_NEAR(rgb.eta, 1.6f - 0.0002f * 229.3f, 1e-5f);
}

TEST_F(MaterialTest, ConductorOfAReflectance)
{
    Material material;
    material.kind = Material::Kind::conductor;
    material.conductor_from_reflectance = true;
    material.reflectance = spectrum(0.64f);
    const Bsdf bsdf = make(material);
    EXPECT_NEAR(guide_albedo(bsdf, {0, 0, 1})[1], 0.64f, 1e-5f);
    material.reflectance = spectrum(1.0f);
    EXPECT_TRUE(make(material).b.is_finite());
}

TEST_F(MaterialTest, CoatedConductorSeesTheMetalFromInsideTheCoat)
{
    Material material;
    material.kind = Material::Kind::coated_conductor;
    material.dielectric_eta.scale = 1.5f;
    material.eta = spectrum(0.3f);
    material.k = spectrum(3.0f);
    material.coat_u_roughness = number(0.04f);
    material.u_roughness = number(0.25f);
    material.thickness = number(0.01f);
    material.g = number(5.0f);
    const Bsdf bsdf = make(material);
    EXPECT_FLOAT_EQ(bsdf.a[0], 0.2f);
    EXPECT_FLOAT_EQ(bsdf.b[0], 2.0f);
    EXPECT_FLOAT_EQ(bsdf.roughness.x, 0.2f);
    EXPECT_FLOAT_EQ(bsdf.base_roughness.y, 0.5f);
    EXPECT_FLOAT_EQ(bsdf.layer_thickness, 0.01f);
    EXPECT_FLOAT_EQ(bsdf.layer_g, 1.0f);
    EXPECT_TRUE(bsdf.layer_albedo.is_black());
    at.position = {1, 2, 3};
    EXPECT_NE(make(material).layer_seed, bsdf.layer_seed);
}

TEST_F(MaterialTest, MixChoosesByPositionInTheSharesAskedFor)
{
    Material a, b, mix, outer;
    a.reflectance = spectrum(0.1f);
    b.reflectance = spectrum(0.9f);
    mix.kind = outer.kind = Material::Kind::mix;
    mix.mix[0] = add(a);
    mix.mix[1] = add(b);
    mix.mix_amount = number(0.3f);
    outer.mix[0] = add(mix);
    outer.mix[1] = mix.mix[0];
    outer.mix_amount = number(0.0f);
    const MaterialId id = add(outer);
    int second = 0;
    constexpr int count = 10000;
    for (int i = 0; i < count; ++i) {
        at.position = {float(i) * 0.01f, 1.0f, -2.0f};
        const MaterialId chosen = resolve_mix(materials, id, at);
        ASSERT_EQ(chosen, resolve_mix(materials, id, at));
        second += chosen == mix.mix[1];
    }
    EXPECT_NEAR(second, 0.3 * count, 4.0 * std::sqrt(0.21 * count));
}

// A plane with dp/du = (2, 0, 0) and dp/dv = (0, 3, 0), displaced by h = 0.4 u + 0.6 v: the slopes are 0.2 and 0.2.
TEST_F(MaterialTest, BumpedPlaneTiltsAsItsSlopesSay)
{
    TextureNode node;
    node.kind = TextureNode::Kind::bilerp;
    node.value[0] = 0.0f, node.value[1] = 0.6f, node.value[2] = 0.4f, node.value[3] = 1.0f;
    materials.textures.floats.push_back(node);
    Material material;
    material.reflectance = spectrum(0.5f);
    material.displacement = FloatTextureId(0);
    at.dpdu = {2, 0, 0};
    at.dpdu_shading = {1, 0, 0};
    at.dpdv = {0, 3, 0};
    at.uv = {0.3f, 0.2f};
    Bsdf bsdf = make(material);
    const Vec3 expected = normalize(Vec3(-0.2f, -0.2f, 1.0f));
    EXPECT_LT(length(bsdf.frame.n - expected), 1e-3f);
    EXPECT_EQ(bsdf.n_geometric, Vec3(0, 0, 1));
    EXPECT_NEAR(dot(bsdf.frame.n, bsdf.frame.s), 0.0f, 1e-6f);
    EXPECT_GT(bsdf.frame.s.x, 0.9f);
    // The other side out: displacement goes along the new normal.
    at.n_geometric = at.n_shading = {0, 0, -1};
    bsdf = make(material);
    EXPECT_LT(length(bsdf.frame.n - normalize(Vec3(-0.2f, -0.2f, -1.0f))), 1e-3f);
    // A parametrisation that has collapsed leaves the normal alone.
    at.dpdv = {0, 0, 0};
    materials.textures.floats[0].value[1] = 0.0f, materials.textures.floats[0].value[3] = 0.4f;
    EXPECT_EQ(make(material).frame.n, at.n_shading);
}

TEST_F(MaterialTest, NormalMapsAreInTheTangentFrame)
{
    Image image(1, 1, 3);
    const Vec3 local = normalize(Vec3(0.3f, -0.2f, 0.9f));
    for (int c = 0; c < 3; ++c) image.at(0, 0, c) = 0.5f * local[c] + 0.5f;
    materials.textures.images.push_back(image);
    Material material;
    material.reflectance = spectrum(0.5f);
    material.normal_map = 0;
    at.dpdu_shading = {0, 1, 0};  // the map's x axis; its y axis is n x dpdu = -x
    const Bsdf bsdf = make(material);
    EXPECT_LT(length(bsdf.frame.n - Vec3(-local.y, local.x, local.z)), 1e-5f);
}

TEST_F(MaterialTest, KnowsWhoLooksAtTangents)
{
    Material plain;
    plain.u_roughness = plain.v_roughness = number(0.2f);
    EXPECT_FALSE(uses_tangents(plain));
    Material brushed = plain;
    brushed.v_roughness = number(0.3f);
    EXPECT_TRUE(uses_tangents(brushed));
    Material brushed_coat = plain;
    brushed_coat.coat_u_roughness = number(0.1f);
    brushed_coat.coat_v_roughness = number(0.3f);
    EXPECT_TRUE(uses_tangents(brushed_coat));
    Material bumped = plain;
    bumped.displacement = number(0.0f);
    EXPECT_TRUE(uses_tangents(bumped));
    Material mapped = plain;
    mapped.normal_map = 0;
    EXPECT_TRUE(uses_tangents(mapped));

    // Through mixes, and mixes that form a circle.
    Material mix;
    mix.kind = Material::Kind::mix;
    mix.mix[0] = MaterialId(0);
    mix.mix[1] = MaterialId(1);
    materials.list = {plain, mix};
    EXPECT_EQ(needed_detail(materials, MaterialId(0)), SurfaceDetail::bare);
    EXPECT_EQ(needed_detail(materials, MaterialId(1)), SurfaceDetail::bare);
    materials.list[1].mix[1] = MaterialId(2);
    materials.list.push_back(brushed);
    EXPECT_EQ(needed_detail(materials, MaterialId(0)), SurfaceDetail::bare);
    EXPECT_EQ(needed_detail(materials, MaterialId(1)), SurfaceDetail::tangents);
}

}  // namespace
}  // namespace dapple
