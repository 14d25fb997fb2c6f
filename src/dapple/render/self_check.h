// A scene whose answer is known, rendered by every integrator: what `dapple doctor` runs.
#pragma once

#include <string>
#include <vector>

namespace dapple {

struct SelfCheck {
    std::string name;
    std::string detail;  // the number found, and the one expected
    bool passed = false;
};

// The white furnace: a white matte ball under a constant sky cannot be told from the sky. Each integrator renders it at
// 16x16 pixels, and the mean must be that of the sky within 2 %. Takes about a second.
std::vector<SelfCheck> run_self_checks();

}  // namespace dapple
