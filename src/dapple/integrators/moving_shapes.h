// Which shapes move while the shutter is open.
#pragma once

#include "dapple/world/world.h"

namespace dapple {

class MovingShapes {
public:
    explicit MovingShapes(const World& world)
    {
        for (const GroupInstance& instance : world.instances) {
            if (!instance.world_from_group.moves()) continue;
            moves_.resize(world.geometries.size());
            const Group& group = world.groups[instance.group];
            for (uint32_t i = 0; i < group.geometry_count; ++i) moves_[group.first_geometry + i] = true;
        }
    }
    bool any() const { return !moves_.empty(); }
    // Whether some instance of the geometry moves.
    bool has(uint32_t geometry) const { return any() && moves_[geometry]; }

private:
    std::vector<bool> moves_;  // by geometry; empty where nothing moves
};

}  // namespace dapple
