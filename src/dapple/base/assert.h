// Programming errors. Checked in debug and sanitizer builds, free in release builds.
#pragma once

#include <cassert>

#define DAPPLE_ASSERT(condition) assert(condition)
