// Spectra as the compiled world holds them: sampling of wavelengths, and both colour models saying the same.
#include "dapple/spectrum/make_spectrum.h"

#include "dapple/math/hash.h"
#include "dapple/spectrum/photometry.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

// XYZ of a value by summation over the grid.
Vec3 xyz_of(const SpectrumPool& pool, const SpectrumValue& value)
{
    std::vector<float> table(spectrum_table_size);
    for (int i = 0; i < spectrum_table_size; ++i) table[i] = pool.evaluate(value, lambda_min + static_cast<float>(i));
    return xyz_of_table(table);
}

Vec3 srgb_of_light(const SpectrumPool& pool, const SpectrumValue& value)
{
    return multiply(srgb().rgb_from_xyz, xyz_of(pool, value));
}

void expect_near(const Vec3& a, const Vec3& b, float tolerance)
{
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance);
}

std::string message_of(SpectrumPool& pool, std::string_view name)
{
    try {
        make_named(pool, name);
    } catch (const UserError& error) {
        return error.what();
    }
    return "";
}

TEST(Wavelengths, DensityIntegratesToOneAndMatchesTheSamples)
{
    double integral = 0.0;
    for (int i = 0; i < 47000; ++i) {
        const double c = std::cosh(0.0072 * (360.005 + 0.01 * i - 538.0));
        integral += 0.01 * 0.0039398042 / (c * c);
    }
    EXPECT_NEAR(integral, 1.0, 1e-5);
    for (int i = 1; i < 1000; ++i) {
        // The density is 1 / (d lambda / d u).
        const float u = static_cast<float>(i) / 4000.0f, h = 1e-3f * 0.25f;
        const Wavelengths at = Wavelengths::sample_visible(u);
        const Wavelengths before = Wavelengths::sample_visible(std::max(0.0f, u - h)),
                          after = Wavelengths::sample_visible(std::min(u + h, 0.2499f));
        const float du = std::min(u + h, 0.2499f) - std::max(0.0f, u - h);
        for (int lane = 1; lane < 3; ++lane)
            EXPECT_NEAR(at.pdf[lane] * (after.lambda[lane] - before.lambda[lane]) / du, 1.0f, 2e-2f);
        const double c = std::cosh(0.0072 * (at.lambda[2] - 538.0));
        EXPECT_NEAR(at.pdf[2], 0.0039398042 / (c * c), 1e-8);
    }
}

TEST(Wavelengths, LanesAreStratifiedAndInRange)
{
    for (int i = 0; i < 1000; ++i) {
        const Wavelengths w = Wavelengths::sample_visible(to_unit_float(hash_words(1, i)));
        // The cumulative density puts one lane into each quarter.
        int lanes_in_quarter[4] = {0, 0, 0, 0};
        for (const float lambda : w.lambda) {
            const double low = std::tanh(0.0072 * (360.0 - 538.0)), high = std::tanh(0.0072 * (830.0 - 538.0));
            const double cumulative = (std::tanh(0.0072 * (lambda - 538.0)) - low) / (high - low);
            ++lanes_in_quarter[std::clamp(static_cast<int>(cumulative * 4.0), 0, 3)];
        }
        for (const int lanes : lanes_in_quarter) EXPECT_EQ(lanes, 1);
    }
    EXPECT_GE(Wavelengths::sample_visible(0.0f).lambda[0], 360.0f);
    EXPECT_LE(Wavelengths::sample_visible(one_minus_epsilon).lambda[0], 830.0f);
}

TEST(Wavelengths, MonteCarloXyzOfWhiteIsUnbiased)
{
    SpectrumPool pool;
    const SpectrumValue d65 = make_named(pool, "stdillum-D65");
    const auto& matching = cie_matching_functions();
    const uint32_t tables[3] = {pool.add_table(matching[0]), pool.add_table(matching[1]), pool.add_table(matching[2])};
    const Vec3 expected = xyz_of(pool, d65);
    const int n = 20000;
    for (int k = 0; k < 3; ++k) {
        SpectrumValue response;
        response.kind = SpectrumValue::Kind::table;
        response.table = tables[k];
        response.scale = 1.0f;
        double sum = 0.0, squares = 0.0;
        for (int i = 0; i < n; ++i) {
            const Wavelengths w = Wavelengths::sample_visible(to_unit_float(hash_words(2, i)));
            const Spectrum product = pool.evaluate(d65, w) * pool.evaluate(response, w);
            double estimate = 0.0;
            for (int lane = 0; lane < 4; ++lane) estimate += product[lane] / w.pdf[lane] / 4.0;
            sum += estimate;
            squares += estimate * estimate;
        }
        const double mean = sum / n;
        const double error = std::sqrt((squares / n - mean * mean) / n);
        EXPECT_NEAR(mean, expected[k], 3.0 * error);
        EXPECT_LT(error / mean, 5e-3);
    }
}

TEST(SpectrumPool, SharesEqualTables)
{
    SpectrumPool pool;
    const uint32_t a = pool.add_table(std::vector<float>(spectrum_table_size, 0.25f));
    const uint32_t b = pool.add_table(std::vector<float>(spectrum_table_size, 0.5f));
    EXPECT_NE(a, b);
    EXPECT_EQ(pool.add_table(std::vector<float>(spectrum_table_size, 0.25f)), a);
}

TEST(MakeSpectrum, GreysAreTheSameInBothModels)
{
    SpectrumPool pool;
    const Wavelengths rgb = Wavelengths::rgb(), spectral = Wavelengths::sample_visible(0.3f);
    const std::vector<float> lambdas = {300.0f, 900.0f}, values = {0.4f, 0.4f};
    for (const SpectrumValue& value :
         {make_constant(0.4f), make_albedo(pool, srgb(), Vec3(0.4f)), make_unbounded(pool, srgb(), Vec3(0.4f)),
          make_sampled(pool, lambdas, values, SpectrumRole::factor),
          make_sampled(pool, lambdas, values, SpectrumRole::index)})
        for (int lane = 0; lane < 4; ++lane) {
            EXPECT_NEAR(pool.evaluate(value, rgb)[lane], 0.4f, 1e-5f);
            EXPECT_NEAR(pool.evaluate(value, spectral)[lane], 0.4f, 1e-5f);
            EXPECT_NEAR(pool.evaluate(scaled(value, 3.0f), rgb)[lane], 1.2f, 3e-5f);
            EXPECT_NEAR(pool.evaluate(scaled(value, 3.0f), spectral)[lane], 1.2f, 3e-5f);
        }
}

TEST(MakeSpectrum, ColorsHaveTheirRgbUnderWhite)
{
    SpectrumPool pool;
    const Vec3 color(0.7f, 0.2f, 0.1f);
    for (const std::string_view name : color_space_names()) {
        const ColorSpace& space = color_space(name);
        const Vec3 mild = Vec3(0.4f) + color * 0.2f;
        const SpectrumValue light = make_illuminant(pool, space, mild * 5.0f);
        // Both models agree on the light's colour, in all spaces.
        expect_near(srgb_of_light(pool, light), light.rgb, 1e-4f * max_component(light.rgb));
        expect_near(light.rgb, to_srgb(space, mild * 5.0f) * cie_y_integral, 1e-3f);
    }
    const SpectrumValue unbounded = make_unbounded(pool, srgb(), color * 10.0f);
    EXPECT_FLOAT_EQ(unbounded.scale, 14.0f);
    expect_near(unbounded.rgb, color * 10.0f, 1e-5f);
    EXPECT_EQ(pool.evaluate(make_unbounded(pool, srgb(), Vec3(0.0f)), 500.0f), 0.0f);
    const SpectrumValue albedo = make_albedo(pool, srgb(), Vec3(2.0f, 0.5f, -1.0f));
    expect_near(albedo.rgb, Vec3(1.0f, 0.5f, 0.0f), 1e-6f);
}

TEST(MakeSpectrum, PhotometricScaleGivesUnitLuminance)
{
    SpectrumPool pool;
    const std::vector<float> lambdas = {400.0f, 700.0f}, values = {1.0f, 5.0f};
    for (const SpectrumValue& value :
         {make_constant(3.0f, SpectrumRole::light), make_blackbody(pool, 4500.0f), make_named(pool, "stdillum-F4"),
          make_sampled(pool, lambdas, values, SpectrumRole::light)}) {
        const SpectrumValue unit = scaled(value, photometric_scale(pool, value));
        EXPECT_NEAR(xyz_of(pool, unit).y, 1.0f, 1e-5f);
        EXPECT_NEAR(multiply(srgb().xyz_from_rgb, unit.rgb).y, 1.0f, 2e-2f);  // but for clamped negatives
    }
    // RGB lights keep the luminance of their RGB, in both models.
    const Vec3 rgb(2.0f, 1.0f, 0.5f);
    const SpectrumValue light = make_illuminant(pool, srgb(), rgb);
    const float scale = photometric_scale(pool, light);
    EXPECT_NEAR(scale, 1.0f / cie_y_integral, 1e-7f);
    expect_near(srgb_of_light(pool, scaled(light, scale)), rgb, 2e-4f);
    expect_near(scaled(light, scale).rgb, rgb, 1e-5f);
    EXPECT_EQ(photometric_scale(pool, make_constant(0.0f)), 0.0f);
}

TEST(MakeSpectrum, BlackbodyPeaksAtOne)
{
    SpectrumPool pool;
    const SpectrumValue visible = make_blackbody(pool, 5500.0f);
    EXPECT_NEAR(pool.evaluate(visible, blackbody_peak(5500.0f)), 1.0f, 1e-4f);
    const SpectrumValue warm = make_blackbody(pool, 2000.0f);
    EXPECT_NEAR(pool.evaluate(warm, 600.0f), blackbody(600.0f, 2000.0f) / blackbody(1448.886f, 2000.0f), 1e-6f);
    EXPECT_GT(warm.rgb.x, warm.rgb.y);
    EXPECT_GT(warm.rgb.y, warm.rgb.z);
    EXPECT_GE(warm.rgb.z, 0.0f);
    EXPECT_THROW(make_blackbody(pool, 0.0f), UserError);
}

TEST(MakeSpectrum, SellmeierIndicesMatchTheCatalogue)
{
    // n_F (486.13 nm), n_d (587.56 nm), n_C (656.27 nm); tables are linear within a nanometre.
    const struct {
        const char* name;
        float f, d, c;
    } glasses[] = {{"glass-BK7", 1.522376f, 1.516800f, 1.514322f},   {"glass-BAF10", 1.680000f, 1.670030f, 1.665778f},
                   {"glass-FK51A", 1.490557f, 1.486561f, 1.484797f}, {"glass-LASF9", 1.868984f, 1.850249f, 1.842554f},
                   {"glass-F5", 1.687495f, 1.672697f, 1.666610f},    {"glass-F10", 1.746481f, 1.728250f, 1.720848f},
                   {"glass-F11", 1.806454f, 1.784720f, 1.775988f},   {"fused-silica", 1.463126f, 1.458464f, 1.456367f},
                   {"sapphire", 1.775508f, 1.768172f, 1.764884f},    {"water", 1.337492f, 1.333403f, 1.331513f},
                   {"diamond", 2.435538f, 2.417486f, 2.409906f},     {"glass-F2", 1.632081f, 1.620040f, 1.615032f}};
    SpectrumPool pool;
    for (const auto& glass : glasses) {
        const SpectrumValue eta = make_named(pool, glass.name);
        EXPECT_NEAR(pool.evaluate(eta, 486.13f), glass.f, 5e-6f) << glass.name;
        EXPECT_NEAR(pool.evaluate(eta, 587.56f), glass.d, 5e-6f) << glass.name;
        EXPECT_NEAR(pool.evaluate(eta, 656.27f), glass.c, 5e-6f) << glass.name;
        EXPECT_LT(eta.rgb.x, eta.rgb.y);  // normal dispersion: red least
        EXPECT_LT(eta.rgb.y, eta.rgb.z);
        EXPECT_NEAR(eta.rgb.y, glass.d, 0.02f);
    }
}

TEST(MakeSpectrum, MetalsHaveTheirMeasuredValues)
{
    // Handbook values (Palik; Querry for brass) near 589 nm: n and k of Na D light.
    const struct {
        const char* name;
        float n, k;
    } metals[] = {
        {"Ag", 0.12f, 3.6f}, {"Al", 1.17f, 7.1f}, {"Au", 0.24f, 2.9f}, {"Cu", 0.5f, 2.6f}, {"CuZn", 0.46f, 3.15f}};
    SpectrumPool pool;
    for (const auto& metal : metals) {
        const std::string base = std::string("metal-") + metal.name;
        EXPECT_NEAR(pool.evaluate(make_named(pool, base + "-eta"), 589.3f), metal.n, 0.12f) << base;
        EXPECT_NEAR(pool.evaluate(make_named(pool, base + "-k"), 589.3f), metal.k, 0.35f) << base;
    }
    EXPECT_NEAR(pool.evaluate(make_named(pool, "metal-MgO-eta"), 589.3f), 1.737f, 0.01f);
    EXPECT_NEAR(pool.evaluate(make_named(pool, "metal-TiO2-eta"), 589.3f), 2.91f, 0.02f);
    // Gold is yellow: its reflectance at normal incidence falls from red to blue, also through the RGB indices.
    const Vec3 n = make_named(pool, "metal-Au-eta").rgb, k = make_named(pool, "metal-Au-k").rgb;
    const auto reflectance = [&](int i) { return (sqr(n[i] - 1.0f) + sqr(k[i])) / (sqr(n[i] + 1.0f) + sqr(k[i])); };
    EXPECT_GT(reflectance(0), 0.9f);
    EXPECT_LT(reflectance(2), 0.5f);
    EXPECT_GT(reflectance(0), reflectance(1));
    EXPECT_GT(reflectance(1), reflectance(2));
}

TEST(MakeSpectrum, EveryNameWorksAndOthersAreUserErrors)
{
    SpectrumPool pool;
    for (const std::string_view name : named_spectrum_names()) {
        const SpectrumValue value = make_named(pool, name);
        for (float lambda = 360.0f; lambda <= 830.0f; lambda += 23.5f)
            EXPECT_TRUE(std::isfinite(pool.evaluate(value, lambda)) && pool.evaluate(value, lambda) >= 0.0f) << name;
        EXPECT_TRUE(is_finite(value.rgb)) << name;
    }
    EXPECT_NE(message_of(pool, "metal-Au-etta").find("metal-Au-eta"), std::string::npos);
    EXPECT_NE(message_of(pool, "zzz").find("unknown spectrum 'zzz'"), std::string::npos);
}

TEST(MakeSpectrum, HintsKnowMetalsInWords)
{
    EXPECT_EQ(named_spectrum_hint("Gold"), "; did you mean 'metal-Au-eta' or 'metal-Au-k'?");
    EXPECT_EQ(named_spectrum_hint("metal-Aluminium-k"), "; did you mean 'metal-Al-k'?");
    EXPECT_EQ(named_spectrum_hint("METAL-CUZN-ETA"), "; did you mean 'metal-CuZn-eta'?");
    EXPECT_TRUE(named_spectrum_hint("metal-Ni-k").starts_with("; the metals are Ag, "));
    EXPECT_EQ(named_spectrum_hint("glass-BK8"), "; did you mean 'glass-BK7'?");
    EXPECT_EQ(named_spectrum_hint("metal-"), "");
    EXPECT_EQ(named_spectrum_hint(std::string(1000, 'x')), "");
}

TEST(MakeSpectrum, BadSamplesAreUserErrors)
{
    SpectrumPool pool;
    using List = std::vector<float>;
    const auto make = [&](const List& l, const List& v) { return make_sampled(pool, l, v, SpectrumRole::factor); };
    EXPECT_THROW(make({}, {}), UserError);
    EXPECT_THROW(make({400, 500}, {1}), UserError);
    EXPECT_THROW(make({500, 400}, {1, 1}), UserError);
    EXPECT_THROW(make({400, 400}, {1, 1}), UserError);
    EXPECT_THROW(make({400, 500}, {1, infinity}), UserError);
    EXPECT_EQ(pool.evaluate(make({400, 500}, {1, 1}), 501.5f), 0.0f);
}

TEST(SpectrumPool, PixelsAgreeWithConstants)
{
    SpectrumPool pool;
    const Wavelengths w = Wavelengths::sample_visible(0.15f), rgb = Wavelengths::rgb();
    const Vec3 color(0.6f, 0.4f, 0.25f);
    for (const bool prepared : {false, true}) {
        if (prepared) pool.prepare_rgb(srgb());
        const float tolerance = prepared ? 5e-3f : 1e-6f;
        const SpectrumValue values[] = {make_albedo(pool, srgb(), color), make_unbounded(pool, srgb(), color * 4.0f),
                                        make_illuminant(pool, srgb(), color * 4.0f)};
        const RgbUse uses[] = {RgbUse::albedo, RgbUse::unbounded, RgbUse::illuminant};
        for (int i = 0; i < 3; ++i) {
            const Vec3 pixel = color * (i == 0 ? 1.0f : 4.0f);
            for (const Wavelengths& at : {w, rgb}) {
                const Spectrum expected = pool.evaluate(values[i], at), found = pool.evaluate_rgb(uses[i], pixel, at);
                for (int lane = 0; lane < 4; ++lane)
                    EXPECT_NEAR(found[lane], expected[lane], tolerance * expected.max());
            }
            EXPECT_EQ(pool.evaluate_rgb(uses[i], Vec3(0.0f), w), Spectrum(0.0f));
            for (const float odd : {std::nanf(""), infinity, -infinity})
                for (const Vec3& bad : {Vec3(odd, 0.5f, 0.3f), Vec3(0.5f, odd, 0.3f), Vec3(0.5f, 0.3f, odd)})
                    for (const Wavelengths& at : {w, rgb}) EXPECT_TRUE(pool.evaluate_rgb(uses[i], bad, at).is_finite());
        }
    }
}

}  // namespace
}  // namespace dapple
