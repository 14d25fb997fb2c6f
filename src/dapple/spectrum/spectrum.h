// Four lanes of a radiometric quantity. Transport code computes with lanes and never asks what they mean: the colour
// model (wavelengths.h) decides that.
#pragma once

#include <algorithm>
#include <cmath>

namespace dapple {

struct alignas(16) Spectrum {
    static constexpr int lanes = 4;

    float v[lanes] = {0, 0, 0, 0};

    constexpr Spectrum() = default;
    constexpr explicit Spectrum(float all) : v{all, all, all, all} {}
    constexpr Spectrum(float a, float b, float c, float d) : v{a, b, c, d} {}

    constexpr float operator[](int lane) const { return v[lane]; }
    constexpr float& operator[](int lane) { return v[lane]; }

    constexpr Spectrum& operator+=(const Spectrum& o)
    {
        for (int i = 0; i < lanes; ++i) v[i] += o.v[i];
        return *this;
    }
    constexpr Spectrum& operator-=(const Spectrum& o)
    {
        for (int i = 0; i < lanes; ++i) v[i] -= o.v[i];
        return *this;
    }
    constexpr Spectrum& operator*=(const Spectrum& o)
    {
        for (int i = 0; i < lanes; ++i) v[i] *= o.v[i];
        return *this;
    }
    constexpr Spectrum& operator*=(float s)
    {
        for (float& lane : v) lane *= s;
        return *this;
    }
    constexpr Spectrum& operator/=(float s) { return *this *= (1.0f / s); }

    friend constexpr Spectrum operator+(Spectrum a, const Spectrum& b) { return a += b; }
    friend constexpr Spectrum operator-(Spectrum a, const Spectrum& b) { return a -= b; }
    friend constexpr Spectrum operator*(Spectrum a, const Spectrum& b) { return a *= b; }
    friend constexpr Spectrum operator*(Spectrum a, float s) { return a *= s; }
    friend constexpr Spectrum operator*(float s, Spectrum a) { return a *= s; }
    friend constexpr Spectrum operator/(Spectrum a, float s) { return a /= s; }
    friend constexpr bool operator==(const Spectrum&, const Spectrum&) = default;

    bool is_black() const { return v[0] == 0.0f && v[1] == 0.0f && v[2] == 0.0f && v[3] == 0.0f; }
    bool is_finite() const
    {
        return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]) && std::isfinite(v[3]);
    }
    float max() const { return std::max(std::max(v[0], v[1]), std::max(v[2], v[3])); }
    float min() const { return std::min(std::min(v[0], v[1]), std::min(v[2], v[3])); }
    float average() const { return (v[0] + v[1] + v[2] + v[3]) * 0.25f; }
};

// a / b per lane, 0 where b is 0.
inline Spectrum safe_divide(const Spectrum& a, const Spectrum& b)
{
    Spectrum result;
    for (int i = 0; i < Spectrum::lanes; ++i) result.v[i] = b.v[i] != 0.0f ? a.v[i] / b.v[i] : 0.0f;
    return result;
}
inline Spectrum exp(const Spectrum& s) { return {std::exp(s[0]), std::exp(s[1]), std::exp(s[2]), std::exp(s[3])}; }
inline Spectrum sqrt(const Spectrum& s) { return {std::sqrt(s[0]), std::sqrt(s[1]), std::sqrt(s[2]), std::sqrt(s[3])}; }
inline Spectrum clamp_zero(const Spectrum& s)
{
    return {std::max(0.0f, s[0]), std::max(0.0f, s[1]), std::max(0.0f, s[2]), std::max(0.0f, s[3])};
}

}  // namespace dapple
