#include "dapple/image/metrics.h"

#include "dapple/base/error.h"

#include <gtest/gtest.h>

#include <cmath>

namespace dapple {
namespace {

Image constant(int width, int height, const Vec3& rgb)
{
    Image image(width, height, 3);
    for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = rgb[static_cast<int>(i % 3)];
    return image;
}

TEST(Metrics, IdenticalImagesDoNotDiffer)
{
    const Image image = constant(4, 3, {0.5f, 2.0f, 7.0f});
    const ImageComparison result = compare_images(image, image);
    EXPECT_EQ(result.mse, 0.0);
    EXPECT_EQ(result.relative_mse, 0.0);
    EXPECT_EQ(result.mae, 0.0);
    EXPECT_EQ(result.max_error, 0.0);
    EXPECT_EQ(result.non_finite, 0u);
    EXPECT_EQ(result.mean_ratio, (std::vector<double>{1.0, 1.0, 1.0}));
}

TEST(Metrics, ValuesByHand)
{
    Image test(2, 1, 1), reference(2, 1, 1);
    test.pixels = {3.0f, 0.0f};
    reference.pixels = {1.0f, 0.5f};
    const ImageComparison result = compare_images(test, reference);
    EXPECT_DOUBLE_EQ(result.mean_test[0], 1.5);
    EXPECT_DOUBLE_EQ(result.mean_reference[0], 0.75);
    EXPECT_DOUBLE_EQ(result.mean_ratio[0], 2.0);
    EXPECT_DOUBLE_EQ(result.mse, (4.0 + 0.25) / 2);
    EXPECT_DOUBLE_EQ(result.relative_mse, (4.0 / 1.01 + 0.25 / 0.26) / 2);
    EXPECT_DOUBLE_EQ(result.mae, 1.25);
    EXPECT_DOUBLE_EQ(result.max_error, 2.0);

    CompareOptions options;
    options.clamp = 2.0f;
    EXPECT_DOUBLE_EQ(compare_images(test, reference, options).mae, 0.75);
    EXPECT_EQ(absolute_difference(test, reference).pixels, (std::vector<float>{2.0f, 0.5f}));
    EXPECT_EQ(absolute_difference(test, reference, options).pixels, (std::vector<float>{1.0f, 0.5f}));
    Image negative(1, 1, 1);
    negative.pixels[0] = -5.0f;
    EXPECT_DOUBLE_EQ(compare_images(negative, Image(1, 1, 1), options).mae, 2.0) << "far out of gamut";

    const Image sign = signed_difference(test, reference, 4.0f);
    EXPECT_EQ(sign.pixels, (std::vector<float>{0.5f, 0.0f, 0.0f, 0.0f, 0.0f, 0.125f}));
}

TEST(Metrics, DifferencesAreShownOnARoundScaleThatMostKeepTo)
{
    const Image reference(20, 10, 3);
    Image test = constant(20, 10, Vec3(0.3f));
    EXPECT_FLOAT_EQ(difference_scale(test, reference), 0.5f);
    EXPECT_FLOAT_EQ(difference_scale(constant(20, 10, Vec3(120.0f)), reference), 200.0f);
    test.at(0, 0, 0) = 1e6f;
    EXPECT_FLOAT_EQ(difference_scale(test, reference), 0.5f) << "one pixel of 200";
    Image lone = reference;
    lone.at(3, 3, 0) = lone.at(3, 3, 1) = lone.at(3, 3, 2) = -0.07f;
    EXPECT_FLOAT_EQ(difference_scale(lone, reference), 0.1f);
    lone.at(0, 0, 0) = NAN;
    EXPECT_FLOAT_EQ(difference_scale(lone, reference), 0.1f);
    EXPECT_FLOAT_EQ(difference_scale(reference, reference), 0.1f);
}

TEST(Metrics, NonFinitePixelsAreCountedAndLeftOut)
{
    Image test = constant(2, 2, Vec3(1.0f)), reference = constant(2, 2, Vec3(2.0f));
    test.at(0, 0, 1) = NAN;
    reference.at(1, 1, 2) = infinity;
    const ImageComparison result = compare_images(test, reference);
    EXPECT_EQ(result.non_finite, 2u);
    EXPECT_DOUBLE_EQ(result.mse, 1.0);
    EXPECT_DOUBLE_EQ(result.mean_ratio[2], 0.5);
    EXPECT_EQ(signed_difference(test, reference, 1.0f).at(0, 0, 0), 1.0f);
    EXPECT_EQ(signed_difference(test, reference, 1.0f).at(0, 0, 2), 1.0f);

    const ImageComparison black = compare_images(reference, constant(2, 2, Vec3(0.0f)));
    EXPECT_TRUE(std::isnan(black.mean_ratio[0]));
}

TEST(Metrics, UnlikeImagesAreUserErrors)
{
    EXPECT_THROW(compare_images(Image(2, 2, 3), Image(2, 3, 3)), UserError);
    EXPECT_THROW(compare_images(Image(2, 2, 3), Image(2, 2, 4)), UserError);
    EXPECT_THROW(absolute_difference(Image(2, 2, 3), Image(3, 2, 3)), UserError);
    EXPECT_THROW(compare_images(Image(), Image()), UserError);
    EXPECT_THROW(block_means(Image(2, 2, 3), 0), UserError);
    EXPECT_THROW(flip(Image(2, 2, 1), Image(2, 2, 1)), UserError);
    EXPECT_THROW(flip(Image(2, 2, 3), Image(2, 1, 3)), UserError);
}

TEST(Metrics, BlocksHoldTheirPixels)
{
    Image image(5, 3, 2);
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 5; ++x) {
            image.at(x, y, 0) = static_cast<float>(x + 10 * y);
            image.at(x, y, 1) = 1.0f;
        }
    const Image means = block_means(image, 2), variances = block_variances(image, 2);
    ASSERT_EQ(means.width, 3);
    ASSERT_EQ(means.height, 2);
    EXPECT_FLOAT_EQ(means.at(0, 0, 0), 5.5f);   // 0 1 10 11
    EXPECT_FLOAT_EQ(means.at(2, 0, 0), 9.0f);   // 4 14
    EXPECT_FLOAT_EQ(means.at(1, 1, 0), 22.5f);  // 22 23
    EXPECT_FLOAT_EQ(means.at(2, 1, 0), 24.0f);
    EXPECT_FLOAT_EQ(means.at(2, 1, 1), 1.0f);
    EXPECT_FLOAT_EQ(variances.at(0, 0, 0), (5.5f * 5.5f + 4.5f * 4.5f) * 2 / 3);
    EXPECT_FLOAT_EQ(variances.at(1, 1, 0), 0.5f);
    EXPECT_FLOAT_EQ(variances.at(2, 1, 0), 0.0f);
}

// Expected numbers from the authors' program (flip-evaluator 1.7, LDR, linear input); it computes in single precision
// and rounds its colour matrices, hence the tolerance.
TEST(Flip, AgreesWithTheAuthorsProgram)
{
    constexpr double tolerance = 3e-4;
    const int width = 40, height = 30;
    const auto uniform_error = [&](const Vec3& a, const Vec3& b) {
        return flip(constant(width, height, a), constant(width, height, b)).mean;
    };
    EXPECT_EQ(uniform_error({0.2f, 0.4f, 0.9f}, {0.2f, 0.4f, 0.9f}), 0.0);
    EXPECT_NEAR(uniform_error(Vec3(0.0f), Vec3(1.0f)), 0.967388, tolerance);
    EXPECT_NEAR(uniform_error({0, 1, 0}, {0, 0, 1}), 1.0, 1e-6);
    EXPECT_NEAR(uniform_error({1, 0, 0}, {0, 1, 0}), 0.986665, tolerance);
    EXPECT_NEAR(uniform_error({0.5f, 0.5f, 0.5f}, {0.45f, 0.5f, 0.55f}), 0.164051, tolerance);

    Image test(width, height, 3), reference(width, height, 3), step(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) {
                reference.at(x, y, c) = static_cast<float>(0.5 + 0.5 * std::sin(0.37 * x + 0.61 * y + 2.0 * c));
                test.at(x, y, c) = static_cast<float>(0.5 + 0.45 * std::sin(0.39 * x + 0.60 * y + 2.1 * c));
                step.at(x, y, c) = x < 20 ? 0.2f : 0.8f;
            }
    FlipResult result = flip(test, reference, 67.0f);
    EXPECT_NEAR(result.mean, 0.393641, tolerance);
    EXPECT_NEAR(result.map.at(0, 0, 0), 0.345621, tolerance);
    EXPECT_NEAR(result.map.at(20, 15, 0), 0.539688, tolerance);
    EXPECT_NEAR(result.map.at(39, 29, 0), 0.718948, tolerance);
    EXPECT_NEAR(result.map.at(33, 7, 0), 0.762763, tolerance);
    result = flip(test, reference, 30.0f);
    EXPECT_NEAR(result.mean, 0.524678, tolerance);
    EXPECT_NEAR(result.map.at(20, 15, 0), 0.637220, tolerance);

    result = flip(step, constant(width, height, Vec3(0.5f)));
    EXPECT_NEAR(result.mean, 0.526572, tolerance);
    EXPECT_NEAR(result.map.at(19, 15, 0), 0.608833, tolerance);
    EXPECT_NEAR(result.map.at(5, 15, 0), 0.535905, tolerance);
    EXPECT_NEAR(result.map.at(20, 15, 0), 0.586062, tolerance);
}

}  // namespace
}  // namespace dapple
