// A plain source of random numbers for tests.
#pragma once

#include "dapple/math/frame.h"
#include "dapple/math/hash.h"

namespace dapple::testing_support {

// Uniform numbers from a counter.
class Numbers {
public:
    explicit Numbers(uint64_t seed) : seed_(seed) {}
    float next() { return to_unit_float(hash_words(seed_, count_++)); }
    Vec2 next_2d()
    {
        const float x = next();
        return {x, next()};
    }
    Vec3 direction()
    {
        const float z = 1.0f - 2.0f * next();
        return spherical_direction(safe_sqrt(1.0f - z * z), z, 2.0f * pi * next());
    }

private:
    uint64_t seed_;
    uint64_t count_ = 0;
};

}  // namespace dapple::testing_support
