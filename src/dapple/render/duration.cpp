// Durations and memory sizes as people write and read them.
#include "dapple/render/duration.h"

#include "dapple/base/error.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <utility>

namespace dapple {
namespace {

// Reads one "number unit" of text at `at`; false when there is none. The unit is lower case and may be empty.
bool read_quantity(const std::string& text, size_t& at, double& value, std::string& unit)
{
    if (at >= text.size() || !(std::isdigit(static_cast<unsigned char>(text[at])) || text[at] == '.')) return false;
    char* end = nullptr;
    value = std::strtod(text.c_str() + at, &end);
    const size_t next = static_cast<size_t>(end - text.c_str());
    if (next == at) return false;
    at = next;
    unit.clear();
    while (at < text.size() && std::isalpha(static_cast<unsigned char>(text[at])))
        unit += static_cast<char>(std::tolower(static_cast<unsigned char>(text[at++])));
    return std::isfinite(value);
}

}  // namespace

double parse_duration(const std::string& option, const std::string& text)
{
    static constexpr std::array<std::pair<std::string_view, double>, 9> units = {{{"", 1},
                                                                                  {"s", 1},
                                                                                  {"sec", 1},
                                                                                  {"m", 60},
                                                                                  {"min", 60},
                                                                                  {"h", 3600},
                                                                                  {"hour", 3600},
                                                                                  {"hours", 3600},
                                                                                  {"ms", 1e-3}}};
    double total = 0;
    size_t at = 0;
    bool valid = !text.empty();
    while (valid && at < text.size()) {
        double value = 0;
        std::string unit;
        valid = read_quantity(text, at, value, unit);
        // A bare number is seconds, and stands alone: "1h30" could mean anything.
        valid = valid && (!unit.empty() || (total == 0 && at == text.size()));
        bool known = false;
        for (const auto& [name, seconds] : units) {
            if (name != unit) continue;
            total += value * seconds;
            known = true;
        }
        valid = valid && known;
    }
    if (!valid || !(total > 0))
        throw UserError(option + " takes a duration such as 60s, 5m or 1h30m, not '" + text + "'");
    return total;
}

std::string format_duration(double seconds)
{
    const int64_t whole = seconds > 0 ? static_cast<int64_t>(seconds) : 0;
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
    return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

uint64_t parse_size(const std::string& option, const std::string& text)
{
    size_t at = 0;
    double value = 0;
    std::string unit;
    bool valid = read_quantity(text, at, value, unit) && at == text.size();
    double scale = 1;
    if (unit == "k" || unit == "kb" || unit == "kib") {
        scale = 1024.0;
    } else if (unit == "m" || unit == "mb" || unit == "mib") {
        scale = 1024.0 * 1024;
    } else if (unit == "g" || unit == "gb" || unit == "gib") {
        scale = 1024.0 * 1024 * 1024;
    } else if (unit == "t" || unit == "tb" || unit == "tib") {
        scale = 1024.0 * 1024 * 1024 * 1024;
    } else {
        valid = valid && (unit.empty() || unit == "b");
    }
    const double bytes = value * scale;
    if (!valid || !(bytes >= 1) || bytes > 1e18)
        throw UserError(option + " takes a size such as 512M or 8G, not '" + text + "'");
    return static_cast<uint64_t>(bytes);
}

std::string format_size(double bytes)
{
    static constexpr std::array<std::string_view, 5> units = {"B", "KiB", "MiB", "GiB", "TiB"};
    size_t unit = 0;
    while (bytes >= 1024 && unit + 1 < units.size()) {
        bytes /= 1024;
        ++unit;
    }
    return unit == 0 ? fmt::format("{:.0f} B", bytes) : fmt::format("{:.1f} {}", bytes, units[unit]);
}

std::string format_count(uint64_t count)
{
    static constexpr std::array<std::string_view, 5> units = {"", " k", " M", " G", " T"};
    if (count < 1000) return fmt::format("{}", count);
    size_t unit = 0;
    uint64_t thousandths = count;
    while (thousandths >= 1'000'000 && unit + 2 < units.size()) {
        thousandths /= 1000;
        ++unit;
    }
    // `thousandths` is now in [1000, 1e6): the count in units[unit + 1], times 1000.
    const uint64_t whole = thousandths / 1000;
    const uint64_t rest = thousandths % 1000;
    if (whole < 10) return fmt::format("{}.{:02}{}", whole, rest / 10, units[unit + 1]);
    if (whole < 100) return fmt::format("{}.{}{}", whole, rest / 100, units[unit + 1]);
    return fmt::format("{}{}", whole, units[unit + 1]);
}

}  // namespace dapple
