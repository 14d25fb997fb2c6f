#include "dapple/density/irradiance_cache.h"

#include "dapple/math/hash.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

using Answer = IrradianceCache::Answer;

const Box3 bounds(Vec3(-10, -10, -10), Vec3(10, 10, 10));

CacheRecord record_at(const Vec3& p, float reach)
{
    CacheRecord record;
    record.position = p;
    record.reach = reach;
    record.min_radius = 0.01f;
    record.max_radius = 1.0f;
    return record;
}

HemisphereIrradiance value(float e, float slope_x = 0.0f)
{
    HemisphereIrradiance v;
    v.value = Spectrum(e);
    v.translation_x = Spectrum(slope_x);
    return v;
}

TEST(IrradianceCache, WeighsByDistanceAndNormal)
{
    IrradianceCache cache(bounds, 1, 0.5f);
    cache.add(record_at(Vec3(0), 1.0f), {value(1.0f)});
    const Vec3 up(0, 0, 1);
    EXPECT_EQ(cache.weight(0, Vec3(0), up), 1.0f);
    EXPECT_NEAR(cache.weight(0, Vec3(0.25f, 0, 0), up), 0.5f, 1e-6f);
    EXPECT_EQ(cache.weight(0, Vec3(0.5f, 0, 0), up), 0.0f);
    EXPECT_EQ(cache.weight(0, Vec3(0), -up), 0.0f);
    const float angle = 10.0f * pi / 180.0f;
    const Vec3 turned(std::sin(angle), 0, std::cos(angle));
    const float expected = 1.0f - std::sqrt((1.0f - std::cos(angle)) / (1.0f - std::cos(25.0f * pi / 180.0f)));
    EXPECT_NEAR(cache.weight(0, Vec3(0), turned), expected, 1e-4f);
    // A point below the record's plane may see what it does not.
    EXPECT_EQ(cache.weight(0, Vec3(0, 0, -0.1f), up), 0.0f);
    EXPECT_GT(cache.weight(0, Vec3(0, 0, 0.1f), up), 0.0f);
}

TEST(IrradianceCache, ExtrapolatesAndInterpolates)
{
    IrradianceCache cache(bounds, 2, 0.5f);
    cache.add(record_at(Vec3(0), 1.0f), {value(1.0f, 0.5f), value(3.0f)});
    cache.add(record_at(Vec3(0.4f, 0, 0), 1.0f), {value(1.2f, 0.5f), value(3.0f)});
    Spectrum e;
    // Both records describe the same plane 1 + x / 2.
    for (float x : {-0.4f, 0.0f, 0.1f, 0.2f, 0.6f}) {
        ASSERT_EQ(cache.look_up(Vec3(x, 0.05f, 0), Vec3(0, 0, 1), 0, e), Answer::value);
        EXPECT_NEAR(e[2], 1.0f + 0.5f * x, 1e-5f);
        ASSERT_EQ(cache.look_up(Vec3(x, 0.05f, 0), Vec3(0, 0, 1), 1, e), Answer::value);
        EXPECT_NEAR(e[0], 3.0f, 1e-5f);
    }
    EXPECT_EQ(cache.look_up(Vec3(2, 0, 0), Vec3(0, 0, 1), 0, e), Answer::none);
    // What would fall below zero is black.
    IrradianceCache steep(bounds, 1, 0.5f);
    steep.add(record_at(Vec3(0), 1.0f), {value(1.0f, -10.0f)});
    ASSERT_EQ(steep.look_up(Vec3(0.3f, 0, 0), Vec3(0, 0, 1), 0, e), Answer::value);
    EXPECT_EQ(e[0], 0.0f);
}

TEST(IrradianceCache, RotationFollowsItsConvention)
{
    IrradianceCache cache(bounds, 1, 0.5f);
    HemisphereIrradiance v = value(1.0f);
    v.rotation_y = Spectrum(2.0f);
    cache.add(record_at(Vec3(0), 1.0f), {v});
    Spectrum e;
    const Frame frame;  // x, y, z
    const float angle = 0.1f;
    const Vec3 turned = frame.s * std::sin(angle) + frame.n * std::cos(angle);
    ASSERT_EQ(cache.look_up(Vec3(0), turned, 0, e), Answer::value);
    EXPECT_NEAR(e[0], 1.0f + 2.0f * std::sin(angle), 1e-5f);
}

TEST(IrradianceCache, NeighboursClampOneAnother)
{
    const Vec3 up(0, 0, 1);
    for (const bool small_first : {false, true}) {
        IrradianceCache cache(bounds, 1, 0.5f);
        const CacheRecord small = record_at(Vec3(0.3f, 0, 0), 0.1f), wide = record_at(Vec3(0), 2.0f);
        cache.add(small_first ? small : wide, {value(1.0f)});
        cache.add(small_first ? wide : small, {value(1.0f)});
        // The wide one reaches no farther than 0.1 + 0.3: a radius of 0.2.
        const size_t index = small_first ? 1 : 0;
        EXPECT_GT(cache.weight(index, Vec3(-0.19f, 0, 0), up), 0.0f) << small_first;
        EXPECT_EQ(cache.weight(index, Vec3(-0.21f, 0, 0), up), 0.0f) << small_first;
    }
}

TEST(IrradianceCache, LeavesUnevenPlacesToGathering)
{
    IrradianceCache cache(bounds, 1, 0.5f);
    cache.add(record_at(Vec3(0), 0.001f), {value(1.0f)});
    Spectrum e;
    EXPECT_EQ(cache.look_up(Vec3(0.005f, 0, 0), Vec3(0, 0, 1), 0, e), Answer::gather);
    EXPECT_EQ(cache.look_up(Vec3(0.015f, 0, 0), Vec3(0, 0, 1), 0, e), Answer::none);
    EXPECT_EQ(cache.size(), 1u);
    EXPECT_EQ(cache.serving(), 0u);
}

// The octree finds what a look through all records finds.
TEST(IrradianceCache, FindsAllRecordsThatServe)
{
    IrradianceCache cache(bounds, 1, 0.3f);
    constexpr size_t count = 400;
    for (size_t i = 0; i < count; ++i) {
        const auto f = [&](uint64_t k) { return 2.0f * to_unit_float(hash_words(uint64_t(i), k)) - 1.0f; };
        CacheRecord record = record_at(Vec3(9 * f(1), 9 * f(2), 0.1f * f(3)), std::exp(3.0f * f(4)));
        record.max_radius = 3.0f;
        cache.add(record, {value(1.0f + static_cast<float>(i))});
    }
    int served = 0;
    for (uint64_t q = 0; q < 2000; ++q) {
        const auto f = [&](uint64_t k) { return 2.0f * to_unit_float(hash_words(q, k + 10)) - 1.0f; };
        const Vec3 p(9.9f * f(1), 9.9f * f(2), 0.0f);
        double sum = 0.0, weights = 0.0;
        for (size_t i = 0; i < count; ++i) {
            const float w = cache.weight(i, p, Vec3(0, 0, 1));
            sum += double(w) * (1.0 + double(i));
            weights += w;
        }
        Spectrum e;
        const Answer answer = cache.look_up(p, Vec3(0, 0, 1), 0, e);
        ASSERT_EQ(answer == Answer::value, weights > 0.0);
        if (answer != Answer::value) continue;
        ++served;
        EXPECT_NEAR(e[0], sum / weights, 1e-3 * sum / weights);
    }
    EXPECT_GT(served, 100);
}

}  // namespace
}  // namespace dapple
