#include "dapple/formats/pbrt_lexer.h"

#include "dapple/formats/read_file.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstring>

namespace dapple {
namespace {

constexpr bool is_space(char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }
constexpr bool ends_word(char c) { return is_space(c) || c == '"' || c == '[' || c == ']'; }
constexpr bool starts_number(char c) { return (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.'; }

// A number too small for its type counts as zero, one too large is an error.
bool underflows(std::string_view text)
{
    double value = 0.0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (result.ec == std::errc{}) return std::fabs(value) < 1.0;
    return text.find("e-") != text.npos || text.find("E-") != text.npos;
}

}  // namespace

PbrtLexer::PbrtLexer(std::shared_ptr<const SourceText> source)
    : source_(std::move(source)), cursor_(source_->begin()), end_(source_->end())
{
    const std::string_view text(cursor_, static_cast<size_t>(end_ - cursor_));
    if (text.starts_with("\xfe\xff") || text.starts_with("\xff\xfe"))
        throw UserError({source_->name(), 0, 0}, "the file is encoded as UTF-16; save it as UTF-8");
    if (text.starts_with("\xef\xbb\xbf")) cursor_ += 3;
}

void PbrtLexer::unpeek()
{
    if (peeked_) cursor_ = token_.at;
    peeked_ = false;
}

void PbrtLexer::skip_space()
{
    while (cursor_ < end_) {
        if (is_space(*cursor_)) {
            ++cursor_;
        } else if (*cursor_ == '#') {
            const void* newline = std::memchr(cursor_, '\n', static_cast<size_t>(end_ - cursor_));
            cursor_ = newline ? static_cast<const char*>(newline) : end_;
        } else {
            return;
        }
    }
}

std::string_view PbrtLexer::word_at_cursor() const
{
    const char* stop = cursor_;
    while (stop < end_ && !ends_word(*stop)) ++stop;
    return {cursor_, static_cast<size_t>(stop - cursor_)};
}

PbrtToken PbrtLexer::scan_string()
{
    const char* start = cursor_;
    for (const char* p = start + 1; p < end_ && *p != '\n'; ++p) {
        if (*p == '"') {
            cursor_ = p + 1;
            return {PbrtToken::Kind::string, {start + 1, static_cast<size_t>(p - start - 1)}, start};
        }
        if (*p == '\\' && p + 1 < end_) ++p;
    }
    throw UserError(locate(start), "the string does not end on its line");
}

void PbrtLexer::scan()
{
    skip_space();
    if (cursor_ == end_) {
        token_ = {PbrtToken::Kind::end, {}, cursor_};
    } else if (*cursor_ == '"') {
        token_ = scan_string();
    } else if (*cursor_ == '[' || *cursor_ == ']') {
        token_ = {*cursor_ == '[' ? PbrtToken::Kind::open : PbrtToken::Kind::close, {cursor_, 1}, cursor_};
        ++cursor_;
    } else {
        const std::string_view word = word_at_cursor();
        token_ = {PbrtToken::Kind::word, word, cursor_};
        cursor_ += word.size();
    }
}

const PbrtToken& PbrtLexer::peek()
{
    if (!peeked_) scan();
    peeked_ = true;
    return token_;
}

PbrtToken PbrtLexer::next()
{
    if (!peeked_) scan();
    peeked_ = false;
    return token_;
}

std::string PbrtLexer::expect_string(std::string_view what)
{
    const PbrtToken token = next();
    if (token.kind == PbrtToken::Kind::end)
        throw UserError(locate(token.at), fmt::format("the file ends where {} in quotes should stand", what));
    if (token.kind != PbrtToken::Kind::string)
        throw UserError(locate(token.at), fmt::format("expected {} in quotes, got '{}'", what, shown(token.text)));
    return unescape(token);
}

void PbrtLexer::expect(PbrtToken::Kind bracket, std::string_view what)
{
    const PbrtToken token = next();
    const char* symbol = bracket == PbrtToken::Kind::open ? "[" : "]";
    if (token.kind == PbrtToken::Kind::end)
        throw UserError(locate(token.at), fmt::format("the file ends within {}: '{}' is missing", what, symbol));
    if (token.kind != bracket)
        throw UserError(locate(token.at),
                        fmt::format("expected '{}' in {}, got '{}'", symbol, what, shown(token.text)));
}

bool PbrtLexer::skip_open()
{
    if (peek().kind != PbrtToken::Kind::open) return false;
    next();
    return true;
}

bool PbrtLexer::skip_close()
{
    if (peek().kind == PbrtToken::Kind::end)
        throw UserError(locate(token_.at), "the file ends within a list: ']' is missing");
    if (token_.kind != PbrtToken::Kind::close) return false;
    next();
    return true;
}

std::string PbrtLexer::unescape(const PbrtToken& string) const
{
    if (string.text.find('\\') == string.text.npos) return std::string(string.text);
    std::string result;
    for (size_t i = 0; i < string.text.size(); ++i) {
        if (string.text[i] != '\\') {
            result += string.text[i];
            continue;
        }
        ++i;  // scan_string() made sure that a backslash is not the last character
        switch (string.text[i]) {
            case 'n': result += '\n'; break;
            case 't': result += '\t'; break;
            case 'r': result += '\r'; break;
            case 'b': result += '\b'; break;
            case 'f': result += '\f'; break;
            case '\\':
            case '\'':
            case '"': result += string.text[i]; break;
            default:
                throw UserError(locate(string.text.data() + i - 1),
                                fmt::format("unknown escape '\\{}' in a string", shown({&string.text[i], 1})));
        }
    }
    return result;
}

bool PbrtLexer::at_number() const { return cursor_ < end_ && starts_number(*cursor_); }

void PbrtLexer::fail_number(std::string_view kind) const
{
    if (cursor_ == end_) throw UserError(locate(cursor_), fmt::format("the file ends where {} should stand", kind));
    const SourceLocation where = locate(cursor_);
    if (*cursor_ == '"') throw UserError(where, fmt::format("expected {}, got a text in quotes", kind));
    const std::string_view word = word_at_cursor();
    const std::string_view text = word.empty() ? std::string_view(cursor_, 1) : word;
    throw UserError(where, fmt::format("expected {}, got '{}'", kind, shown(text)));
}

template <class Number>
Number PbrtLexer::parse_number()
{
    constexpr std::string_view kind = std::is_integral_v<Number> ? "an integer" : "a number";
    if (!at_number()) fail_number(kind);
    const char* start = cursor_ + (*cursor_ == '+' ? 1 : 0);
    if (start != cursor_ && start < end_ && *start == '-') fail_number(kind);
    Number value{};
    const auto [stop, error] = std::from_chars(start, end_, value);
    if (stop < end_ && !ends_word(*stop)) fail_number(kind);
    if (error == std::errc::result_out_of_range) {
        if (std::is_integral_v<Number> || !underflows({start, static_cast<size_t>(stop - start)}))
            throw UserError(locate(cursor_), fmt::format("the number '{}' is too large", shown(word_at_cursor())));
        value = 0;
    } else if (error != std::errc{} || !std::isfinite(static_cast<double>(value))) {
        fail_number(kind);
    }
    cursor_ = stop;
    return value;
}

void PbrtLexer::read_numbers(std::vector<float>& values)
{
    unpeek();
    for (skip_space(); at_number(); skip_space()) values.push_back(parse_number<float>());
}

void PbrtLexer::read_integers(std::vector<int>& values)
{
    unpeek();
    for (skip_space(); at_number(); skip_space()) values.push_back(parse_number<int>());
}

float PbrtLexer::read_number()
{
    unpeek();
    skip_space();
    return parse_number<float>();
}

int PbrtLexer::read_integer()
{
    unpeek();
    skip_space();
    return parse_number<int>();
}

double PbrtLexer::expect_number(std::string_view what)
{
    unpeek();
    skip_space();
    if (!at_number()) fail_number(what);
    return parse_number<double>();
}

}  // namespace dapple
