// Sampling of tabulated functions: alias table (discrete), and piecewise constant densities in one and two dimensions
// with their inverses.
#pragma once

#include "dapple/math/vec.h"

#include <cstdint>
#include <span>
#include <vector>

namespace dapple {

// Discrete choice in constant time (Walker 1974, Vose 1991).
class AliasTable {
public:
    AliasTable() = default;
    // Weights >= 0; all zero means uniform.
    explicit AliasTable(std::span<const float> weights);

    // Index chosen with probability(index); u in [0,1) is consumed and `remapped` returned uniform in [0,1).
    // There must be a weight.
    uint32_t sample(float u, float* remapped = nullptr) const;
    float probability(uint32_t index) const { return bins_[index].p; }
    size_t size() const { return bins_.size(); }
    // Whether what `remapped` keeps of 24 random bits will do for any index: 14 of them.
    bool remaps_finely() const { return least_ >= 0x1p-10f; }

private:
    float least_ = 1.0f;  // probability, zero left out
    struct Bin {
        float threshold;  // below: this index, else the alias
        uint32_t alias;
        float p;
    };
    std::vector<Bin> bins_;
};

inline uint32_t AliasTable::sample(float u, float* remapped) const
{
    const float scaled = u * static_cast<float>(bins_.size());
    const uint32_t index = std::min(static_cast<uint32_t>(scaled), static_cast<uint32_t>(bins_.size() - 1));
    const Bin& bin = bins_[index];
    const float rest = std::clamp(scaled - static_cast<float>(index), 0.0f, one_minus_epsilon);
    const bool own = rest < bin.threshold;
    if (remapped) {
        const float fraction = own ? rest / bin.threshold : (rest - bin.threshold) / (1.0f - bin.threshold);
        *remapped = std::clamp(fraction, 0.0f, one_minus_epsilon);
    }
    return own ? index : bin.alias;
}

// Piecewise constant density on [0,1].
class Distribution1D {
public:
    Distribution1D() = default;
    explicit Distribution1D(std::span<const float> values);

    float sample(float u, float* density) const;
    float density(float x) const;
    float integral() const { return integral_; }  // of the values over [0,1]
    size_t size() const { return values_.size(); }

private:
    std::vector<float> values_, cdf_;
    float integral_ = 0.0f;
};

// Piecewise constant density on [0,1]^2: rows of `values` are v, columns u.
class Distribution2D {
public:
    Distribution2D() = default;
    Distribution2D(std::span<const float> values, int width, int height);

    Vec2 sample(const Vec2& u, float* density) const;
    float density(const Vec2& p) const;
    float integral() const { return marginal_.integral(); }

private:
    std::vector<Distribution1D> rows_;
    Distribution1D marginal_;
};

}  // namespace dapple
