// Three coordinates of a vector in one register (the vectors of GCC and Clang, so any machine will do): the same
// operations in the same order as component by component, hence the same bits. Internal to the shapes room.
#pragma once

#include "dapple/shapes/double_math.h"

namespace dapple::detail {

typedef float Float4 __attribute__((vector_size(16)));
typedef double Double4 __attribute__((vector_size(32)));

// Passed by reference and always inlined: how wide registers are passed by value depends on the machine.
[[gnu::always_inline]] inline Float4 pack(const Vec3& v) { return Float4{v.x, v.y, v.z, 0.0f}; }
[[gnu::always_inline]] inline Double4 widen(const Float4& v) { return __builtin_convertvector(v, Double4); }
[[gnu::always_inline]] inline Vec3 unpack(const Float4& v) { return {v[0], v[1], v[2]}; }
[[gnu::always_inline]] inline Vec3 narrow(const Double4& v) { return unpack(__builtin_convertvector(v, Float4)); }
[[gnu::always_inline]] inline Vec3d unpack(const Double4& v) { return {v[0], v[1], v[2]}; }

[[gnu::always_inline]] inline double dot(const Double4& a, const Double4& b)
{
    const Double4 product = a * b;
    return product[0] + product[1] + product[2];
}
[[gnu::always_inline]] inline Double4 cross(const Double4& a, const Double4& b)
{
    return __builtin_shufflevector(a, a, 1, 2, 0, 3) * __builtin_shufflevector(b, b, 2, 0, 1, 3) -
           __builtin_shufflevector(a, a, 2, 0, 1, 3) * __builtin_shufflevector(b, b, 1, 2, 0, 3);
}
[[gnu::always_inline]] inline Float4 larger(const Float4& a, const Float4& b) { return a > b ? a : b; }
[[gnu::always_inline]] inline Float4 smaller(const Float4& a, const Float4& b) { return a < b ? a : b; }

}  // namespace dapple::detail
