// The same seed gives the same bits on 1, 2 and 7 threads, another seed another picture: for every integrator.
#include "agreement/scenes.h"

#include "dapple/base/parallel.h"

#include <gtest/gtest.h>

#include <cstring>

namespace dapple::testing {
namespace {

bool same_bits(const Image& a, const Image& b)
{
    return a.pixels.size() == b.pixels.size() &&
           std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(float)) == 0;
}

class Bits : public ::testing::TestWithParam<std::string> {
protected:
    void TearDown() override { set_thread_count(0); }
};

TEST_P(Bits, DoNotDependOnThreads)
{
    for (const char* name : {"glass_and_mirror", "many_lights", "fog"}) {
        set_thread_count(0);
        const TestScene scene = agreement_scene(name);
        if (!scene.suits(GetParam())) continue;
        RenderRequest request;
        request.integrator = GetParam();
        request.passes = 3;
        request.settings = small_settings(GetParam(), 2);  // an epoch ends in between
        request.layers = true;
        set_thread_count(1);
        const Rendered one = scene.render(request);
        EXPECT_EQ(one.accidents, 0u) << name;
        for (int threads : {2, 7}) {
            set_thread_count(threads);
            const Rendered many = scene.render(request);
            EXPECT_TRUE(same_bits(one.layers, many.layers)) << name << ", " << threads << " threads";
        }
        ++request.seed;
        EXPECT_FALSE(same_bits(one.beauty, scene.render(request).beauty)) << name << ": the seed does not matter";
    }
}

INSTANTIATE_TEST_SUITE_P(Integrators, Bits, ::testing::ValuesIn(integrator_names()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace dapple::testing
