// Values that users write, checked against a range, so that the error says what is allowed. Forms of ranges:
//   "true|false", "cone|constant|..."       one of the words
//   "> 0", ">= 0 and < 1", "0 to 1"         a number within the bounds ("to" includes both)
//   "integer", "integer >= 1", ...          the same, and whole
#pragma once

#include <string>
#include <string_view>

namespace dapple {

// The number that a text stands for (0.5, 1e6, 500k, 2M, 1G), if it keeps the range (forms: above; "": any number).
// Throws UserError: "NAME takes a whole number of 1 or more[ALTERNATIVE], not 'TEXT'".
double parse_number(const std::string& name, const std::string& text, std::string_view range,
                    std::string_view alternative = "");

// Throws UserError with the words and the nearest of them unless the text is a word of the range "one|other|...".
void check_word(const std::string& name, const std::string& text, std::string_view range);

}  // namespace dapple
