#include "dapple/base/words.h"

namespace dapple {

std::string plural(uint64_t count, std::string_view word)
{
    const bool hisses = word.ends_with('s') || word.ends_with('x') || word.ends_with("ch") || word.ends_with("sh");
    return std::string(word) + (count == 1 ? "" : hisses ? "es" : "s");
}

std::string counted(uint64_t count, std::string_view word) { return std::to_string(count) + " " + plural(count, word); }

}  // namespace dapple
