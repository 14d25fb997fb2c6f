// The Fresnel equations against tables, identities and complex arithmetic.
#include "dapple/materials/fresnel.h"

#include <gtest/gtest.h>

#include <complex>

namespace dapple {
namespace {

// Reference tables, section E (shared research): reflectance at normal incidence, of diffuse light from outside and
// from inside; critical and Brewster angles.
struct Row {
    float n, normal, diffuse_outside, diffuse_inside, critical, brewster;
};
constexpr Row table[] = {
    {1.3f, 0.017013f, 0.061132f, 0.444457f, 50.285f, 52.431f},
    {1.33f, 0.020059f, 0.065931f, 0.471949f, 48.753f, 53.061f},
    {1.4f, 0.027778f, 0.076812f, 0.528985f, 45.585f, 54.462f},
    {1.5f, 0.040000f, 0.091778f, 0.596346f, 41.810f, 56.310f},
    {1.6f, 0.053254f, 0.106246f, 0.650877f, 38.682f, 57.995f},
    {1.8f, 0.081633f, 0.134054f, 0.732733f, 33.749f, 60.945f},
    {2.0f, 0.111111f, 0.160597f, 0.790149f, 30.000f, 63.435f},
    {2.42f, 0.172395f, 0.212541f, 0.865539f, 24.407f, 67.548f},
};

TEST(Fresnel, DielectricMatchesTheReferenceTable)
{
    for (const Row& row : table) {
        EXPECT_NEAR(fresnel_dielectric(1.0f, row.n), row.normal, 1e-6f);
        EXPECT_NEAR(fresnel_dielectric(-1.0f, row.n), row.normal, 1e-6f);
        // Diffuse light: the integral of 2 cos F d(cos).
        double outside = 0.0, inside = 0.0;
        constexpr int count = 20000;
        for (int i = 0; i < count; ++i) {
            const double c = (i + 0.5) / count;
            outside += 2.0 * c * fresnel_dielectric(float(c), row.n) / count;
            inside += 2.0 * c * fresnel_dielectric(float(-c), row.n) / count;
        }
        EXPECT_NEAR(outside, row.diffuse_outside, 2e-6);
        EXPECT_NEAR(inside, row.diffuse_inside, 2e-5);
        // Total reflection begins at the critical angle.
        EXPECT_LT(fresnel_dielectric(-std::cos(radians(row.critical - 0.01f)), row.n), 1.0f);
        EXPECT_EQ(fresnel_dielectric(-std::cos(radians(row.critical + 0.01f)), row.n), 1.0f);
        // At Brewster's angle the parallel part vanishes: half of the perpendicular part, cos^2(2 theta), remains.
        const float angle = radians(row.brewster);
        EXPECT_NEAR(fresnel_dielectric(std::cos(angle), row.n), 0.5f * sqr(std::cos(2.0f * angle)), 1e-5f);
    }
}

TEST(Fresnel, EqualIndicesReflectNothing)
{
    for (const float c : {1.0f, 0.5f, 1e-3f, 1e-6f, -0.3f}) EXPECT_EQ(fresnel_dielectric(c, 1.0f), 0.0f);
}

TEST(Fresnel, ConductorMatchesComplexArithmetic)
{
    using Complex = std::complex<double>;
    const float etas[] = {0.05f, 0.2f, 1.0f, 3.5f}, ks[] = {0.0f, 0.5f, 3.9f, 9.0f};
    for (const float eta : etas)
        for (int step = 0; step <= 20; ++step) {
            const float c = step / 20.0f;
            const Spectrum got = fresnel_conductor(c, Spectrum(eta), Spectrum(ks[0], ks[1], ks[2], ks[3]));
            for (int lane = 0; lane < Spectrum::lanes; ++lane) {
                const Complex n(eta, ks[lane]);
                const double sin2 = 1.0 - double(c) * c;
                const Complex cos_t = std::sqrt(1.0 - sin2 / (n * n));
                const Complex p = (n * double(c) - cos_t) / (n * double(c) + cos_t);
                const Complex s = (double(c) - n * cos_t) / (double(c) + n * cos_t);
                double expected = 0.5 * (std::norm(p) + std::norm(s));
                if (c == 0.0f && eta == 1.0f && ks[lane] == 0.0f) expected = 0.0;  // no boundary: 0/0
                EXPECT_NEAR(got[lane], expected, 2e-5) << eta << " " << ks[lane] << " " << c;
            }
        }
}

TEST(Fresnel, ReflectanceAsAnIndex)
{
    // eta = 1, k = 2 sqrt(r) / sqrt(1 - r) reflects r at normal incidence.
    const float r = 0.64f;
    EXPECT_NEAR(fresnel_conductor(1.0f, Spectrum(1.0f), Spectrum(2.0f * 0.8f / 0.6f))[0], r, 1e-6f);
}

TEST(Fresnel, RefractionObeysSnellFromBothSides)
{
    const Vec3 n(0, 0, 1);
    Vec3 inside, back;
    float eta_path;
    const Vec3 w = normalize(Vec3(0.6f, 0.3f, 0.5f));
    ASSERT_TRUE(refract(w, n, 1.5f, inside, eta_path));
    EXPECT_FLOAT_EQ(eta_path, 1.5f);
    EXPECT_NEAR(length(inside), 1.0f, 1e-6f);
    EXPECT_NEAR(std::hypot(inside.x, inside.y) * 1.5f, std::hypot(w.x, w.y), 1e-6f);
    EXPECT_LT(inside.z, 0.0f);
    ASSERT_TRUE(refract(inside, n, 1.5f, back, eta_path));
    EXPECT_FLOAT_EQ(eta_path, 1.0f / 1.5f);
    EXPECT_LT(length(back - w), 1e-5f);
    EXPECT_FALSE(refract(normalize(Vec3(1.0f, 0.0f, -0.5f)), n, 1.5f, back, eta_path));
}

}  // namespace
}  // namespace dapple
