// Lights and area lights of pbrt-v4, with "string lightgroup" as our extension.
#include "dapple/formats/pbrt_builder.h"
#include "dapple/formats/pbrt_legacy.h"

#include <fmt/format.h>

namespace dapple {
namespace {

constexpr std::string_view light_types[] = {"point", "spot", "distant", "infinite", "goniometric", "projection"};

// pbrt takes a power or illuminance that is not positive as not given.
std::optional<float> positive_or_none(PbrtParameters& parameters, std::string_view name)
{
    const std::optional<float> value = parameters.optional_number(name);
    return value && *value > 0.0f ? value : std::nullopt;
}

scene::SpectrumSource light_spectrum(PbrtParameters& parameters, std::string_view name, scene::ColorSpace color_space)
{
    return parameters.spectrum(name, SpectrumMeaning::light)
        .value_or(scene::SpectrumSource(scene::White{color_space}, parameters.at()));
}

void check_apart(const PbrtParameters& parameters, const Vec3& from, const Vec3& to)
{
    if (from == to) throw UserError(parameters.at(), "'from' and 'to' are the same: the light has no direction");
}

scene::SpotLight read_spot(PbrtParameters& parameters, scene::ColorSpace color_space)
{
    scene::SpotLight spot;
    spot.intensity = light_spectrum(parameters, "I", color_space);
    spot.from = parameters.point("from", spot.from);
    spot.to = parameters.point("to", spot.to);
    check_apart(parameters, spot.from, spot.to);
    spot.cone_angle = parameters.number("coneangle", spot.cone_angle, PbrtRange::positive);
    spot.cone_delta_angle = parameters.number("conedeltaangle", spot.cone_delta_angle, PbrtRange::not_negative);
    if (spot.cone_angle > 180.0f)
        throw UserError(parameters.where("coneangle"),
                        fmt::format("parameter 'coneangle' must not exceed 180, got {}", spot.cone_angle));
    return spot;
}

scene::DistantLight read_distant(PbrtParameters& parameters, scene::ColorSpace color_space)
{
    scene::DistantLight distant;
    distant.radiance = light_spectrum(parameters, "L", color_space);
    distant.from = parameters.point("from", distant.from);
    distant.to = parameters.point("to", distant.to);
    check_apart(parameters, distant.from, distant.to);
    distant.illuminance = positive_or_none(parameters, "illuminance");
    return distant;
}

scene::InfiniteLight read_infinite(PbrtParameters& parameters, scene::ColorSpace color_space)
{
    scene::InfiniteLight infinite;
    infinite.radiance = parameters.spectrum("L", SpectrumMeaning::light);
    infinite.file = parameters.file("filename");
    if (infinite.radiance && !infinite.file.empty())
        throw UserError(parameters.at(), "light 'infinite' takes 'L' or 'filename', not both");
    if (!infinite.radiance && infinite.file.empty())
        infinite.radiance = scene::SpectrumSource(scene::White{color_space}, parameters.at());
    infinite.illuminance = positive_or_none(parameters, "illuminance");
    infinite.portal = parameters.points("portal");
    if (!infinite.portal.empty() && infinite.portal.size() != 4)
        throw UserError(parameters.where("portal"),
                        fmt::format("parameter 'portal' takes 4 points, got {}", infinite.portal.size()));
    return infinite;
}

}  // namespace

scene::Light read_light(const std::string& type, PbrtParameters& parameters, scene::ColorSpace color_space)
{
    scene::Light light;
    light.at = parameters.at();
    light.color_space = color_space;
    light.scale = parameters.number("scale", 1.0f, PbrtRange::not_negative);
    light.light_group = parameters.string("lightgroup", "");
    if (type == "point") {
        scene::PointLight point;
        point.intensity = light_spectrum(parameters, "I", color_space);
        point.from = parameters.point("from", point.from);
        light.kind = std::move(point);
    } else if (type == "spot") {
        light.kind = read_spot(parameters, color_space);
    } else if (type == "distant") {
        light.kind = read_distant(parameters, color_space);
    } else if (type == "infinite") {
        light.kind = read_infinite(parameters, color_space);
    } else if (type == "goniometric") {
        light.kind = scene::GoniometricLight{light_spectrum(parameters, "I", color_space), parameters.file("filename")};
    } else if (type == "projection") {
        scene::ProjectionLight projection;
        projection.file = parameters.file("filename");
        projection.fov = parameters.number("fov", 90.0f, PbrtRange::positive);
        if (projection.file.empty()) throw UserError(parameters.at(), "light 'projection' needs a 'filename'");
        if (projection.fov >= 180.0f)
            throw UserError(parameters.where("fov"),
                            fmt::format("parameter 'fov' must be less than 180, got {}", projection.fov));
        light.kind = std::move(projection);
    } else {
        fail_type("light", type, light_types, parameters.at());
    }
    if (type != "distant" && type != "infinite") light.power = positive_or_none(parameters, "power");
    return light;
}

scene::AreaLight read_area_light(const std::string& type, PbrtParameters& parameters, scene::ColorSpace color_space)
{
    constexpr std::string_view types[] = {"diffuse"};
    if (type != "diffuse")
        fail_type("area light", type, types, parameters.at(), legacy_hint(LegacyKind::area_light, type));
    scene::AreaLight light;
    light.at = parameters.at();
    light.color_space = color_space;
    light.radiance = parameters.spectrum("L", SpectrumMeaning::light);
    light.file = parameters.file("filename");
    if (light.radiance && !light.file.empty())
        throw UserError(parameters.at(), "area light 'diffuse' takes 'L' or 'filename', not both");
    light.scale = parameters.number("scale", 1.0f, PbrtRange::not_negative);
    light.power = positive_or_none(parameters, "power");
    light.two_sided = parameters.boolean("twosided", false);
    light.light_group = parameters.string("lightgroup", "");
    return light;
}

}  // namespace dapple
