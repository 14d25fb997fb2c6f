// Where else a raster position lies: the images of spherical cameras are closed, and an eye path that a pixel's filter
// sends beyond the border sees what is on the other side. What is splatted near a border must be splatted there too.
#pragma once

#include "dapple/cameras/camera.h"

#include <array>

namespace dapple {

struct RasterCopies {
    static constexpr int most = 9;
    std::array<Vec2, most> positions;
    int count = 0;

    const Vec2* begin() const { return positions.data(); }
    const Vec2* end() const { return positions.data() + count; }
};

// `raster` itself, and all positions outside of the image by at most `margin` pixels whose rays are the same. Complete
// for margins up to half the image.
RasterCopies raster_copies(const Camera& camera, const Vec2& raster, float margin);

}  // namespace dapple
