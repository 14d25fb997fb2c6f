// The parameter list of a pbrt directive ("type name" value ...), with typed look-ups. A look-up notes what it asked
// for, so that finish() can name a parameter that nothing asked for, and the nearest known one.
#pragma once

#include "dapple/formats/pbrt_context.h"
#include "dapple/formats/pbrt_lexer.h"
#include "dapple/scene/values.h"

#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dapple {

enum class PbrtType : uint8_t {
    integer,
    real,
    point2,
    vector2,
    point3,
    vector3,
    normal,
    boolean,
    string,
    rgb,
    blackbody,
    spectrum,
    texture,
};
std::string_view type_word(PbrtType type);

// Numbers that one value of a type takes: 3 for a point, 0 where any number of numbers goes (spectra).
int numbers_per_value(PbrtType type);

// One parameter; only the array of its type holds values (a spectrum: numbers or strings).
struct PbrtParameter {
    PbrtType type = PbrtType::real;
    std::string name;
    std::vector<float> numbers;
    std::vector<int> integers;
    std::vector<uint8_t> booleans;
    std::vector<std::string> strings;
    const char* at = nullptr;  // of the quoted "type name"
    std::shared_ptr<const SourceText> source;
    scene::ColorSpace color_space = scene::ColorSpace::srgb;

    SourceLocation where() const { return source->locate(at); }
};

// Reads parameters until something comes that is not a quoted string.
std::vector<PbrtParameter> read_parameters(PbrtLexer& lexer, scene::ColorSpace color_space);

enum class PbrtRange : uint8_t { any, positive, not_negative, unit };  // unit: [0, 1]
enum class SpectrumMeaning : uint8_t { reflectance, unbounded, light };

class PbrtParameters {
public:
    // `what` names the owner in messages ("shape 'sphere'"). `defaults` come from Attribute directives: they rank below
    // the own ones and need not be used.
    PbrtParameters(PbrtContext& context, std::string what, SourceLocation at, std::vector<PbrtParameter> own,
                   std::shared_ptr<const std::vector<PbrtParameter>> defaults = nullptr);

    const std::string& what() const { return what_; }
    const SourceLocation& at() const { return at_; }
    PbrtContext& context() { return *context_; }
    bool has(std::string_view name);

    // Single values: the fallback when not given; a UserError for another type, number of values or range.
    float number(std::string_view name, float fallback, PbrtRange range = PbrtRange::any);
    std::optional<float> optional_number(std::string_view name, PbrtRange range = PbrtRange::any);
    int integer(std::string_view name, int fallback, int smallest, int largest);
    bool boolean(std::string_view name, bool fallback);
    std::string string(std::string_view name, std::string_view fallback);
    // The index into `words` of the string given.
    size_t word(std::string_view name, size_t fallback, std::span<const std::string_view> words);
    // A path, resolved against the scene's folder; empty when not given.
    std::filesystem::path file(std::string_view name);
    Vec3 point(std::string_view name, const Vec3& fallback);
    Vec3 vector(std::string_view name, const Vec3& fallback);

    // Arrays: empty when not given.
    std::vector<float> numbers(std::string_view name);
    std::vector<int> integers(std::string_view name);
    std::vector<std::string> strings(std::string_view name);
    std::vector<Vec2> points2(std::string_view name);
    std::vector<Vec3> points(std::string_view name);
    std::vector<Vec3> normals(std::string_view name);
    std::vector<Vec3> vectors(std::string_view name);
    std::vector<Vec3> colors(std::string_view name);

    // Spectra and inputs that a texture may stand in for.
    std::optional<scene::SpectrumSource> spectrum(std::string_view name, SpectrumMeaning meaning);
    // As spectrum(), and a float is taken too (indices of refraction).
    std::optional<scene::SpectrumSource> spectrum_or_number(std::string_view name, SpectrumMeaning meaning);
    std::optional<scene::SpectrumInput> optional_spectrum_input(std::string_view name, SpectrumMeaning meaning);
    scene::SpectrumInput spectrum_input(std::string_view name, scene::SpectrumInput fallback, SpectrumMeaning meaning);
    std::optional<scene::FloatInput> optional_float_input(std::string_view name);
    scene::FloatInput float_input(std::string_view name, float fallback);
    // The name of a texture parameter without looking it up; empty when not given or not a texture.
    std::string texture_name(std::string_view name);

    // Warns that a known parameter has no meaning here, when it is given with any type.
    void ignore(std::string_view name, std::string_view why);
    // Accepts everything that is left (for what is not supported as a whole, or passed on by own()).
    void ignore_rest() { ignore_rest_ = true; }
    const std::vector<PbrtParameter>& own() const { return own_; }

    // Where a parameter was written, or the owner's place.
    SourceLocation where(std::string_view name) const;
    // Throws for the first parameter that nothing asked for.
    void finish();

private:
    // The last parameter of this name, own ones first; throws when it has none of these types.
    const PbrtParameter* find(std::string_view name, std::initializer_list<PbrtType> types);
    const PbrtParameter* find_own(std::string_view name) const;
    const PbrtParameter* find_default(std::string_view name, std::initializer_list<PbrtType> types) const;
    // As find(), for a single value of so many numbers.
    const PbrtParameter* find_single(std::string_view name, PbrtType type);
    scene::SpectrumSource to_spectrum(const PbrtParameter& parameter, SpectrumMeaning meaning);
    scene::SpectrumSource named_spectrum(const PbrtParameter& parameter);
    std::optional<scene::SpectrumSource> spectrum_of(std::string_view name, SpectrumMeaning meaning, bool or_number);
    std::vector<Vec3> triples(std::string_view name, PbrtType type);

    PbrtContext* context_;
    std::string what_;
    SourceLocation at_;
    std::vector<PbrtParameter> own_;
    std::shared_ptr<const std::vector<PbrtParameter>> defaults_;
    std::vector<std::string_view> asked_;  // string literals of the callers
    bool ignore_rest_ = false;
};

}  // namespace dapple
