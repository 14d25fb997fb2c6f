// Equirectangular: the columns go round; beyond a pole the rows come back half a turn further. Equal area: beyond a
// side of the octahedral square lies the same side turned by half a turn about its middle, beyond a corner the corner
// opposite (sampling/equal_area.h, wrap_equal_area_square).
#include "dapple/cameras/raster_copies.h"

namespace dapple {

RasterCopies raster_copies(const Camera& camera, const Vec2& raster, float margin)
{
    RasterCopies copies;
    copies.positions[static_cast<size_t>(copies.count++)] = raster;
    if (camera.kind != Camera::Kind::spherical) return copies;

    const Vec2 size(static_cast<float>(camera.resolution.x), static_cast<float>(camera.resolution.y));
    const auto add = [&](const Vec2& p) {
        const bool near = p.x >= -margin && p.y >= -margin && p.x <= size.x + margin && p.y <= size.y + margin;
        if (near && copies.count < RasterCopies::most) copies.positions[static_cast<size_t>(copies.count++)] = p;
    };
    if (camera.mapping == Camera::SphericalMapping::equal_area) {
        for (const float side : {0.0f, 2.0f}) {
            add({side * size.x - raster.x, size.y - raster.y});
            add({size.x - raster.x, side * size.y - raster.y});
            for (const float other : {-1.0f, 1.0f}) add({raster.x + (side - 1.0f) * size.x, raster.y + other * size.y});
        }
        return copies;
    }
    for (const float turn : {-1.0f, 1.0f}) {
        add({raster.x + turn * size.x, raster.y});
        for (const float pole : {0.0f, 2.0f * size.y}) add({raster.x + 0.5f * turn * size.x, pole - raster.y});
    }
    // Beyond a pole and a side at once.
    for (const float turn : {-1.5f, 1.5f})
        for (const float pole : {0.0f, 2.0f * size.y}) add({raster.x + turn * size.x, pole - raster.y});
    return copies;
}

}  // namespace dapple
