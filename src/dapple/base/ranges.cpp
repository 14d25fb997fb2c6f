#include "dapple/base/ranges.h"

#include "dapple/base/error.h"

#include <algorithm>
#include <cctype>
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

}  // namespace dapple
