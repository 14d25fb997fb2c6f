// Durations and memory sizes as people write and read them.
#pragma once

#include <cstdint>
#include <string>

namespace dapple {

// Seconds of a duration: "90", "90s", "1.5m", "2h", "1h30m", "2min". Throws UserError naming `option` when the text is
// not a positive duration.
double parse_duration(const std::string& option, const std::string& text);

// "42 s", "3 min 05 s", "1 h 02 min": whole units, rounded down, so that a remaining time never claims to be longer
// than estimated. Negative values read "0 s".
std::string format_duration(double seconds);

// Bytes of a size: "512M", "8G", "1.5GB", "100000". Multiples are powers of 1024. Throws UserError naming `option`.
uint64_t parse_size(const std::string& option, const std::string& text);

// "812 B", "3.4 MiB", "1.2 GiB".
std::string format_size(double bytes);

// "999", "12.3 k", "4.56 M", "1.20 G": three digits of a count, rounded down.
std::string format_count(uint64_t count);

}  // namespace dapple
