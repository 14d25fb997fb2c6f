// Path classes (Heckbert notation) and light groups: every contribution to the film names both, so that the layers sum
// to the beauty in every integrator. S is a delta scattering, D any other, read from the light (left) to the eye.
#pragma once

#include "dapple/base/id.h"

#include <array>
#include <cstdint>
#include <string_view>

namespace dapple {

enum class PathClass : uint8_t {
    emission,  // L S* E          lights seen directly or through delta surfaces
    direct,    // L D S* E
    caustic,   // L S+ D S* E
    indirect,  // L (S|D)* D S* D S* E    all else on surfaces
    volume,    // at least one scattering in a medium
};
inline constexpr int path_class_count = 5;
inline constexpr std::array<std::string_view, path_class_count> path_class_names = {"emission", "direct", "caustic",
                                                                                    "indirect", "volume"};

// Counts the events of a path, seen from one of its ends.
struct PathEvents {
    uint16_t diffuse = 0;                // non-delta surface vertices (D) so far
    bool specular_before_first = false;  // a delta vertex before the first D
    bool specular_since_last = false;    // a delta vertex since the last D, or since the start
    bool volume = false;                 // a scattering in a medium

    constexpr void add_surface(bool delta)
    {
        if (delta) {
            specular_before_first |= diffuse == 0;
            specular_since_last = true;
        } else {
            ++diffuse;
            specular_since_last = false;
        }
    }
    constexpr void add_medium() { volume = true; }
};

// The class of a path made of an eye part and a light part, joined without a further vertex in between. A vertex where
// the two meet is counted in one of the parts only. A light met by an eye path has an empty light part.
constexpr PathClass classify(const PathEvents& eye, const PathEvents& light)
{
    if (eye.volume || light.volume) return PathClass::volume;
    const int diffuse = eye.diffuse + light.diffuse;
    if (diffuse == 0) return PathClass::emission;
    if (diffuse >= 2) return PathClass::indirect;
    const bool specular_to_light =
        eye.diffuse == 1 ? eye.specular_since_last || light.specular_since_last : light.specular_before_first;
    return specular_to_light ? PathClass::caustic : PathClass::direct;
}

struct LightGroupTag {};
using LightGroup = Id<LightGroupTag>;  // 0 is the group of lights without a name

}  // namespace dapple
