// How much work the picture's content makes for the compression of OpenEXR files.
#pragma once

#include "dapple/image/image.h"

namespace dapple {

// Of the .exr files that are written: more takes longer and saves half a percent.
constexpr int exr_zip_level = 1;

// Processor seconds of this thread for compressing all values as ZIP does in OpenEXR: in blocks of 16 rows, with the
// low bytes apart from the high ones, each byte as the difference from the one before it, deflated at exr_zip_level.
// Other threads do not disturb it (but for the caches and cores that they share).
double zip_seconds(const Image& image);

}  // namespace dapple
