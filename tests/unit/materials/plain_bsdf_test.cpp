// Samplers, densities and values of the families without layers.
#include "dapple/sampling/warps.h"

#include "scatter_testing.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

using namespace dapple::testing;

constexpr TransportMode modes[] = {TransportMode::radiance, TransportMode::importance};

// Histogram of samples, and the share that was absorbed, against the density; the density integrates to the share kept;
// the mean weight is the integral of f |cos|.
TEST(PlainBsdf, SamplesFollowTheirDensityAndCarryTheAlbedo)
{
    const auto bsdfs = plain_bsdfs();
    const auto views = view_directions();
    const double threshold = 0.01 / double(bsdfs.size() * views.size());  // 1 % over all cases (Bonferroni)
    constexpr int count = 20000;
    Numbers numbers(1);
    for (const auto& [name, bsdf] : bsdfs)
        for (const Vec3& wo : views) {
            SCOPED_TRACE(name + " wo.z " + std::to_string(wo.z));
            std::vector<double> observed(SphereGrid::cells + 1), mean(SphereGrid::cells);
            double weight = 0.0, weight_squared = 0.0;
            for (int i = 0; i < count; ++i) {
                BsdfSample sample;
                const float u_lobe = numbers.next();
                if (!sample_bsdf(bsdf, wo, u_lobe, numbers.next_2d(), TransportMode::importance, sample)) {
                    observed[SphereGrid::cells] += 1.0;
                    continue;
                }
                observed[SphereGrid::cell(sample.wi)] += 1.0;
                weight += sample.weight[1];
                weight_squared += sqr(double(sample.weight[1]));
            }
            auto expected =
                integrate_cells([&](const Vec3& wi) { return pdf(bsdf, wo, wi, TransportMode::importance); });
            double total = 0.0;
            for (double& cell : expected) total += cell, cell *= count;
            EXPECT_LE(total, 1.0 + 2e-3);
            expected.push_back(std::max(0.0, 1.0 - total) * count);
            EXPECT_GT(chi_squared_p_value(observed, expected), threshold);

            const auto albedo_cells = integrate_cells(
                [&](const Vec3& wi) { return evaluate(bsdf, wo, wi, TransportMode::importance)[1] * std::fabs(wi.z); });
            double albedo = 0.0;
            for (const double cell : albedo_cells) albedo += cell;
            weight /= count;
            const double error = std::sqrt(std::max(0.0, weight_squared / count - weight * weight) / count);
            EXPECT_NEAR(weight, albedo, 5.0 * error + 2e-3);
            EXPECT_LE(albedo, 1.0 + 2e-3);
        }
}

TEST(PlainBsdf, WeightIsValueTimesCosineOverDensity)
{
    Numbers numbers(2);
    for (const auto& [name, bsdf] : plain_bsdfs())
        for (const Vec3& wo : view_directions())
            for (const TransportMode mode : modes) {
                SCOPED_TRACE(name + " wo.z " + std::to_string(wo.z));
                for (int i = 0; i < 200; ++i) {
                    BsdfSample sample;
                    const float u_lobe = numbers.next();
                    if (!sample_bsdf(bsdf, wo, u_lobe, numbers.next_2d(), mode, sample)) continue;
                    ASSERT_FALSE(sample.delta);
                    ASSERT_EQ(sample.transmission, wo.z * sample.wi.z < 0.0f);
                    // Grazing directions lose digits in the half vector, which a sharp lobe multiplies.
                    const float tolerance = 2e-3f + 1e-6f / std::fabs(sample.wi.z);
                    const float density = pdf(bsdf, wo, sample.wi, mode);
                    ASSERT_NEAR(sample.pdf / density, 1.0f, tolerance);
                    const Spectrum f = evaluate(bsdf, wo, sample.wi, mode);
                    for (int lane = 0; lane < Spectrum::lanes; ++lane)
                        ASSERT_NEAR(f[lane] * std::fabs(sample.wi.z) / density, sample.weight[lane],
                                    tolerance * sample.weight[lane]);
                }
            }
}

TEST(PlainBsdf, ReciprocityBetweenModes)
{
    Numbers numbers(3);
    for (const auto& [name, bsdf] : plain_bsdfs()) {
        SCOPED_TRACE(name);
        int compared = 0;
        for (int i = 0; i < 4000; ++i) {
            const Vec3 wo = numbers.direction();
            BsdfSample sample;
            const float u_lobe = numbers.next();
            if (!sample_bsdf(bsdf, wo, u_lobe, numbers.next_2d(), TransportMode::radiance, sample)) continue;
            if (std::fabs(wo.z) < 0.02f || std::fabs(sample.wi.z) < 0.02f) continue;
            const float radiance = evaluate(bsdf, wo, sample.wi, TransportMode::radiance)[1];
            const float importance = evaluate(bsdf, sample.wi, wo, TransportMode::importance)[1];
            ASSERT_NEAR(radiance, importance, 2e-3f * importance);
            // Within one mode: f for reflection, f eta_i^2-weighted for refraction (Veach 1997, eq. 5.14).
            const float back = evaluate(bsdf, sample.wi, wo, TransportMode::radiance)[1];
            ASSERT_NEAR(radiance * sqr(sample.eta), back, 2e-3f * back);
            ++compared;
        }
        EXPECT_GT(compared, 2000);
    }
}

TEST(PlainBsdf, SmoothDielectricKeepsAllEnergy)
{
    for (const float eta : {1.5f, 0.7f, 1.0f})
        for (const Vec3& wo : view_directions()) {
            const Bsdf bsdf = make_dielectric(eta, {0.0f, 0.0f});
            EXPECT_TRUE(bsdf.is_delta());
            double radiance = 0.0, importance = 0.0;
            constexpr int count = 4096;
            for (int i = 0; i < count; ++i) {
                const float u_lobe = (i + 0.5f) / count;
                BsdfSample a, b;
                ASSERT_TRUE(sample_bsdf(bsdf, wo, u_lobe, {0.5f, 0.5f}, TransportMode::importance, a));
                ASSERT_TRUE(sample_bsdf(bsdf, wo, u_lobe, {0.5f, 0.5f}, TransportMode::radiance, b));
                ASSERT_TRUE(a.delta);
                ASSERT_EQ(a.pdf, 0.0f);
                importance += a.weight[0];
                // Snell's law, and radiance that is scaled by the square of the index.
                const float sin_o = std::hypot(wo.x, wo.y), sin_i = std::hypot(a.wi.x, a.wi.y);
                ASSERT_NEAR(sin_o, a.eta * sin_i, 1e-5f);
                ASSERT_NEAR(b.weight[0] * sqr(b.eta), a.weight[0], 1e-5f);
                radiance += b.weight[0] * sqr(b.eta);
                if (eta == 1.0f) {
                    ASSERT_TRUE(a.transmission);
                    ASSERT_LT(length(a.wi + wo), 1e-6f);
                }
            }
            EXPECT_DOUBLE_EQ(importance, count);
            EXPECT_NEAR(radiance, count, 1e-3 * count);
        }
}

// Rough glass loses only what Smith's model masks: nearly nothing at low roughness.
TEST(PlainBsdf, SlightlyRoughDielectricIsNearlyLossless)
{
    Numbers numbers(4);
    const Bsdf bsdf = make_dielectric(1.5f, {0.05f, 0.05f});
    double sum = 0.0;
    constexpr int count = 20000;
    for (int i = 0; i < count; ++i) {
        BsdfSample sample;
        const float u_lobe = numbers.next();
        if (sample_bsdf(bsdf, normalize(Vec3(0.5f, 0.2f, 1.0f)), u_lobe, numbers.next_2d(), TransportMode::importance,
                        sample))
            sum += sample.weight[0];
    }
    EXPECT_NEAR(sum / count, 1.0, 0.005);
    EXPECT_LE(sum / count, 1.0 + 1e-6);
}

TEST(PlainBsdf, ThinDielectricIsAPlateWithAllInternalReflections)
{
    Bsdf bsdf = make_dielectric(1.5f, {});
    bsdf.kind = BsdfKind::thin_dielectric;
    // Reference tables, section E: 0.076923 for n = 1.5.
    BsdfSample sample;
    ASSERT_TRUE(sample_bsdf(bsdf, {0, 0, 1}, 0.0769f, {0.5f, 0.5f}, TransportMode::radiance, sample));
    EXPECT_FALSE(sample.transmission);
    EXPECT_EQ(sample.weight[0], 1.0f);
    ASSERT_TRUE(sample_bsdf(bsdf, {0, 0, 1}, 0.07693f, {0.5f, 0.5f}, TransportMode::radiance, sample));
    EXPECT_TRUE(sample.transmission);
    EXPECT_EQ(sample.wi, Vec3(0, 0, -1));
    EXPECT_EQ(sample.weight[0], 1.0f);
    EXPECT_EQ(sample.eta, 1.0f);
}

// Veach 1997, eq. 5.19, from its definition; and the sampler's weight carries the same factor.
TEST(PlainBsdf, ShadingNormalsWeighImportance)
{
    Numbers numbers(5);
    for (auto [name, bsdf] : plain_bsdfs()) {
        SCOPED_TRACE(name);
        bsdf.frame = Frame(normalize(Vec3(0.3f, -0.2f, 1.0f)));
        const Vec3 ns = bsdf.frame.n, ng = bsdf.n_geometric;
        for (int i = 0; i < 300; ++i) {
            const Vec3 wo = numbers.direction();
            BsdfSample sample, radiance_sample;
            const float u_lobe = numbers.next();
            const Vec2 u = numbers.next_2d();
            if (!sample_bsdf(bsdf, wo, u_lobe, u, TransportMode::importance, sample)) continue;
            ASSERT_TRUE(sample_bsdf(bsdf, wo, u_lobe, u, TransportMode::radiance, radiance_sample));
            const Vec3 wi = sample.wi;
            const float factor = std::fabs(dot(wo, ns) * dot(wi, ng) / (dot(wo, ng) * dot(wi, ns)));
            ASSERT_NEAR(sample.weight[1], radiance_sample.weight[1] * sqr(sample.eta) * factor,
                        1e-3f * sample.weight[1]);
            const float importance = evaluate(bsdf, wo, wi, TransportMode::importance)[1];
            const float radiance = evaluate(bsdf, wo, wi, TransportMode::radiance)[1];
            ASSERT_NEAR(importance, radiance * sqr(sample.eta) * factor, 1e-3f * importance);
        }
    }
}

TEST(PlainBsdf, NothingIsEverNaN)
{
    Numbers numbers(6);
    auto bsdfs = plain_bsdfs();
    bsdfs.push_back({"nearly smooth glass", make_dielectric(1.5f, {1e-3f, 0.0f})});
    bsdfs.push_back({"nearly index-matched", make_dielectric(1.00001f, {0.3f, 0.3f})});
    bsdfs.push_back({"very rough", make_dielectric(3.0f, {5.0f, 0.001f})});
    bsdfs.push_back({"smooth coat", make_coated_diffuse(1.5f, {0, 0}, 0.01f, Spectrum(0.5f))});
    bsdfs.push_back({"rough coat on metal", make_coated_conductor({0.1f, 0.3f}, {0.2f, 0.001f})});
    const float small[] = {0.0f, 1e-20f, 1e-8f, 1e-4f, -1e-7f, -1e-30f};
    for (auto [name, bsdf] : bsdfs) {
        SCOPED_TRACE(name);
        for (int i = 0; i < 2000; ++i) {
            bsdf.frame = i % 2 ? Frame(normalize(Vec3(0.4f, 0.1f, 1.0f))) : Frame();
            // Directions in, or nearly in, one of the two tangent planes.
            const auto direction = [&] {
                Vec3 w = numbers.direction();
                if (numbers.next() < 0.5f) w = normalize(Vec3(w.x, w.y, small[int(numbers.next() * 6)]));
                return numbers.next() < 0.5f ? bsdf.frame.to_world(w) : w;
            };
            const Vec3 wo = direction(), wi = numbers.next() < 0.1f ? -wo : direction();
            const TransportMode mode = modes[i / 2 % 2];
            ASSERT_TRUE(evaluate(bsdf, wo, wi, mode).is_finite());
            ASSERT_TRUE(std::isfinite(pdf(bsdf, wo, wi, mode)));
            BsdfSample sample;
            const float u_lobe = numbers.next();
            const Vec2 u(numbers.next() < 0.2f ? 0.0f : numbers.next(),
                         numbers.next() < 0.2f ? one_minus_epsilon : numbers.next());
            if (!sample_bsdf(bsdf, wo, u_lobe, u, mode, sample)) continue;
            ASSERT_TRUE(sample.weight.is_finite());
            ASSERT_GE(sample.weight.min(), 0.0f);
            ASSERT_TRUE(std::isfinite(sample.pdf));
            ASSERT_NEAR(length(sample.wi), 1.0f, 1e-5f);
        }
    }
}

TEST(PlainBsdf, BothWaysAreTheSeparateCalls)
{
    Numbers numbers(12);
    int scattered = 0;
    for (const auto& [name, bsdf] : plain_bsdfs())
        for (const TransportMode mode : modes)
            for (int i = 0; i < 200; ++i) {
                SCOPED_TRACE(name);
                const Vec3 wo = sample_uniform_sphere(numbers.next_2d()), wi = sample_uniform_sphere(numbers.next_2d());
                const BsdfBothWays both = evaluate_both_ways(bsdf, wo, wi, mode);
                EXPECT_EQ(both.f, evaluate(bsdf, wo, wi, mode));
                if (both.f.is_black()) continue;
                ++scattered;
                EXPECT_EQ(both.pdf, pdf(bsdf, wo, wi, mode));
                EXPECT_EQ(both.pdf_reverse, pdf(bsdf, wi, wo, mode));
                EXPECT_GT(both.pdf_reverse, 0.0f);
            }
    EXPECT_GT(scattered, 1000);
}

}  // namespace
}  // namespace dapple
