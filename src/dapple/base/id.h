// Typed indices into flat arrays: a MaterialId cannot be mistaken for a LightId.
#pragma once

#include <cstddef>
#include <cstdint>

namespace dapple {

template <class Tag>
struct Id {
    static constexpr uint32_t none_value = 0xffffffffu;

    uint32_t value = none_value;

    constexpr Id() = default;
    constexpr explicit Id(uint32_t v) : value(v) {}
    constexpr explicit Id(size_t v) : value(static_cast<uint32_t>(v)) {}
    constexpr explicit Id(int v) : value(static_cast<uint32_t>(v)) {}

    constexpr bool valid() const { return value != none_value; }
    friend constexpr bool operator==(Id a, Id b) { return a.value == b.value; }
    friend constexpr bool operator!=(Id a, Id b) { return a.value != b.value; }
};

}  // namespace dapple
