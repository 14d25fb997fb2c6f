// The directives of pbrt-v4: which words there are, what follows each, and where it may stand.
#include "dapple/formats/pbrt.h"
#include "dapple/formats/pbrt_builder.h"
#include "dapple/formats/pbrt_legacy.h"
#include "dapple/scene/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace dapple {
namespace {

// Where a directive may stand.
enum class Place : uint8_t { anywhere, before_world, in_world };

// The path that tells whether two names mean the same file.
std::filesystem::path canonical_path(const std::filesystem::path& path)
{
    std::error_code error;
    auto result = std::filesystem::weakly_canonical(path, error);
    return error ? path : result;
}

class PbrtReader {
public:
    PbrtReader(std::filesystem::path base_folder, const ReadLimits& limits) : builder_(std::move(base_folder), limits)
    {
    }

    scene::Description read(std::shared_ptr<const SourceText> source, const std::filesystem::path& file)
    {
        const SourceLocation end{source->name(), 0, 0};
        read_source(std::move(source), file);
        return builder_.finish(end);
    }

private:
    using Handler = void (PbrtReader::*)(PbrtLexer& lexer, const SourceLocation& at);
    struct Directive {
        std::string_view word;
        Place place;
        Handler handler;
    };
    static const Directive directives[];

    void read_source(std::shared_ptr<const SourceText> source, const std::filesystem::path& file);
    void read_directive(PbrtLexer& lexer, const PbrtToken& token);
    [[noreturn]] void fail_directive(const PbrtLexer& lexer, const PbrtToken& token) const;
    PbrtParameters read_list(PbrtLexer& lexer, std::string what, const SourceLocation& at,
                             std::shared_ptr<const std::vector<PbrtParameter>> defaults = nullptr);
    std::filesystem::path check_include(const std::string& name, const SourceLocation& at);

    // Reads "Directive "type" parameters" and hands them on.
    template <void (PbrtBuilder::*Make)(const std::string&, PbrtParameters)>
    void typed(PbrtLexer& lexer, std::string_view what, const SourceLocation& at,
               std::shared_ptr<const std::vector<PbrtParameter>> defaults = nullptr)
    {
        const std::string type = lexer.expect_string(fmt::format("the type of the {}", what));
        (builder_.*Make)(type, read_list(lexer, fmt::format("{} '{}'", what, shown(type)), at, std::move(defaults)));
    }
    auto defaults_for(AttributeTarget target) { return builder_.state().defaults_for(target); }

    void transform(PbrtLexer&, const SourceLocation&) {}  // handled before: it needs the word
    void active_transform(PbrtLexer& lexer, const SourceLocation& at);
    void transform_times(PbrtLexer& lexer, const SourceLocation& at);
    void attribute(PbrtLexer& lexer, const SourceLocation& at);
    void color_space(PbrtLexer& lexer, const SourceLocation& at);
    void include(PbrtLexer& lexer, const SourceLocation& at);
    void import(PbrtLexer& lexer, const SourceLocation& at);
    void option(PbrtLexer& lexer, const SourceLocation& at);
    void medium_interface(PbrtLexer& lexer, const SourceLocation& at);
    void make_named_medium(PbrtLexer& lexer, const SourceLocation& at);
    void make_named_material(PbrtLexer& lexer, const SourceLocation& at);
    void texture(PbrtLexer& lexer, const SourceLocation& at);
    void world_end(PbrtLexer&, const SourceLocation& at)
    {
        builder_.context().warn(at, "WorldEnd is not part of pbrt-v4: ignored");
    }
    void transform_begin(PbrtLexer&, const SourceLocation& at)
    {
        builder_.context().warn(at, "TransformBegin is old: it reads as AttributeBegin");
        builder_.push(at);
    }
    void push(PbrtLexer&, const SourceLocation& at) { builder_.push(at); }
    void pop(PbrtLexer&, const SourceLocation& at) { builder_.pop(at); }
    void world_begin(PbrtLexer&, const SourceLocation& at) { builder_.world_begin(at); }
    void reverse_orientation(PbrtLexer&, const SourceLocation&)
    {
        builder_.state().reverse_orientation = !builder_.state().reverse_orientation;
    }
    void object_begin(PbrtLexer& l, const SourceLocation& at) { builder_.object_begin(l.expect_string("a name"), at); }
    void object_end(PbrtLexer&, const SourceLocation& at) { builder_.object_end(at); }
    void object_instance(PbrtLexer& l, const SourceLocation& at)
    {
        builder_.object_instance(l.expect_string("a name"), at);
    }
    void coordinate_system(PbrtLexer& l, const SourceLocation&)
    {
        builder_.coordinate_system(l.expect_string("a name"));
    }
    void coord_sys_transform(PbrtLexer& l, const SourceLocation& at)
    {
        builder_.coordinate_system_transform(l.expect_string("a name"), at);
    }
    void named_material(PbrtLexer& l, const SourceLocation& at)
    {
        builder_.use_material(l.expect_string("a name"), at);
    }
    void camera(PbrtLexer& l, const SourceLocation& at) { typed<&PbrtBuilder::camera>(l, "camera", at); }
    void film(PbrtLexer& l, const SourceLocation& at) { typed<&PbrtBuilder::film>(l, "film", at); }
    void filter(PbrtLexer& l, const SourceLocation& at) { typed<&PbrtBuilder::filter>(l, "filter", at); }
    void sampler(PbrtLexer& l, const SourceLocation& at) { typed<&PbrtBuilder::sampler>(l, "sampler", at); }
    void integrator(PbrtLexer& l, const SourceLocation& at) { typed<&PbrtBuilder::integrator>(l, "integrator", at); }
    void accelerator(PbrtLexer& l, const SourceLocation& at) { typed<&PbrtBuilder::accelerator>(l, "accelerator", at); }
    void shape(PbrtLexer& l, const SourceLocation& at)
    {
        typed<&PbrtBuilder::shape>(l, "shape", at, defaults_for(AttributeTarget::shape));
    }
    void light(PbrtLexer& l, const SourceLocation& at)
    {
        typed<&PbrtBuilder::light>(l, "light", at, defaults_for(AttributeTarget::light));
    }
    void area_light(PbrtLexer& l, const SourceLocation& at)
    {
        typed<&PbrtBuilder::area_light>(l, "area light", at, defaults_for(AttributeTarget::light));
    }
    void material(PbrtLexer& l, const SourceLocation& at)
    {
        typed<&PbrtBuilder::material>(l, "material", at, defaults_for(AttributeTarget::material));
    }

    PbrtBuilder builder_;
    std::vector<std::filesystem::path> open_files_;
    int64_t included_ = 0;
};

const PbrtReader::Directive PbrtReader::directives[] = {
    {"Identity", Place::anywhere, &PbrtReader::transform},
    {"Translate", Place::anywhere, &PbrtReader::transform},
    {"Scale", Place::anywhere, &PbrtReader::transform},
    {"Rotate", Place::anywhere, &PbrtReader::transform},
    {"LookAt", Place::anywhere, &PbrtReader::transform},
    {"Transform", Place::anywhere, &PbrtReader::transform},
    {"ConcatTransform", Place::anywhere, &PbrtReader::transform},
    {"ActiveTransform", Place::anywhere, &PbrtReader::active_transform},
    {"TransformTimes", Place::before_world, &PbrtReader::transform_times},
    {"CoordinateSystem", Place::anywhere, &PbrtReader::coordinate_system},
    {"CoordSysTransform", Place::anywhere, &PbrtReader::coord_sys_transform},
    {"AttributeBegin", Place::in_world, &PbrtReader::push},
    {"AttributeEnd", Place::in_world, &PbrtReader::pop},
    {"TransformBegin", Place::in_world, &PbrtReader::transform_begin},
    {"TransformEnd", Place::in_world, &PbrtReader::pop},
    {"Attribute", Place::anywhere, &PbrtReader::attribute},
    {"ObjectBegin", Place::in_world, &PbrtReader::object_begin},
    {"ObjectEnd", Place::in_world, &PbrtReader::object_end},
    {"ObjectInstance", Place::in_world, &PbrtReader::object_instance},
    {"Include", Place::anywhere, &PbrtReader::include},
    {"Import", Place::in_world, &PbrtReader::import},
    {"Option", Place::before_world, &PbrtReader::option},
    {"ColorSpace", Place::anywhere, &PbrtReader::color_space},
    {"MediumInterface", Place::anywhere, &PbrtReader::medium_interface},
    {"MakeNamedMedium", Place::anywhere, &PbrtReader::make_named_medium},
    {"MakeNamedMaterial", Place::in_world, &PbrtReader::make_named_material},
    {"Material", Place::in_world, &PbrtReader::material},
    {"NamedMaterial", Place::in_world, &PbrtReader::named_material},
    {"Texture", Place::in_world, &PbrtReader::texture},
    {"Shape", Place::in_world, &PbrtReader::shape},
    {"LightSource", Place::in_world, &PbrtReader::light},
    {"AreaLightSource", Place::in_world, &PbrtReader::area_light},
    {"ReverseOrientation", Place::in_world, &PbrtReader::reverse_orientation},
    {"Camera", Place::before_world, &PbrtReader::camera},
    {"Film", Place::before_world, &PbrtReader::film},
    {"PixelFilter", Place::before_world, &PbrtReader::filter},
    {"Sampler", Place::before_world, &PbrtReader::sampler},
    {"Integrator", Place::before_world, &PbrtReader::integrator},
    {"Accelerator", Place::before_world, &PbrtReader::accelerator},
    {"WorldBegin", Place::before_world, &PbrtReader::world_begin},
    {"WorldEnd", Place::in_world, &PbrtReader::world_end},
};

void PbrtReader::read_source(std::shared_ptr<const SourceText> source, const std::filesystem::path& file)
{
    open_files_.push_back(file);
    PbrtLexer lexer(std::move(source));
    for (PbrtToken token = lexer.next(); token.kind != PbrtToken::Kind::end; token = lexer.next())
        read_directive(lexer, token);
    open_files_.pop_back();
}

void PbrtReader::read_directive(PbrtLexer& lexer, const PbrtToken& token)
{
    const auto directive = std::find_if(std::begin(directives), std::end(directives), [&](const Directive& entry) {
        return token.kind == PbrtToken::Kind::word && entry.word == token.text;
    });
    if (directive == std::end(directives)) fail_directive(lexer, token);
    const SourceLocation at = lexer.locate(token.at);
    if (directive->place == Place::before_world && builder_.in_world())
        throw UserError(at, directive->word == "WorldBegin"
                                ? std::string("WorldBegin stands here a second time")
                                : fmt::format("{} must stand before WorldBegin", directive->word));
    if (directive->place == Place::in_world && !builder_.in_world())
        throw UserError(at, fmt::format("{} must stand after WorldBegin", directive->word));
    if (is_transform_directive(directive->word))
        read_transform_directive(directive->word, token.at, lexer, builder_.state());
    else
        (this->*directive->handler)(lexer, at);
}

void PbrtReader::fail_directive(const PbrtLexer& lexer, const PbrtToken& token) const
{
    const SourceLocation at = lexer.locate(token.at);
    const std::string text = shown(token.text);
    if (token.kind != PbrtToken::Kind::word) throw UserError(at, fmt::format("expected a directive, got '{}'", text));
    if (token.text.find_first_not_of("+-.0123456789eE") == token.text.npos)
        throw UserError(at,
                        fmt::format("expected a directive, got the number '{}'; several values need brackets", text));
    std::string hint = legacy_hint(LegacyKind::directive, token.text);
    if (hint.empty()) {
        std::vector<std::string_view> known;
        for (const Directive& directive : directives) known.push_back(directive.word);
        hint = suggest(token.text, known);
    }
    throw UserError(at, fmt::format("unknown directive '{}'{}", text, hint));
}

PbrtParameters PbrtReader::read_list(PbrtLexer& lexer, std::string what, const SourceLocation& at,
                                     std::shared_ptr<const std::vector<PbrtParameter>> defaults)
{
    return PbrtParameters(builder_.context(), std::move(what), at, read_parameters(lexer, builder_.state().color_space),
                          std::move(defaults));
}

void PbrtReader::active_transform(PbrtLexer& lexer, const SourceLocation&)
{
    constexpr std::string_view words[] = {"All", "StartTime", "EndTime"};
    const PbrtToken token = lexer.next();
    if (!scene::contains(words, token.text))
        fail_type("ActiveTransform", std::string(token.text), words, lexer.locate(token.at));
    builder_.state().start_active = token.text != "EndTime";
    builder_.state().end_active = token.text != "StartTime";
}

void PbrtReader::transform_times(PbrtLexer& lexer, const SourceLocation& at)
{
    const auto start = static_cast<float>(lexer.expect_number("2 numbers after TransformTimes"));
    const auto end = static_cast<float>(lexer.expect_number("2 numbers after TransformTimes"));
    if (!(start < end)) throw UserError(at, fmt::format("TransformTimes: {} is not before {}", start, end));
    builder_.state().start_time = start;
    builder_.state().end_time = end;
}

void PbrtReader::attribute(PbrtLexer& lexer, const SourceLocation& at)
{
    const std::string target = lexer.expect_string("what the attribute is for");
    builder_.attribute(target, read_parameters(lexer, builder_.state().color_space), at);
}

void PbrtReader::color_space(PbrtLexer& lexer, const SourceLocation& at)
{
    const std::string name = lexer.expect_string("the name of a colour space");
    const auto space = scene::color_space_from_name(name);
    if (!space) fail_type("colour space", name, scene::color_space_names(), at);
    builder_.state().color_space = *space;
}

std::filesystem::path PbrtReader::check_include(const std::string& name, const SourceLocation& at)
{
    const ReadLimits& limits = builder_.context().limits();
    builder_.context().check_files_allowed(at);
    const std::filesystem::path path = canonical_path(builder_.context().resolve(name));
    if (std::find(open_files_.begin(), open_files_.end(), path) != open_files_.end())
        throw UserError(at, fmt::format("'{}' includes itself", shown(name)));
    if (static_cast<int>(open_files_.size()) > limits.include_depth)
        throw UserError(at, fmt::format("files are included more than {} deep", limits.include_depth));
    if (++included_ > limits.include_count)
        throw UserError(at, fmt::format("more than {} files are included", limits.include_count));
    return path;
}

void PbrtReader::include(PbrtLexer& lexer, const SourceLocation& at)
{
    const std::string name = lexer.expect_string("the name of a file");
    const std::filesystem::path path = check_include(name, at);
    const std::string shown_name = builder_.context().resolve(name).string();
    read_source(std::make_shared<SourceText>(shown_name, read_file(path, at)), path);
}

// An import leaves the graphics state as it was.
void PbrtReader::import(PbrtLexer& lexer, const SourceLocation& at)
{
    const GraphicsState saved = builder_.state();
    const size_t depth = builder_.open_blocks();
    include(lexer, at);
    if (builder_.open_blocks() != depth) throw UserError(at, "the imported file leaves blocks open or closes too many");
    builder_.state() = saved;
}

void PbrtReader::option(PbrtLexer& lexer, const SourceLocation& at)
{
    const std::string name = lexer.expect_string("the name of an option");
    const PbrtToken value = lexer.next();
    if (value.kind == PbrtToken::Kind::end) throw UserError(at, fmt::format("option '{}' has no value", shown(name)));
    builder_.option(name, value, at);
}

void PbrtReader::medium_interface(PbrtLexer& lexer, const SourceLocation& at)
{
    const std::string inside = lexer.expect_string("the name of the medium inside");
    const bool two = lexer.peek().kind == PbrtToken::Kind::string;
    builder_.use_media(inside, two ? lexer.unescape(lexer.next()) : inside, at);
}

void PbrtReader::make_named_medium(PbrtLexer& lexer, const SourceLocation& at)
{
    const std::string name = lexer.expect_string("the name of the medium");
    builder_.medium(
        name, read_list(lexer, fmt::format("medium '{}'", shown(name)), at, defaults_for(AttributeTarget::medium)));
}

void PbrtReader::make_named_material(PbrtLexer& lexer, const SourceLocation& at)
{
    const std::string name = lexer.expect_string("the name of the material");
    builder_.named_material(
        name, read_list(lexer, fmt::format("material '{}'", shown(name)), at, defaults_for(AttributeTarget::material)));
}

void PbrtReader::texture(PbrtLexer& lexer, const SourceLocation& at)
{
    constexpr std::string_view types[] = {"float", "spectrum"};
    const std::string name = lexer.expect_string("the name of the texture");
    const std::string value_type = lexer.expect_string("\"float\" or \"spectrum\"");
    if (!scene::contains(types, value_type))
        fail_type("texture type", value_type, types, at, legacy_hint(LegacyKind::texture_type, value_type));
    const std::string type = lexer.expect_string("the kind of texture");
    builder_.texture(
        name, value_type, type,
        read_list(lexer, fmt::format("texture '{}'", shown(name)), at, defaults_for(AttributeTarget::texture)));
}

}  // namespace

scene::Description read_pbrt(const std::filesystem::path& file, const ReadLimits& limits)
{
    auto source = std::make_shared<SourceText>(file.string(), read_file(file, {}));
    scene::Description description =
        PbrtReader(file.parent_path(), limits).read(std::move(source), canonical_path(file));
    description.files.insert(description.files.begin(), file);
    return description;
}

scene::Description read_pbrt_string(std::string text, const std::string& name, const std::filesystem::path& base_folder,
                                    const ReadLimits& limits)
{
    return PbrtReader(base_folder, limits).read(std::make_shared<SourceText>(name, std::move(text)), {});
}

}  // namespace dapple
