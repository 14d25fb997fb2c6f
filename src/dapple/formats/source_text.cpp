#include "dapple/formats/source_text.h"

#include <algorithm>
#include <cstring>

namespace dapple {

SourceLocation SourceText::locate(const char* at) const
{
    // Count on from the last place asked for, in either direction.
    const char* from = std::min(at, counted_to_);
    const char* to = std::max(at, counted_to_);
    const int lines = static_cast<int>(std::count(from, to, '\n'));
    line_ += at < counted_to_ ? -lines : lines;
    counted_to_ = at;
    const void* newline = memrchr(begin(), '\n', static_cast<size_t>(at - begin()));
    const char* line_start = newline ? static_cast<const char*>(newline) + 1 : begin();
    return {name_, line_, static_cast<int>(at - line_start) + 1};
}

}  // namespace dapple
