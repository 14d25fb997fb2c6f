// Words, quoted strings, brackets and numbers of a pbrt file. '#' starts a comment that ends with the line.
// Numbers are read straight from the text, without tokens: a mesh of 100 MB takes about a second.
#pragma once

#include "dapple/formats/source_text.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace dapple {

struct PbrtToken {
    enum class Kind : uint8_t { end, word, string, open, close };
    Kind kind = Kind::end;
    std::string_view text;  // word: itself; string: what stands between the quotes, escapes as written
    const char* at = nullptr;
};

class PbrtLexer {
public:
    explicit PbrtLexer(std::shared_ptr<const SourceText> source);

    const PbrtToken& peek();
    PbrtToken next();

    // Each reads one thing or throws a UserError that says what was expected.
    std::string expect_string(std::string_view what);
    double expect_number(std::string_view what);
    void expect(PbrtToken::Kind bracket, std::string_view what);

    // True, and past it, when an opening bracket comes next.
    bool skip_open();
    // True, and past it, when a closing bracket comes next. Throws at the end of the file.
    bool skip_close();

    // Appends numbers until something comes that cannot start one.
    void read_numbers(std::vector<float>& values);
    void read_integers(std::vector<int>& values);
    // The same for a single one.
    float read_number();
    int read_integer();

    // The text of a string token with its escapes resolved.
    std::string unescape(const PbrtToken& string) const;
    SourceLocation locate(const char* at) const { return source_->locate(at); }
    const std::shared_ptr<const SourceText>& source() const { return source_; }

private:
    void unpeek();
    void skip_space();
    void scan();
    PbrtToken scan_string();
    bool at_number() const;
    std::string_view word_at_cursor() const;
    template <class Number>
    Number parse_number();
    [[noreturn]] void fail_number(std::string_view kind) const;

    std::shared_ptr<const SourceText> source_;
    const char* cursor_;
    const char* end_;
    PbrtToken token_;
    bool peeked_ = false;
};

}  // namespace dapple
