// Numbers of things in messages: "1 pass", "2 passes".
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace dapple {

// "pass" for 1, else "passes"; the word in the singular, of those whose plural is regular.
std::string plural(uint64_t count, std::string_view word);

// With the number: "1 pass", "1200 passes".
std::string counted(uint64_t count, std::string_view word);

}  // namespace dapple
