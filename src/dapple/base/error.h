// User errors carry where they were made; programming errors are assertions (base/assert.h); numerical accidents
// are counted (film/accidents.h). Nothing else is thrown.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace dapple {

// A place in a text the user wrote. Line and column count from 1; 0 means "the whole file".
struct SourceLocation {
    std::string file;
    int line = 0;
    int column = 0;

    // "file:line:column", shortened to what is known; empty when nothing is.
    std::string to_string() const;
};

// An error the user can mend: a scene, an option, a file. what() is one line: "file:line:column: message".
class UserError : public std::runtime_error {
public:
    explicit UserError(const std::string& message);
    UserError(const SourceLocation& where, const std::string& message);
};

// Returns the known word nearest to `word` by edit distance, or an empty view when none is near enough to be meant.
std::string_view nearest_word(std::string_view word, std::span<const std::string_view> known);

// Returns "; did you mean 'x'?" for the nearest known word, or an empty string.
std::string did_you_mean(std::string_view word, std::span<const std::string_view> known);

}  // namespace dapple
