// Values checked against a range when they are set, so that a mistake is reported before the scene is loaded. Forms of
// ranges:
//   "true|false", "cone|constant|..."       one of the words
//   "> 0", ">= 0 and < 1", "0 to 1"         a number within the bounds ("to" includes both)
//   "integer", "integer >= 1", ...          the same, and whole
//   ""                                      any text
// A setting whose fallback is "auto" also takes "auto".
#include "dapple/integrators/settings.h"

#include "dapple/base/error.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <vector>

namespace dapple {
namespace {

constexpr std::string_view integer_prefix = "integer";
constexpr double largest_exact_integer = 9007199254740992.0;  // 2^53

// The number a text stands for: 0.5, 1e6, 500k, 2M, 1G. Nothing else before or after it.
std::optional<double> read_number(const std::string& text)
{
    if (text.empty() || std::isspace(static_cast<unsigned char>(text.front()))) return std::nullopt;
    char* end = nullptr;
    double value = std::strtod(text.c_str(), &end);
    if (end == text.c_str()) return std::nullopt;
    switch (*end) {
        case 'k': value *= 1e3, ++end; break;
        case 'M': value *= 1e6, ++end; break;
        case 'G': value *= 1e9, ++end; break;
        default: break;
    }
    if (*end != '\0' || !std::isfinite(value)) return std::nullopt;
    return value;
}

bool is_whole(double value) { return std::floor(value) == value && std::abs(value) <= largest_exact_integer; }

std::vector<std::string_view> split_words(std::string_view range)
{
    std::vector<std::string_view> words;
    while (true) {
        const size_t bar = range.find('|');
        words.push_back(range.substr(0, bar));
        if (bar == std::string_view::npos) return words;
        range.remove_prefix(bar + 1);
    }
}

// Whether value keeps the bounds written in a range such as ">= 0 and < 1" or "0 to 1".
bool within(std::string_view range, double value)
{
    std::istringstream in{std::string(range)};
    std::string token;
    std::optional<double> lower;
    while (in >> token) {
        double bound = 0;
        if (token == "and") continue;
        if (token == "to") {
            in >> bound;
            if (value < *lower || value > bound) return false;
        } else if (const std::optional<double> number = read_number(token)) {
            lower = number;
        } else {
            in >> bound;
            const bool kept = token == ">"    ? value > bound
                              : token == ">=" ? value >= bound
                              : token == "<"  ? value < bound
                                              : value <= bound;
            if (!kept) return false;
        }
    }
    return true;
}

// "integer >= 1 and < 9" as people say it: "a whole number of 1 or more and below 9".
std::string in_words(std::string_view range)
{
    const bool whole = range.starts_with(integer_prefix);
    std::string text = whole ? "a whole number" : "a number";
    std::istringstream in{std::string(whole ? range.substr(integer_prefix.size()) : range)};
    for (std::string token, bound; in >> token;) {
        if (token == "and" || token == "to") {
            text += " " + token;
            if (token == "to" && in >> bound) text += " " + bound;
        } else if (read_number(token)) {
            text += " from " + token;
        } else if (in >> bound) {
            text += token == ">="   ? " of " + bound + " or more"
                    : token == "<=" ? " of at most " + bound
                    : token == ">"  ? " above " + bound
                                    : " below " + bound;
        }
    }
    return text;
}

bool is_list_of_words(std::string_view range) { return range.find('|') != std::string_view::npos; }

// Throws UserError unless the value has the form that the setting's range asks for.
void check_form(const SettingInfo& info, const std::string& value)
{
    const bool may_be_auto = info.fallback == "auto";
    if (info.range.empty() || (may_be_auto && value == "auto")) return;
    const std::string name = "setting '" + std::string(info.name) + "'";
    if (is_list_of_words(info.range))
        check_word(name, value, info.range);
    else
        parse_number(name, value, info.range, may_be_auto ? " or auto" : "");
}

}  // namespace

double parse_number(const std::string& name, const std::string& text, std::string_view range,
                    std::string_view alternative)
{
    const bool whole = range.starts_with(integer_prefix);
    const std::string_view bounds = whole ? range.substr(integer_prefix.size()) : range;
    const std::optional<double> number = read_number(text);
    if (!number || (whole && !is_whole(*number)) || !within(bounds, *number))
        throw UserError(name + " takes " + in_words(range) + std::string(alternative) + ", not '" + text + "'");
    return *number;
}

void check_word(const std::string& name, const std::string& text, std::string_view range)
{
    const std::vector<std::string_view> words = split_words(range);
    if (std::find(words.begin(), words.end(), text) != words.end()) return;
    std::string list;
    for (size_t i = 0; i < words.size(); ++i)
        list.append(i == 0 ? "" : i + 1 < words.size() ? ", " : " or ").append(words[i]);
    throw UserError(name + " takes " + list + ", not '" + text + "'" + did_you_mean(text, words));
}

void Settings::set(const std::string& name, const std::string& value)
{
    std::vector<std::string_view> known;
    for (const SettingInfo& candidate : table_) {
        if (candidate.name == name) {
            check_form(candidate, value);
            values_[name] = value;
            return;
        }
        known.push_back(candidate.name);
    }
    throw UserError("unknown setting '" + name + "'" + did_you_mean(name, known));
}

const SettingInfo& Settings::info(std::string_view name) const
{
    for (const SettingInfo& candidate : table_)
        if (candidate.name == name) return candidate;
    throw UserError("setting '" + std::string(name) + "' is not in this integrator's table");
}

std::string_view Settings::text(std::string_view name) const
{
    const auto found = values_.find(name);
    return found != values_.end() ? std::string_view(found->second) : info(name).fallback;
}

bool Settings::is_auto(std::string_view name) const { return text(name) == "auto"; }

double Settings::number(std::string_view name) const
{
    const std::string value(text(name));
    const std::optional<double> parsed = read_number(value);
    if (!parsed) throw UserError("setting '" + std::string(name) + "' takes a number, not '" + value + "'");
    return *parsed;
}

int64_t Settings::integer(std::string_view name) const
{
    const double value = number(name);
    if (!is_whole(value))
        throw UserError("setting '" + std::string(name) + "' takes a whole number, not '" + std::string(text(name)) +
                        "'");
    return static_cast<int64_t>(value);
}

bool Settings::boolean(std::string_view name) const
{
    const std::string_view value = text(name);
    if (value == "true") return true;
    if (value == "false") return false;
    throw UserError("setting '" + std::string(name) + "' takes true|false, not '" + std::string(value) + "'");
}

std::string_view Settings::word(std::string_view name) const { return text(name); }

}  // namespace dapple
