// f and the densities of both directions in one call: what bidirectional methods ask of each pair of directions.
#pragma once

#include "dapple/materials/bsdf.h"

namespace dapple {

struct BsdfBothWays {
    Spectrum f;                // as evaluate()
    float pdf = 0.0f;          // per solid angle, of wi given wo
    float pdf_reverse = 0.0f;  // of wo given wi
};

// All zero where f is black.
BsdfBothWays evaluate_both_ways(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi, TransportMode mode);

}  // namespace dapple
