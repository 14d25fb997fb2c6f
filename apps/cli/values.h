// Options whose values are read here and not by CLI11, whose errors do not say what is allowed: each error is one line,
// "--passes takes a whole number of 1 or more, not '1.5'".
#pragma once

#include "commands.h"
#include "dapple/base/ranges.h"

#include <functional>
#include <map>
#include <string>

namespace dapple::cli {

// take(option, text) reads the value and throws UserError naming the option; `kind` stands for the value in the help.
using Take = std::function<void(const std::string& option, const std::string& text)>;
void add_value(CLI::App& parser, const std::string& names, const std::string& kind, const std::string& help, Take take);

// A number within a range such as "> 0" or "integer 1 to 4096" (forms: base/ranges.h).
template <class Number>
void add_number(CLI::App& parser, const std::string& names, Number& target, const std::string& range,
                const std::string& help)
{
    add_value(parser, names, "NUMBER", help, [&target, range](const std::string& option, const std::string& text) {
        target = static_cast<Number>(parse_number(option, text, range));
    });
}

// One of the words.
template <class Value>
void add_word(CLI::App& parser, const std::string& names, Value& target, const std::map<std::string, Value>& values,
              const std::string& help)
{
    std::string range;
    for (const auto& [word, value] : values) range += (range.empty() ? "" : "|") + word;
    add_value(parser, names, "WORD", help,
              [&target, values, range](const std::string& option, const std::string& text) {
                  check_word(option, text, range);
                  target = values.at(text);
              });
}

// What is wrong with the command line, in one line of our own where CLI11 found it.
std::string explain(const CLI::ParseError& error, const CLI::App& app);

}  // namespace dapple::cli
