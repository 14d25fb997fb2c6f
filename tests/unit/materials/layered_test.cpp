// The layered random walk. Its values are estimates, so the tests look at means over many hashes and directions.
#include "dapple/materials/bsdf.h"

#include "scatter_testing.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

using namespace dapple::testing;

struct Estimate {
    double mean = 0.0;
    double error = 0.0;  // standard deviation of the mean
};

template <class Draw>
Estimate average(int count, const Draw& draw)
{
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < count; ++i) {
        const double x = draw(i);
        sum += x;
        squares += x * x;
    }
    const double mean = sum / count;
    return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean) / count)};
}

// Mean of f over the seeds.
Estimate mean_f(Bsdf bsdf, const Vec3& wo, const Vec3& wi, TransportMode mode, int count = 20000)
{
    return average(count, [&](int i) {
        bsdf.layer_seed = i;
        return double(evaluate(bsdf, wo, wi, mode)[1]);
    });
}

Estimate albedo_of_samples(const Bsdf& bsdf, const Vec3& wo, TransportMode mode, int count = 20000)
{
    Numbers numbers(11);
    return average(count, [&](int) {
        BsdfSample sample;
        const float u_lobe = numbers.next();
        return sample_bsdf(bsdf, wo, u_lobe, numbers.next_2d(), mode, sample) ? double(sample.weight[1]) : 0.0;
    });
}

// The integral of f |cos| over the hemisphere by uniform directions; delta lobes are not in it.
Estimate albedo_of_values(Bsdf bsdf, const Vec3& wo, TransportMode mode, int count = 40000)
{
    Numbers numbers(12);
    return average(count, [&](int i) {
        bsdf.layer_seed = i;
        Vec3 wi = numbers.direction();
        if (wi.z * wo.z < 0.0f) wi.z = -wi.z;
        return double(evaluate(bsdf, wo, wi, mode)[1]) * std::fabs(wi.z) * 2.0 * pi;
    });
}

std::vector<NamedBsdf> coats()
{
    Bsdf foggy = make_coated_diffuse(1.5f, {0.3f, 0.3f}, 0.5f, Spectrum(0.7f));
    foggy.layer_albedo = Spectrum(0.8f);
    foggy.layer_g = 0.5f;
    Bsdf foggy_metal = make_coated_conductor({0.0f, 0.0f}, {0.3f, 0.3f});
    foggy_metal.layer_thickness = 0.3f;
    foggy_metal.layer_albedo = Spectrum(0.9f);
    foggy_metal.layer_g = -0.3f;
    return {{"smooth coat", make_coated_diffuse(1.5f, {0, 0}, 0.01f, Spectrum(0.6f))},
            {"rough coat", make_coated_diffuse(1.5f, {0.3f, 0.3f}, 0.01f, Spectrum(0.6f))},
            {"rough coat with fog", foggy},
            {"smooth coat on rough metal", make_coated_conductor({0, 0}, {0.3f, 0.3f})},
            {"rough coat on rough metal", make_coated_conductor({0.2f, 0.2f}, {0.3f, 0.3f})},
            {"rough coat on smooth metal", make_coated_conductor({0.3f, 0.3f}, {0, 0})},
            {"smooth coat on metal with fog", foggy_metal}};
}

TEST(Layered, CoatOfEqualIndexIsNoCoat)
{
    const Vec3 wo = normalize(Vec3(0.4f, 0.2f, 0.8f)), wi = normalize(Vec3(-0.3f, 0.5f, 0.6f));
    const Bsdf bsdf = make_coated_diffuse(1.0f, {0, 0}, 0.0f, Spectrum(0.6f));
    const Estimate f = mean_f(bsdf, wo, wi, TransportMode::radiance, 100);
    EXPECT_NEAR(f.mean, 0.6 / pi, 1e-5);
    EXPECT_NEAR(pdf(bsdf, wo, wi, TransportMode::radiance), 0.1f * 0.5f * inv_pi + 0.9f * wi.z * inv_pi, 1e-5f);
    EXPECT_NEAR(albedo_of_samples(bsdf, wo, TransportMode::radiance, 100).mean, 0.6, 1e-5);
}

// A smooth coat over a Lambertian base in closed form: f = T(wo) T(wi) / (n^2 pi) * r / (1 - r Fd) for a thin coat, Fd
// the internal diffuse reflectance (section E of the reference tables; Saunderson 1942).
TEST(Layered, SmoothCoatOverDiffuseMatchesTheClosedForm)
{
    const float n = 1.5f, r = 0.5f, internal = 0.596346f;
    const Vec3 wo = normalize(Vec3(0.4f, 0.2f, 0.8f)), wi = normalize(Vec3(-0.3f, 0.5f, 0.4f));
    const auto transmitted = [&](const Vec3& w) {
        const double c = w.z, t = std::sqrt(1.0 - (1.0 - c * c) / (n * n));
        return 1.0 - 0.5 * (sqr((n * c - t) / (n * c + t)) + sqr((c - n * t) / (c + n * t)));
    };
    Bsdf bsdf = make_coated_diffuse(n, {0, 0}, 0.0f, Spectrum(r));
    bsdf.layer_max_depth = 100;
    const double expected = transmitted(wo) * transmitted(wi) / (n * n * pi) * r / (1.0 - r * internal);
    for (const TransportMode mode : {TransportMode::radiance, TransportMode::importance}) {
        const Estimate f = mean_f(bsdf, wo, wi, mode);
        EXPECT_NEAR(f.mean, expected, 4.0 * f.error + 1e-4 * expected);
        EXPECT_LT(f.error, 0.01 * expected);
    }
    // Both sides look alike.
    EXPECT_EQ(evaluate(bsdf, -wo, -wi, TransportMode::radiance), evaluate(bsdf, wo, wi, TransportMode::radiance));
    EXPECT_EQ(evaluate(bsdf, wo, -wi, TransportMode::radiance), Spectrum());
}

TEST(Layered, WhiteBaseUnderAClearCoatLosesNothing)
{
    for (const Roughness roughness : {Roughness{0, 0}, Roughness{0.02f, 0.02f}}) {
        Bsdf bsdf = make_coated_diffuse(1.5f, roughness, 0.0f, Spectrum(1.0f));
        bsdf.layer_max_depth = 255;
        for (const Vec3& wo : {Vec3(0, 0, 1), normalize(Vec3(0.6f, 0.3f, -0.7f))}) {
            const Estimate albedo = albedo_of_samples(bsdf, wo, TransportMode::importance);
            // The rough coat loses the light that its facets would reflect a second time.
            EXPECT_NEAR(albedo.mean, 1.0, roughness.smooth() ? 4.0 * albedo.error + 1e-4 : 0.02);
            EXPECT_LE(albedo.mean, 1.0 + 4.0 * albedo.error);
        }
    }
}

TEST(Layered, SamplesAndValuesAgreeOnTheAlbedo)
{
    for (const auto& [name, bsdf] : coats()) {
        SCOPED_TRACE(name);
        for (const Vec3& wo : {normalize(Vec3(0.3f, 0.1f, 1.0f)), normalize(Vec3(-0.9f, 0.5f, -0.4f))}) {
            Estimate samples = albedo_of_samples(bsdf, wo, TransportMode::radiance);
            const Estimate values = albedo_of_values(bsdf, wo, TransportMode::radiance);
            // Delta lobes are only in the samples.
            Numbers numbers(11);
            const Estimate delta = average(20000, [&](int) {
                BsdfSample sample;
                const float u_lobe = numbers.next();
                return sample_bsdf(bsdf, wo, u_lobe, numbers.next_2d(), TransportMode::radiance, sample) && sample.delta
                           ? double(sample.weight[1])
                           : 0.0;
            });
            const double error = std::hypot(samples.error, values.error);
            EXPECT_NEAR(samples.mean - delta.mean, values.mean, 4.0 * error);
            EXPECT_LT(error, 0.03 * samples.mean);
            EXPECT_LE(samples.mean, 1.0 + 4.0 * samples.error);
        }
    }
}

// Not only the total: the directions of samples, weighted, follow f |cos|.
TEST(Layered, WeightedSamplesFollowTheValues)
{
    constexpr int bands = 6, count = 60000;
    for (const auto& [name, bsdf] : coats()) {
        SCOPED_TRACE(name);
        const Vec3 wo = normalize(Vec3(0.5f, 0.0f, 0.8f));
        // Bands by side (towards the mirror direction or away from it) and height.
        const auto band = [](const Vec3& w) { return (w.x < 0.0f ? 0 : 3) + std::min(2, int(3.0f * w.z)); };
        double from_samples[bands] = {}, from_values[bands] = {}, variance[bands] = {};
        Numbers numbers(13);
        Bsdf seeded = bsdf;
        for (int i = 0; i < count; ++i) {
            seeded.layer_seed = i;
            BsdfSample sample;
            const float u_lobe = numbers.next();
            if (sample_bsdf(seeded, wo, u_lobe, numbers.next_2d(), TransportMode::radiance, sample) && !sample.delta) {
                from_samples[band(sample.wi)] += sample.weight[1];
                variance[band(sample.wi)] += sqr(double(sample.weight[1]));
            }
            Vec3 wi = numbers.direction();
            wi.z = std::fabs(wi.z);
            const double value = double(evaluate(seeded, wo, wi, TransportMode::radiance)[1]) * wi.z * 2.0 * pi;
            from_values[band(wi)] += value;
            variance[band(wi)] += value * value;
        }
        for (int i = 0; i < bands; ++i)
            EXPECT_NEAR(from_samples[i] / count, from_values[i] / count, 4.5 * std::sqrt(variance[i]) / count) << i;
    }
}

TEST(Layered, ReciprocalAndTheSameInBothModesOnAverage)
{
    const Vec3 wo = normalize(Vec3(0.4f, 0.2f, 0.8f)), wi = normalize(Vec3(-0.5f, 0.3f, 0.4f));
    for (const auto& [name, bsdf] : coats()) {
        SCOPED_TRACE(name);
        const Estimate forward = mean_f(bsdf, wo, wi, TransportMode::radiance);
        const Estimate backward = mean_f(bsdf, wi, wo, TransportMode::importance);
        const double error = std::hypot(forward.error, backward.error);
        EXPECT_NEAR(forward.mean, backward.mean, 4.0 * error);
        EXPECT_LT(error, 0.05 * forward.mean);
    }
}

// pbrt's weights change f of rough coats over rough bases and nothing else: it is brighter than what its sampler
// yields. Over a base whose delta leaves one strategy only, as where the coat is smooth, there is nothing to weigh.
TEST(Layered, WeightsOfPbrtBrightenTheValuesOfRoughCoatsAlone)
{
    const Vec3 wo = normalize(Vec3(0.5f, 0.0f, 0.8f)), wi = normalize(Vec3(-0.5f, 0.3f, 0.4f));
    for (const auto& [name, bsdf] : coats()) {
        SCOPED_TRACE(name);
        Bsdf as_pbrt = bsdf;
        as_pbrt.pbrt_coat_weights = true;
        const bool weighed =
            !bsdf.roughness.smooth() && (bsdf.kind == BsdfKind::coated_diffuse || !bsdf.base_roughness.smooth());
        const double ours = albedo_of_values(bsdf, wo, TransportMode::radiance, 10000).mean;
        const double theirs = albedo_of_values(as_pbrt, wo, TransportMode::radiance, 10000).mean;
        if (weighed)
            EXPECT_GT(theirs, 1.01 * ours);
        else
            EXPECT_EQ(theirs, ours);
        EXPECT_LT(theirs, 1.15 * ours);
        EXPECT_EQ(pdf(as_pbrt, wo, wi, TransportMode::radiance), pdf(bsdf, wo, wi, TransportMode::radiance));
        EXPECT_EQ(albedo_of_samples(as_pbrt, wo, TransportMode::radiance, 1000).mean,
                  albedo_of_samples(bsdf, wo, TransportMode::radiance, 1000).mean);
    }
}

TEST(Layered, DensityIsAFunctionOfTheDirectionsAndIntegratesToOneAtMost)
{
    Numbers numbers(14);
    for (auto [name, bsdf] : coats()) {
        SCOPED_TRACE(name);
        bsdf.frame = Frame(normalize(Vec3(0.2f, 0.3f, 1.0f)));
        for (int i = 0; i < 200; ++i) {
            const Vec3 wo = numbers.direction();
            BsdfSample sample;
            const float u_lobe = numbers.next();
            if (!sample_bsdf(bsdf, wo, u_lobe, numbers.next_2d(), TransportMode::radiance, sample)) continue;
            if (sample.delta) {
                ASSERT_EQ(sample.pdf, 0.0f);
                continue;
            }
            ASSERT_EQ(sample.pdf, pdf(bsdf, wo, sample.wi, TransportMode::radiance));
            ASSERT_GT(sample.pdf, 0.0f);
            const Spectrum once = evaluate(bsdf, wo, sample.wi, TransportMode::radiance);
            ASSERT_EQ(once, evaluate(bsdf, wo, sample.wi, TransportMode::radiance));
        }
        bsdf.frame = Frame();
        for (const Vec3& wo : {normalize(Vec3(0.3f, 0.1f, 1.0f)), normalize(Vec3(-0.9f, 0.5f, 0.4f))}) {
            const Estimate integral = average(40000, [&](int i) {
                bsdf.layer_seed = i;
                return 4.0 * pi * pdf(bsdf, wo, numbers.direction(), TransportMode::radiance);
            });
            EXPECT_LE(integral.mean, 1.0 + 4.0 * integral.error + 0.02);
            EXPECT_GT(integral.mean, 0.4);
        }
    }
}

TEST(Layered, SmoothCoatOnMirrorIsADelta)
{
    Bsdf bsdf = make_coated_conductor({0, 0}, {0, 0});
    EXPECT_TRUE(bsdf.is_delta());
    const Vec3 wo = normalize(Vec3(0.4f, 0.2f, 0.8f));
    Numbers numbers(15);
    for (int i = 0; i < 100; ++i) {
        BsdfSample sample;
        const float u_lobe = numbers.next();
        if (!sample_bsdf(bsdf, wo, u_lobe, numbers.next_2d(), TransportMode::radiance, sample)) continue;
        ASSERT_TRUE(sample.delta);
        ASSERT_LT(length(sample.wi - Vec3(-wo.x, -wo.y, wo.z)), 1e-5f);
    }
    bsdf.layer_albedo = Spectrum(0.5f);
    EXPECT_FALSE(bsdf.is_delta());
}

}  // namespace
}  // namespace dapple
