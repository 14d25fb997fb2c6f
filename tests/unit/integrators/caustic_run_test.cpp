#include "dapple/integrators/caustic_run.h"

#include "dapple/sampling/random_stream.h"

#include <gtest/gtest.h>

#include <vector>

namespace dapple {
namespace {

// A vertex of a path, and how it scatters along it.
struct Scattering {
    bool delta = false, wide = false, mapped = false;
    float pdf = 0.0f;    // of the way to the light
    float share = 1.0f;  // s of light that comes that way
};

// How often a gather ray and the photons of all its vertices count a path: from the eye's first vertex that is no
// delta, `path` in front, to the last before the light.
double times_counted(const std::vector<Scattering>& path)
{
    const size_t last = path.size() - 1;
    double sum = 0.0, here = 1.0;  // here: the probability that the ray comes so far
    CausticRun run;
    for (size_t i = 0; i <= last; ++i) {
        const Scattering& v = path[i];
        double marked = 1.0;  // probability that a photon here goes into the caustic map
        bool through_deltas = true;
        for (size_t j = i + 1; j <= last; ++j) {
            marked *= v.delta ? 0.0 : double(path[j].share);
            through_deltas &= path[j].delta;
        }
        const PathClass photon = i == last        ? PathClass::direct
                                 : through_deltas ? PathClass::caustic
                                                  : PathClass::indirect;
        if (!v.delta && v.mapped) {
            sum += here * double(run.of_mapped(photon, v.share));
        } else if (!v.delta) {
            if (photon == PathClass::direct)
                sum += here * double(run.of_direct(v.share));
            else
                sum += here * marked * double(run.of_caustic(photon, v.share, narrow_share(v.pdf), v.wide));
        }
        // Light sampled at the vertex and met after it are two estimates of the same.
        const float direct = run.of_direct(v.share);
        run.leave(v.pdf, v.share, v.wide, v.mapped);
        if (i == last && !v.delta && !v.mapped) {
            EXPECT_NEAR(run.of_lights(), direct, 1e-6f);
        }
        if (i == last && !v.delta && v.mapped) {
            EXPECT_EQ(run.of_lights(), 0.0f);
        }
        if (v.mapped && !v.delta) here *= double(v.share);
    }
    return sum;
}

TEST(CausticRun, CountsEveryPathOnce)
{
    RandomStream random(1, 2, 3);
    int mapped = 0, narrow = 0;
    for (int trial = 0; trial < 20'000; ++trial) {
        std::vector<Scattering> path(1 + random.next_index(6));
        for (size_t i = 0; i < path.size(); ++i) {
            Scattering& v = path[i];
            v.delta = i > 0 && random.next() < 0.25f;
            if (v.delta) continue;
            v.wide = random.next() < 0.5f;
            v.mapped = v.wide && i > 0 && random.next() < 0.5f;
            v.pdf = 4.0f * random.next() + 0.01f;
            v.share = random.next();
            mapped += v.mapped;
            narrow += !v.wide;
        }
        ASSERT_NEAR(times_counted(path), 1.0, 1e-5) << "trial " << trial;
    }
    EXPECT_GT(mapped, 1000);
    EXPECT_GT(narrow, 1000);
}

}  // namespace
}  // namespace dapple
