// The graphics state of pbrt: what AttributeBegin saves and AttributeEnd restores.
#pragma once

#include "dapple/formats/pbrt_parameters.h"
#include "dapple/scene/values.h"

#include <array>
#include <memory>
#include <vector>

namespace dapple {

// The current transform at the start and the end of the shutter.
struct TransformPair {
    Matrix4 start, end;
};

// What an Attribute directive sets defaults for.
enum class AttributeTarget : uint8_t { shape, light, material, medium, texture };
inline constexpr std::array<std::string_view, 5> attribute_target_words = {"shape", "light", "material", "medium",
                                                                           "texture"};

struct GraphicsState {
    TransformPair transform;
    bool start_active = true, end_active = true;  // ActiveTransform
    float start_time = 0.0f, end_time = 1.0f;     // TransformTimes
    bool reverse_orientation = false;
    scene::ColorSpace color_space = scene::ColorSpace::srgb;
    scene::MaterialIndex material{0};
    scene::AreaLightIndex area_light;
    scene::MediumIndex inside, outside;
    bool medium_interface = false;
    // Shared between saved states; replaced, never changed, by the Attribute directive.
    std::array<std::shared_ptr<const std::vector<PbrtParameter>>, attribute_target_words.size()> defaults;

    std::shared_ptr<const std::vector<PbrtParameter>> defaults_for(AttributeTarget target) const
    {
        return defaults[static_cast<size_t>(target)];
    }
};

// The directives that change the current transform. Each reads its numbers; throws UserError for a singular result.
void read_transform_directive(std::string_view word, const char* at, PbrtLexer& lexer, GraphicsState& state);
// The words it knows: Identity, Translate, Scale, Rotate, LookAt, Transform, ConcatTransform.
bool is_transform_directive(std::string_view word);

// The inverse; throws UserError when the matrix is singular, or so nearly that its inverse is meaningless.
Matrix4 inverse_or_throw(const Matrix4& matrix, const SourceLocation& where, std::string_view what);

// The current transform as a moving matrix. Throws UserError when it cannot be inverted.
scene::MovingMatrix current_transform(const GraphicsState& state, const SourceLocation& where);

}  // namespace dapple
