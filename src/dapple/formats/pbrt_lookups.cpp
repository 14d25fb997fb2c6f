// The typed look-ups of PbrtParameters.
#include "dapple/formats/pbrt_parameters.h"

#include "dapple/formats/spd.h"
#include "dapple/scene/names.h"
#include "dapple/spectrum/make_spectrum.h"

#include <fmt/format.h>

#include <algorithm>

namespace dapple {
namespace {

[[noreturn]] void fail_count(const PbrtParameter& parameter, size_t got)
{
    throw UserError(parameter.where(),
                    fmt::format("parameter '{}' takes one value, got {}", shown(parameter.name), got));
}

void check_range(const PbrtParameter& parameter, float value, PbrtRange range)
{
    const char* wanted = nullptr;
    if (range == PbrtRange::positive && !(value > 0.0f)) wanted = "greater than 0";
    if (range == PbrtRange::not_negative && !(value >= 0.0f)) wanted = "at least 0";
    if (range == PbrtRange::unit && !(value >= 0.0f && value <= 1.0f)) wanted = "between 0 and 1";
    if (wanted)
        throw UserError(parameter.where(),
                        fmt::format("parameter '{}' must be {}, got {}", parameter.name, wanted, value));
}

std::vector<Vec3> to_triples(const std::vector<float>& numbers)
{
    std::vector<Vec3> triples(numbers.size() / 3);
    for (size_t i = 0; i < triples.size(); ++i)
        triples[i] = Vec3(numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]);
    return triples;
}

// The texture of a name, or a UserError with the nearest one; `other` holds those of the other type.
template <class Index, class OtherIndex>
Index find_texture(const PbrtParameter& parameter, const std::map<std::string, Index, std::less<>>& textures,
                   const std::map<std::string, OtherIndex, std::less<>>& other, std::string_view type,
                   std::string_view other_type)
{
    if (parameter.strings.size() != 1) fail_count(parameter, parameter.strings.size());
    const std::string& name = parameter.strings[0];
    if (const auto found = textures.find(name); found != textures.end()) return found->second;
    if (other.contains(name))
        throw UserError(parameter.where(), fmt::format("texture '{}' is of type {}, parameter '{}' needs type {}",
                                                       shown(name), other_type, shown(parameter.name), type));
    throw UserError(parameter.where(),
                    fmt::format("no {} texture is named '{}'{}", type, shown(name), suggest(name, names_of(textures))));
}

}  // namespace

const PbrtParameter* PbrtParameters::find_single(std::string_view name, PbrtType type)
{
    const PbrtParameter* parameter = find(name, {type});
    if (!parameter) return nullptr;
    size_t count = parameter->integers.size() + parameter->booleans.size() + parameter->strings.size();
    if (const int per_value = numbers_per_value(type)) count = parameter->numbers.size() / per_value;
    if (count != 1) fail_count(*parameter, count);
    return parameter;
}

std::optional<float> PbrtParameters::optional_number(std::string_view name, PbrtRange range)
{
    const PbrtParameter* parameter = find_single(name, PbrtType::real);
    if (!parameter) return std::nullopt;
    check_range(*parameter, parameter->numbers[0], range);
    return parameter->numbers[0];
}

float PbrtParameters::number(std::string_view name, float fallback, PbrtRange range)
{
    return optional_number(name, range).value_or(fallback);
}

int PbrtParameters::integer(std::string_view name, int fallback, int smallest, int largest)
{
    const PbrtParameter* parameter = find_single(name, PbrtType::integer);
    if (!parameter) return fallback;
    const int value = parameter->integers[0];
    if (value < smallest || value > largest)
        throw UserError(parameter->where(), fmt::format("parameter '{}' must be between {} and {}, got {}", name,
                                                        smallest, largest, value));
    return value;
}

bool PbrtParameters::boolean(std::string_view name, bool fallback)
{
    const PbrtParameter* parameter = find_single(name, PbrtType::boolean);
    return parameter ? parameter->booleans[0] != 0 : fallback;
}

std::string PbrtParameters::string(std::string_view name, std::string_view fallback)
{
    const PbrtParameter* parameter = find_single(name, PbrtType::string);
    return parameter ? parameter->strings[0] : std::string(fallback);
}

size_t PbrtParameters::word(std::string_view name, size_t fallback, std::span<const std::string_view> words)
{
    const PbrtParameter* parameter = find_single(name, PbrtType::string);
    if (!parameter) return fallback;
    const std::string& value = parameter->strings[0];
    const auto found = std::find(words.begin(), words.end(), value);
    if (found == words.end()) {
        constexpr size_t few = 8;
        const std::string known = words.size() <= few ? fmt::format(" (known: {})", fmt::join(words, ", ")) : "";
        throw UserError(parameter->where(), fmt::format("unknown {} '{}' of {}{}{}", name, shown(value), what_, known,
                                                        suggest(value, words)));
    }
    return static_cast<size_t>(found - words.begin());
}

std::filesystem::path PbrtParameters::file(std::string_view name)
{
    const std::string text = string(name, "");
    return text.empty() ? std::filesystem::path() : context_->resolve(text);
}

Vec3 PbrtParameters::point(std::string_view name, const Vec3& fallback)
{
    const PbrtParameter* parameter = find_single(name, PbrtType::point3);
    return parameter ? to_triples(parameter->numbers)[0] : fallback;
}

Vec3 PbrtParameters::vector(std::string_view name, const Vec3& fallback)
{
    const PbrtParameter* parameter = find_single(name, PbrtType::vector3);
    return parameter ? to_triples(parameter->numbers)[0] : fallback;
}

std::vector<float> PbrtParameters::numbers(std::string_view name)
{
    const PbrtParameter* parameter = find(name, {PbrtType::real});
    return parameter ? parameter->numbers : std::vector<float>();
}

std::vector<int> PbrtParameters::integers(std::string_view name)
{
    const PbrtParameter* parameter = find(name, {PbrtType::integer});
    return parameter ? parameter->integers : std::vector<int>();
}

std::vector<std::string> PbrtParameters::strings(std::string_view name)
{
    const PbrtParameter* parameter = find(name, {PbrtType::string});
    return parameter ? parameter->strings : std::vector<std::string>();
}

std::vector<Vec2> PbrtParameters::points2(std::string_view name)
{
    const PbrtParameter* parameter = find(name, {PbrtType::point2});
    if (!parameter) return {};
    std::vector<Vec2> result(parameter->numbers.size() / 2);
    for (size_t i = 0; i < result.size(); ++i)
        result[i] = Vec2(parameter->numbers[2 * i], parameter->numbers[2 * i + 1]);
    return result;
}

std::vector<Vec3> PbrtParameters::triples(std::string_view name, PbrtType type)
{
    const PbrtParameter* parameter = find(name, {type});
    return parameter ? to_triples(parameter->numbers) : std::vector<Vec3>();
}

std::vector<Vec3> PbrtParameters::points(std::string_view name) { return triples(name, PbrtType::point3); }
std::vector<Vec3> PbrtParameters::normals(std::string_view name) { return triples(name, PbrtType::normal); }
std::vector<Vec3> PbrtParameters::vectors(std::string_view name) { return triples(name, PbrtType::vector3); }
std::vector<Vec3> PbrtParameters::colors(std::string_view name) { return triples(name, PbrtType::rgb); }

scene::SpectrumSource PbrtParameters::named_spectrum(const PbrtParameter& parameter)
{
    const std::string& name = parameter.strings[0];
    const SourceLocation where = parameter.where();
    if (scene::contains(scene::spectrum_names(), name)) return scene::SpectrumSource(scene::Named{name}, where);

    const std::filesystem::path path = context_->resolve(name);
    std::error_code error;
    const bool is_file = context_->limits().other_files && std::filesystem::is_regular_file(path, error);
    if (!is_file)
        throw UserError(where, fmt::format("spectrum '{}' is neither a known name nor a file{}", shown(name),
                                           named_spectrum_hint(name)));
    return scene::SpectrumSource(read_spd(path, where), where);
}

scene::SpectrumSource PbrtParameters::to_spectrum(const PbrtParameter& parameter, SpectrumMeaning meaning)
{
    const SourceLocation where = parameter.where();
    const std::vector<float>& numbers = parameter.numbers;
    const std::string name = shown(parameter.name);
    if (parameter.type == PbrtType::real) {
        if (numbers.size() != 1) fail_count(parameter, numbers.size());
        return scene::SpectrumSource(scene::Constant{numbers[0]}, where);
    }
    if (parameter.type == PbrtType::rgb) {
        if (numbers.size() != 3) fail_count(parameter, numbers.size() / 3);
        const Vec3 rgb(numbers[0], numbers[1], numbers[2]);
        if (rgb.x < 0 || rgb.y < 0 || rgb.z < 0)
            throw UserError(where, fmt::format("rgb parameter '{}' must not be negative", name));
        if (meaning == SpectrumMeaning::reflectance && max_component(rgb) > 1.0f)
            throw UserError(where, fmt::format("rgb parameter '{}' is a reflectance and must not exceed 1", name));
        return scene::SpectrumSource(scene::Rgb{rgb, parameter.color_space}, where);
    }
    if (parameter.type == PbrtType::blackbody) {
        if (numbers.size() == 2)
            throw UserError(where, fmt::format("blackbody '{}' takes one temperature; pbrt-v3's scale after it is now "
                                               "the parameter 'scale' of the light",
                                               name));
        if (numbers.size() != 1) fail_count(parameter, numbers.size());
        check_range(parameter, numbers[0], PbrtRange::positive);
        return scene::SpectrumSource(scene::Blackbody{numbers[0]}, where);
    }
    if (parameter.strings.size() == 1) return named_spectrum(parameter);
    if (numbers.empty()) fail_count(parameter, parameter.strings.size());
    return scene::SpectrumSource(spectrum_samples(numbers, where), where);
}

std::optional<scene::SpectrumSource> PbrtParameters::spectrum_of(std::string_view name, SpectrumMeaning meaning,
                                                                 bool or_number)
{
    const PbrtParameter* parameter =
        or_number ? find(name, {PbrtType::real, PbrtType::rgb, PbrtType::spectrum, PbrtType::blackbody})
                  : find(name, {PbrtType::rgb, PbrtType::spectrum, PbrtType::blackbody});
    if (!parameter) return std::nullopt;
    return to_spectrum(*parameter, meaning);
}

std::optional<scene::SpectrumSource> PbrtParameters::spectrum(std::string_view name, SpectrumMeaning meaning)
{
    return spectrum_of(name, meaning, false);
}

std::optional<scene::SpectrumSource> PbrtParameters::spectrum_or_number(std::string_view name, SpectrumMeaning meaning)
{
    return spectrum_of(name, meaning, true);
}

std::optional<scene::SpectrumInput> PbrtParameters::optional_spectrum_input(std::string_view name,
                                                                            SpectrumMeaning meaning)
{
    const PbrtParameter* parameter =
        find(name, {PbrtType::rgb, PbrtType::spectrum, PbrtType::blackbody, PbrtType::texture});
    if (!parameter) return std::nullopt;
    scene::SpectrumInput input;
    if (parameter->type == PbrtType::texture) {
        input.texture =
            find_texture(*parameter, context_->spectrum_textures, context_->float_textures, "spectrum", "float");
        input.value.at = parameter->where();
    } else {
        input.value = to_spectrum(*parameter, meaning);
    }
    return input;
}

scene::SpectrumInput PbrtParameters::spectrum_input(std::string_view name, scene::SpectrumInput fallback,
                                                    SpectrumMeaning meaning)
{
    return optional_spectrum_input(name, meaning).value_or(std::move(fallback));
}

std::optional<scene::FloatInput> PbrtParameters::optional_float_input(std::string_view name)
{
    const PbrtParameter* parameter = find(name, {PbrtType::real, PbrtType::texture});
    if (!parameter) return std::nullopt;
    scene::FloatInput input;
    input.at = parameter->where();
    if (parameter->type == PbrtType::texture) {
        input.texture =
            find_texture(*parameter, context_->float_textures, context_->spectrum_textures, "float", "spectrum");
    } else {
        if (parameter->numbers.size() != 1) fail_count(*parameter, parameter->numbers.size());
        input.value = parameter->numbers[0];
    }
    return input;
}

scene::FloatInput PbrtParameters::float_input(std::string_view name, float fallback)
{
    return optional_float_input(name).value_or(scene::FloatInput(fallback));
}

std::string PbrtParameters::texture_name(std::string_view name)
{
    const PbrtParameter* parameter = find_own(name);
    if (!parameter) parameter = find_default(name, {PbrtType::texture});
    if (!parameter || parameter->type != PbrtType::texture) return {};
    asked_.push_back(name);
    if (parameter->strings.size() != 1) fail_count(*parameter, parameter->strings.size());
    return parameter->strings[0];
}

}  // namespace dapple
