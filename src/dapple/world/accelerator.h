// Ray queries against the world's geometry. The only header between World and Embree; no Embree type appears in it.
#pragma once

#include "dapple/world/world.h"

#include <memory>

namespace dapple {

class Accelerator {
public:
    // Builds the bounding volume hierarchies over world.geometries, groups and instances. Geometries of no group are
    // placed as they are. The world's arrays must stay where they are.
    explicit Accelerator(const World& world);
    ~Accelerator();

    // Nearest hit with t in (0, t_max); alpha is not looked at.
    bool intersect(const Ray& ray, float t_max, Hit& hit) const;
    bool occluded(const Ray& ray, float t_max) const;

    Box3 bounds() const;
    // Bytes that the hierarchies hold.
    size_t memory() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace dapple
