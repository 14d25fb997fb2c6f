// Textures against values worked out by hand.
#include "dapple/materials/texture.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

SurfacePoint point_at(const Vec3& p, const Vec2& uv = {0, 0})
{
    SurfacePoint at;
    at.position = p;
    at.uv = uv;
    return at;
}

TextureNode float_constant(float value)
{
    TextureNode node;
    node.value[0] = value;
    return node;
}

TextureNode spectrum_constant(float value)
{
    TextureNode node;
    node.spectrum[0].scale = value;
    node.spectrum[0].rgb = Vec3(value);
    return node;
}

// (s, t) as a texture that is linear in them: bilerp of 10 s + t.
Vec2 mapped(const TextureMapping& mapping, const SurfacePoint& at)
{
    Textures textures;
    TextureNode node;
    node.kind = TextureNode::Kind::bilerp;
    node.mapping = mapping;
    node.value[0] = 0.0f, node.value[1] = 0.0f, node.value[2] = 1.0f, node.value[3] = 1.0f;
    textures.floats.push_back(node);
    node.value[1] = 1.0f, node.value[2] = 0.0f;
    textures.floats.push_back(node);
    return {evaluate(textures, FloatTextureId(0), at), evaluate(textures, FloatTextureId(1), at)};
}

TEST(Texture, Mappings)
{
    TextureMapping mapping;
    mapping.su = 2.0f, mapping.sv = 3.0f, mapping.du = 0.1f, mapping.dv = -0.2f;
    Vec2 st = mapped(mapping, point_at(Vec3(0.0f), {0.3f, 0.4f}));
    EXPECT_NEAR(st.x, 0.7f, 1e-6f);
    EXPECT_NEAR(st.y, 1.0f, 1e-6f);

    mapping.texture_from_world = translation({-1, 0, 0});
    mapping.kind = TextureMapping::Kind::spherical;
    st = mapped(mapping, point_at({1, 2, 2}));  // (0, 2, 2): 45 degrees from z, 90 degrees around it
    EXPECT_NEAR(st.x, 0.25f, 1e-6f);
    EXPECT_NEAR(st.y, 0.25f, 1e-6f);
    st = mapped(mapping, point_at({1, -2, 0}));  // the azimuth runs from 0 to 2 pi
    EXPECT_NEAR(st.x, 0.5f, 1e-6f);
    EXPECT_NEAR(st.y, 0.75f, 1e-6f);

    mapping.kind = TextureMapping::Kind::cylindrical;
    st = mapped(mapping, point_at({1, -2, 0.3f}));
    EXPECT_NEAR(st.x, 0.25f, 1e-6f);
    EXPECT_NEAR(st.y, 0.3f, 1e-6f);

    mapping.kind = TextureMapping::Kind::planar;
    mapping.vs = {2, 0, 0}, mapping.vt = {0, 0.5f, 1};
    st = mapped(mapping, point_at({1.25f, 1, 0.1f}));
    EXPECT_NEAR(st.x, 0.6f, 1e-6f);
    EXPECT_NEAR(st.y, 0.4f, 1e-6f);
}

TEST(Texture, BilerpCornersAreInUThenVOrder)
{
    Textures textures;
    TextureNode node;
    node.kind = TextureNode::Kind::bilerp;
    for (int i = 0; i < 4; ++i) {
        node.value[i] = float(1 << i);
        node.spectrum[i].scale = float(1 << i);
    }
    textures.floats.push_back(node);
    textures.spectra.push_back(node);
    const SpectrumPool pool;
    const Vec2 corners[] = {{0, 0}, {0, 1}, {1, 0}, {1, 1}};
    for (int i = 0; i < 4; ++i) {
        const SurfacePoint at = point_at(Vec3(0.0f), corners[i]);
        EXPECT_FLOAT_EQ(evaluate(textures, FloatTextureId(0), at), float(1 << i));
        EXPECT_FLOAT_EQ(evaluate(textures, pool, SpectrumTextureId(0), at, Wavelengths())[2], float(1 << i));
    }
    EXPECT_FLOAT_EQ(evaluate(textures, FloatTextureId(0), point_at(Vec3(0.0f), {0.5f, 0.5f})), 15.0f / 4.0f);
}

TEST(Texture, CheckerboardsInTwoAndThreeDimensions)
{
    Textures textures;
    textures.floats = {float_constant(1.0f), float_constant(2.0f), {}, {}};
    for (int i : {2, 3}) {
        textures.floats[i].kind = TextureNode::Kind::checkerboard;
        textures.floats[i].child[0] = 0, textures.floats[i].child[1] = 1;
    }
    textures.floats[2].mapping.su = textures.floats[2].mapping.sv = 4.0f;
    textures.floats[3].checkerboard_dimensions = 3;
    textures.floats[3].mapping.texture_from_world = scaling({2, 2, 2});
    const auto flat = [&](float u, float v) {
        return evaluate(textures, FloatTextureId(2), point_at(Vec3(0.0f), {u, v}));
    };
    EXPECT_EQ(flat(0.1f, 0.1f), 1.0f);
    EXPECT_EQ(flat(0.3f, 0.1f), 2.0f);
    EXPECT_EQ(flat(0.3f, 0.3f), 1.0f);
    EXPECT_EQ(flat(-0.1f, 0.1f), 2.0f);
    const auto solid = [&](const Vec3& p) { return evaluate(textures, FloatTextureId(3), point_at(p)); };
    EXPECT_EQ(solid({0.2f, 0.2f, 0.2f}), 1.0f);
    EXPECT_EQ(solid({0.7f, 0.2f, 0.2f}), 2.0f);
    EXPECT_EQ(solid({0.7f, 0.7f, 0.2f}), 1.0f);
    EXPECT_EQ(solid({0.7f, 0.7f, -0.2f}), 2.0f);
}

TEST(Texture, ScaleMixAndDirectionMix)
{
    Textures textures;
    textures.floats = {float_constant(0.25f), float_constant(3.0f), {}, {}};
    textures.spectra = {spectrum_constant(0.5f), spectrum_constant(2.0f), {}, {}, {}, {}};
    const TextureNode::Kind kinds[] = {TextureNode::Kind::scale, TextureNode::Kind::mix};
    for (int i = 0; i < 2; ++i)
        for (TextureNode* node : {&textures.floats[2 + i], &textures.spectra[2 + i]}) {
            node->kind = kinds[i];
            node->child[0] = 0, node->child[1] = 1;
        }
    textures.floats[3].amount = textures.spectra[3].amount = 0;
    textures.spectra[4] = textures.spectra[2];  // scale by a float
    textures.spectra[4].amount = 1;
    textures.spectra[5] = textures.spectra[2];
    textures.spectra[5].kind = TextureNode::Kind::direction_mix;
    textures.spectra[5].direction = {0, 0, 1};
    const SpectrumPool pool;
    SurfacePoint at;
    at.n_geometric = {0.8f, 0.0f, -0.6f};
    const auto spectrum = [&](int i) { return evaluate(textures, pool, SpectrumTextureId(i), at, Wavelengths())[0]; };
    EXPECT_FLOAT_EQ(evaluate(textures, FloatTextureId(2), at), 0.75f);
    EXPECT_FLOAT_EQ(evaluate(textures, FloatTextureId(3), at), 0.75f * 0.25f + 0.25f * 3.0f);
    EXPECT_FLOAT_EQ(spectrum(2), 1.0f);
    EXPECT_FLOAT_EQ(spectrum(3), 0.75f * 0.5f + 0.25f * 2.0f);
    EXPECT_FLOAT_EQ(spectrum(4), 1.5f);
    EXPECT_FLOAT_EQ(spectrum(5), 0.6f * 0.5f + 0.4f * 2.0f);
}

// A 2 x 2 image; the first row is the top, where v = 1.
struct ImageTexture : ::testing::Test {
    ImageTexture()
    {
        Image image(2, 2, 1);
        image.pixels = {1, 2, 3, 4};
        textures.images.push_back(image);
        TextureNode node;
        node.kind = TextureNode::Kind::image;
        textures.floats.push_back(node);
    }
    float at(float u, float v) { return evaluate(textures, FloatTextureId(0), point_at(Vec3(0.0f), {u, v})); }
    TextureNode& node() { return textures.floats[0]; }

    Textures textures;
};

TEST_F(ImageTexture, NearestAndBilinear)
{
    node().filter = ImageFilter::nearest;
    EXPECT_EQ(at(0.1f, 0.9f), 1.0f);
    EXPECT_EQ(at(0.9f, 0.9f), 2.0f);
    EXPECT_EQ(at(0.1f, 0.1f), 3.0f);
    node().filter = ImageFilter::bilinear;
    EXPECT_FLOAT_EQ(at(0.25f, 0.75f), 1.0f);  // a pixel's centre
    EXPECT_FLOAT_EQ(at(0.5f, 0.5f), 2.5f);
    EXPECT_FLOAT_EQ(at(0.375f, 0.75f), 1.25f);
}

TEST_F(ImageTexture, Wrapping)
{
    node().wrap = ImageWrap::repeat;
    EXPECT_FLOAT_EQ(at(0.0f, 0.75f), 1.5f);
    EXPECT_FLOAT_EQ(at(-2.75f, 5.75f), 1.0f);
    node().wrap = ImageWrap::clamp;
    EXPECT_FLOAT_EQ(at(0.0f, 0.75f), 1.0f);
    EXPECT_FLOAT_EQ(at(9.0f, -3.0f), 4.0f);
    node().wrap = ImageWrap::black;
    EXPECT_FLOAT_EQ(at(0.0f, 0.75f), 0.5f);
    EXPECT_FLOAT_EQ(at(9.0f, 0.5f), 0.0f);
    for (const float wild : {infinity, -infinity, std::nanf(""), 1e30f}) EXPECT_TRUE(std::isfinite(at(wild, wild)));
}

TEST_F(ImageTexture, ScaleThenInvertAndChannels)
{
    node().scale = 0.2f;
    node().invert = true;
    EXPECT_FLOAT_EQ(at(0.25f, 0.75f), 0.8f);
    node().scale = 2.0f;
    EXPECT_FLOAT_EQ(at(0.25f, 0.75f), 0.0f);  // not negative
    node().scale = 1.0f, node().invert = false;
    textures.images[0] = Image(1, 1, 3);
    textures.images[0].pixels = {1, 2, 6};
    EXPECT_FLOAT_EQ(at(0.5f, 0.5f), 3.0f);
    textures.images[0] = Image(1, 1, 4);
    textures.images[0].pixels = {1, 2, 6, 0.5f};
    EXPECT_FLOAT_EQ(at(0.5f, 0.5f), 0.5f);
}

TEST_F(ImageTexture, ColoursBecomeSpectra)
{
    SpectrumPool pool;
    pool.prepare_rgb(srgb());
    textures.images[0] = Image(1, 1, 3);
    textures.images[0].pixels = {0.2f, 0.7f, 1.4f};
    TextureNode color = node();
    textures.spectra.push_back(color);
    color.use = SpectrumUse::unbounded;
    textures.spectra.push_back(color);
    color.invert = true;
    textures.spectra.push_back(color);
    const auto evaluated = [&](int id, const Wavelengths& w) {
        return evaluate(textures, pool, SpectrumTextureId(id), SurfacePoint(), w);
    };
    const Spectrum clamped = evaluated(0, Wavelengths::rgb());
    EXPECT_NEAR(clamped[0], 0.2f, 1e-5f);
    EXPECT_NEAR(clamped[2], 1.0f, 1e-5f);
    EXPECT_NEAR(clamped[3], 0.7f, 1e-5f);
    EXPECT_NEAR(evaluated(1, Wavelengths::rgb())[2], 1.4f, 1e-5f);
    EXPECT_NEAR(evaluated(2, Wavelengths::rgb())[0], 0.8f, 1e-5f);
    EXPECT_EQ(evaluated(2, Wavelengths::rgb())[2], 0.0f);
    const Wavelengths w = Wavelengths::sample_visible(0.3f);
    EXPECT_EQ(evaluated(0, w), pool.evaluate_rgb(RgbUse::albedo, {0.2f, 0.7f, 1.0f}, w));
    // A grey pixel is a flat spectrum, whether the image has one channel or three.
    textures.images[0] = Image(1, 1, 1);
    textures.images[0].pixels = {0.3f};
    for (int lane = 0; lane < Spectrum::lanes; ++lane) EXPECT_NEAR(evaluated(0, w)[lane], 0.3f, 1e-3f);
}

}  // namespace
}  // namespace dapple
