// Tables of weights and their sampling. Alias table: Vose 1991, "A linear algorithm for generating random numbers with
// a given distribution" (sums kept in double). Piecewise constant densities: inversion of the cumulative table by
// binary search, and in two dimensions a marginal over rows, then the row (Pharr, Jakob, Humphreys 2023, A.5). Cost:
// O(1) for the alias table, O(log n) for a piecewise density.
#include "dapple/sampling/piecewise.h"

#include "dapple/base/assert.h"

#include <algorithm>
#include <cmath>

namespace dapple {
namespace {

// The interval i with cdf[i] <= u < cdf[i + 1] for u < 1: an interval of zero width is never chosen.
size_t find_interval(const std::vector<float>& cdf, float u)
{
    const auto above = std::upper_bound(cdf.begin(), cdf.end(), u);
    const auto index = std::max<ptrdiff_t>(0, (above - cdf.begin()) - 1);
    return std::min(static_cast<size_t>(index), cdf.size() - 2);
}

size_t cell_of(float x, size_t count)
{
    const float scaled = std::max(0.0f, x) * static_cast<float>(count);
    return std::min(static_cast<size_t>(scaled), count - 1);
}

}  // namespace

AliasTable::AliasTable(std::span<const float> weights) : bins_(weights.size())
{
    const size_t count = weights.size();
    if (count == 0) return;
    double sum = 0.0;
    for (const float w : weights) {
        DAPPLE_ASSERT(w >= 0.0f && std::isfinite(w));
        sum += w;
    }

    // Each bin is filled to the mean: a small weight gets the rest of its bin from a large one, its alias.
    struct Pending {
        uint32_t index;
        double share;  // weight over mean weight, what is left of it
    };
    std::vector<Pending> small, large;
    for (size_t i = 0; i < count; ++i) {
        const double p = sum > 0.0 ? weights[i] / sum : 1.0 / static_cast<double>(count);
        const auto index = static_cast<uint32_t>(i);
        bins_[i] = {1.0f, index, static_cast<float>(p)};
        if (p > 0.0) least_ = std::min(least_, bins_[i].p);
        const double share = p * static_cast<double>(count);
        (share < 1.0 ? small : large).push_back({index, share});
    }
    while (!small.empty() && !large.empty()) {
        const Pending lower = small.back();
        const Pending upper = large.back();
        small.pop_back();
        large.pop_back();
        bins_[lower.index].threshold = static_cast<float>(lower.share);
        bins_[lower.index].alias = upper.index;
        const double left = upper.share - (1.0 - lower.share);
        (left < 1.0 ? small : large).push_back({upper.index, left});
    }
    // What remains differs from a full bin by rounding alone; a weight of zero must not profit from that.
    const auto heaviest = static_cast<uint32_t>(
        std::max_element(bins_.begin(), bins_.end(), [](const Bin& a, const Bin& b) { return a.p < b.p; }) -
        bins_.begin());
    for (const Pending& rest : small)
        if (bins_[rest.index].p == 0.0f) bins_[rest.index] = {0.0f, heaviest, 0.0f};
}

Distribution1D::Distribution1D(std::span<const float> values)
    : values_(values.begin(), values.end()), cdf_(values.size() + 1)
{
    const size_t count = values_.size();
    if (count == 0) return;
    double sum = 0.0;
    for (const float v : values_) {
        DAPPLE_ASSERT(v >= 0.0f && std::isfinite(v));
        sum += v;
    }
    integral_ = static_cast<float>(sum / static_cast<double>(count));
    double running = 0.0;
    for (size_t i = 0; i < count; ++i) {
        cdf_[i] = static_cast<float>(sum > 0.0 ? running / sum : static_cast<double>(i) / static_cast<double>(count));
        running += values_[i];
    }
    cdf_[count] = 1.0f;
}

float Distribution1D::sample(float u, float* density) const
{
    DAPPLE_ASSERT(!values_.empty());
    u = std::min(u, one_minus_epsilon);
    const size_t i = find_interval(cdf_, u);
    const float within = (u - cdf_[i]) / (cdf_[i + 1] - cdf_[i]);
    if (density) *density = integral_ > 0.0f ? values_[i] / integral_ : 1.0f;
    const size_t count = values_.size();
    float x = (static_cast<float>(i) + within) / static_cast<float>(count);
    // Rounding may carry the point across a border; density(x) must find the cell that was sampled.
    while (cell_of(x, count) < i) x = std::nextafter(x, 2.0f);
    while (cell_of(x, count) > i || x >= 1.0f) x = std::nextafter(x, 0.0f);
    return x;
}

float Distribution1D::density(float x) const
{
    DAPPLE_ASSERT(!values_.empty());
    return integral_ > 0.0f ? values_[cell_of(x, values_.size())] / integral_ : 1.0f;
}

Distribution2D::Distribution2D(std::span<const float> values, int width, int height)
{
    DAPPLE_ASSERT(values.size() == static_cast<size_t>(width) * static_cast<size_t>(height));
    std::vector<float> row_integrals;
    rows_.reserve(static_cast<size_t>(height));
    for (int v = 0; v < height; ++v) {
        rows_.emplace_back(values.subspan(static_cast<size_t>(v) * static_cast<size_t>(width), width));
        row_integrals.push_back(rows_.back().integral());
    }
    marginal_ = Distribution1D(row_integrals);
}

Vec2 Distribution2D::sample(const Vec2& u, float* density) const
{
    float density_v = 0.0f, density_u = 0.0f;
    const float v = marginal_.sample(u.y, &density_v);
    const float x = rows_[cell_of(v, rows_.size())].sample(u.x, &density_u);
    if (density) *density = density_v * density_u;
    return {x, v};
}

float Distribution2D::density(const Vec2& p) const
{
    const float density_v = marginal_.density(p.y);
    return density_v > 0.0f ? density_v * rows_[cell_of(p.y, rows_.size())].density(p.x) : 0.0f;
}

}  // namespace dapple
