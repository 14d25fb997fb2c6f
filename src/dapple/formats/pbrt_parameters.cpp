#include "dapple/formats/pbrt_parameters.h"

#include "dapple/formats/pbrt_legacy.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace dapple {
namespace {

struct TypeWord {
    std::string_view word;
    PbrtType type;
};
// The first word of a type is the one that messages use.
constexpr TypeWord type_words[] = {
    {"integer", PbrtType::integer}, {"float", PbrtType::real},          {"point2", PbrtType::point2},
    {"vector2", PbrtType::vector2}, {"point3", PbrtType::point3},       {"point", PbrtType::point3},
    {"vector3", PbrtType::vector3}, {"vector", PbrtType::vector3},      {"normal", PbrtType::normal},
    {"normal3", PbrtType::normal},  {"bool", PbrtType::boolean},        {"string", PbrtType::string},
    {"rgb", PbrtType::rgb},         {"blackbody", PbrtType::blackbody}, {"spectrum", PbrtType::spectrum},
    {"texture", PbrtType::texture},
};

PbrtType type_from_word(std::string_view word, const PbrtParameter& parameter)
{
    std::array<std::string_view, std::size(type_words)> known;
    for (size_t i = 0; i < known.size(); ++i) {
        known[i] = type_words[i].word;
        if (known[i] == word) return type_words[i].type;
    }
    std::string hint = legacy_hint(LegacyKind::parameter_type, word);
    if (hint.empty()) hint = suggest(word, known);
    throw UserError(parameter.where(), fmt::format("unknown parameter type '{}'{}", shown(word), hint));
}

// Splits "type name".
void read_declaration(const std::string& text, PbrtParameter& parameter)
{
    constexpr std::string_view spaces = " \t";
    const size_t type_start = text.find_first_not_of(spaces);
    const size_t type_end = text.find_first_of(spaces, type_start);
    const size_t name_start = text.find_first_not_of(spaces, type_end);
    const size_t name_end = text.find_first_of(spaces, name_start);
    const bool two_words = name_start != text.npos && text.find_first_not_of(spaces, name_end) == text.npos;
    if (!two_words)
        throw UserError(parameter.where(), fmt::format("expected a parameter as \"type name\", got '{}'", shown(text)));
    parameter.type = type_from_word(std::string_view(text).substr(type_start, type_end - type_start), parameter);
    parameter.name = text.substr(name_start, name_end - name_start);
}

void read_boolean(PbrtLexer& lexer, std::vector<uint8_t>& values)
{
    const PbrtToken token = lexer.next();
    const bool known = token.text == "true" || token.text == "false";
    if (!known || token.kind == PbrtToken::Kind::end)
        throw UserError(lexer.locate(token.at), fmt::format("expected true or false, got '{}'", shown(token.text)));
    values.push_back(token.text == "true");
}

void read_values(PbrtLexer& lexer, PbrtParameter& parameter)
{
    const bool list = lexer.skip_open();
    switch (parameter.type) {
        case PbrtType::integer:
            if (list)
                lexer.read_integers(parameter.integers);
            else
                parameter.integers.push_back(lexer.read_integer());
            break;
        case PbrtType::boolean:
            if (!list)
                read_boolean(lexer, parameter.booleans);
            else
                while (lexer.peek().kind == PbrtToken::Kind::word || lexer.peek().kind == PbrtToken::Kind::string)
                    read_boolean(lexer, parameter.booleans);
            break;
        case PbrtType::string:
        case PbrtType::texture:
            if (!list)
                parameter.strings.push_back(lexer.expect_string("a value"));
            else
                while (lexer.peek().kind == PbrtToken::Kind::string)
                    parameter.strings.push_back(lexer.unescape(lexer.next()));
            break;
        default:
            if (parameter.type == PbrtType::spectrum && lexer.peek().kind == PbrtToken::Kind::string)
                parameter.strings.push_back(lexer.unescape(lexer.next()));
            else if (list)
                lexer.read_numbers(parameter.numbers);
            else
                parameter.numbers.push_back(lexer.read_number());
    }
    if (list && !lexer.skip_close()) {
        const PbrtToken token = lexer.next();
        throw UserError(lexer.locate(token.at), fmt::format("expected a value of type {} or ']', got '{}'",
                                                            type_word(parameter.type), shown(token.text)));
    }
}

}  // namespace

std::string_view type_word(PbrtType type)
{
    return std::find_if(std::begin(type_words), std::end(type_words), [&](auto& entry) { return entry.type == type; })
        ->word;
}

int numbers_per_value(PbrtType type)
{
    switch (type) {
        case PbrtType::point2:
        case PbrtType::vector2: return 2;
        case PbrtType::point3:
        case PbrtType::vector3:
        case PbrtType::normal:
        case PbrtType::rgb: return 3;
        case PbrtType::real:
        case PbrtType::blackbody: return 1;
        default: return 0;
    }
}

std::vector<PbrtParameter> read_parameters(PbrtLexer& lexer, scene::ColorSpace color_space)
{
    std::vector<PbrtParameter> parameters;
    while (lexer.peek().kind == PbrtToken::Kind::string) {
        const PbrtToken declaration = lexer.next();
        PbrtParameter& parameter = parameters.emplace_back();
        parameter.at = declaration.at;
        parameter.source = lexer.source();
        parameter.color_space = color_space;
        read_declaration(lexer.unescape(declaration), parameter);
        read_values(lexer, parameter);
        const int per_value = numbers_per_value(parameter.type);
        if (per_value > 0 && parameter.numbers.size() % per_value != 0)
            throw UserError(parameter.where(),
                            fmt::format("'{} {}' takes {} numbers per value, got {} in all", type_word(parameter.type),
                                        shown(parameter.name), per_value, parameter.numbers.size()));
    }
    return parameters;
}

PbrtParameters::PbrtParameters(PbrtContext& context, std::string what, SourceLocation at,
                               std::vector<PbrtParameter> own,
                               std::shared_ptr<const std::vector<PbrtParameter>> defaults)
    : context_(&context),
      what_(std::move(what)),
      at_(std::move(at)),
      own_(std::move(own)),
      defaults_(std::move(defaults))
{
}

const PbrtParameter* PbrtParameters::find_own(std::string_view name) const
{
    for (auto parameter = own_.rbegin(); parameter != own_.rend(); ++parameter)
        if (parameter->name == name) return &*parameter;
    return nullptr;
}

const PbrtParameter* PbrtParameters::find_default(std::string_view name, std::initializer_list<PbrtType> types) const
{
    if (!defaults_) return nullptr;
    for (auto parameter = defaults_->rbegin(); parameter != defaults_->rend(); ++parameter)
        if (parameter->name == name && std::find(types.begin(), types.end(), parameter->type) != types.end())
            return &*parameter;
    return nullptr;
}

const PbrtParameter* PbrtParameters::find(std::string_view name, std::initializer_list<PbrtType> types)
{
    asked_.push_back(name);
    const PbrtParameter* own = find_own(name);
    if (!own) return find_default(name, types);
    if (std::find(types.begin(), types.end(), own->type) != types.end()) return own;

    std::string wanted;
    for (PbrtType type : types) wanted += fmt::format("{}{}", wanted.empty() ? "" : " or ", type_word(type));
    throw UserError(own->where(), fmt::format("parameter '{}' of {} must be of type {}, not {}", name, what_, wanted,
                                              type_word(own->type)));
}

bool PbrtParameters::has(std::string_view name)
{
    asked_.push_back(name);
    if (find_own(name)) return true;
    return defaults_ && std::any_of(defaults_->begin(), defaults_->end(), [&](auto& p) { return p.name == name; });
}

SourceLocation PbrtParameters::where(std::string_view name) const
{
    const PbrtParameter* parameter = find_own(name);
    return parameter ? parameter->where() : at_;
}

void PbrtParameters::ignore(std::string_view name, std::string_view why)
{
    asked_.push_back(name);
    if (const PbrtParameter* parameter = find_own(name))
        context_->warn(parameter->where(), fmt::format("parameter '{}' of {} is ignored: {}", name, what_, why));
}

void PbrtParameters::finish()
{
    if (ignore_rest_) return;
    for (const PbrtParameter& parameter : own_) {
        if (std::find(asked_.begin(), asked_.end(), parameter.name) == asked_.end()) {
            std::string hint = legacy_hint(LegacyKind::parameter, parameter.name);
            if (hint.empty()) hint = suggest(parameter.name, asked_);
            throw UserError(parameter.where(),
                            fmt::format("unknown parameter '{}' of {}{}", shown(parameter.name), what_, hint));
        }
        if (find_own(parameter.name) != &parameter)
            context_->warn(
                parameter.where(),
                fmt::format("parameter '{}' of {} is given again later: this one is ignored", parameter.name, what_));
    }
}

}  // namespace dapple
