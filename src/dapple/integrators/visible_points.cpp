#include "dapple/integrators/visible_points.h"

#include "dapple/base/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace dapple {
namespace {

// Diagonal of the box round all shapes [m]; 0 where there are none.
float scene_size(const World& world)
{
    const Vec3 diagonal = world.bounds.max - world.bounds.min;
    return is_finite(diagonal) && diagonal.x >= 0.0f ? length(diagonal) : 0.0f;
}

}  // namespace

VisiblePointSettings::VisiblePointSettings(const World& world, const Settings& settings, std::string_view integrator)
    : paths_(settings.integer_or("photons", 0)),
      radius_pixels_(static_cast<float>(settings.number("radius"))),
      fixed_radius_(static_cast<float>(settings.number_or("fixedradius", 0.0))),
      alpha_(settings.number("alpha")),
      kernel_(kernel_named(settings.word("kernel"))),
      wavelength_sets_(static_cast<int>(settings.integer("wavelengthsets"))),
      max_depth_(static_cast<int>(settings.integer("maxdepth"))),
      moving_(MovingShapes(world).any())
{
    if (alpha_ > 1.0) throw UserError("setting 'alpha' must not be above 1: radii would grow");
    refuse_media(world, integrator);
}

int64_t VisiblePointSettings::paths(Int2 resolution, ColorModel model) const
{
    return paths_ > 0 ? paths_ : std::max<int64_t>(25'000, int64_t(resolution.x) * resolution.y * sets(model));
}

std::vector<PassSet> VisiblePointSettings::sets_of_pass(const PassContext& context, ColorModel model,
                                                        int64_t paths) const
{
    const int count = sets(model);
    std::vector<PassSet> sets(static_cast<size_t>(count));
    for (int i = 0; i < count; ++i) {
        PassSet& set = sets[static_cast<size_t>(i)];
        set.wavelengths = wavelengths_of_set(model, context.seed, context.pass, i, count);
        if (moving_) set.time = time_of_set(context.seed, context.pass, i, count);
        PhotonRequest& photons = set.photons;
        photons.wavelengths = set.wavelengths;
        photons.seed = context.seed;
        photons.stream = hash_words(static_cast<uint64_t>(StreamPurpose::photon), uint64_t(context.pass), uint64_t(i));
        photons.paths = std::max<int64_t>(1, paths / count);
        photons.keep_direct = false;
        photons.max_depth = max_depth_;
        photons.time = set.time;
        photons.cancel = context.cancel;
    }
    return sets;
}

std::vector<std::string> VisiblePointSettings::describe(const World& world) const
{
    std::vector<std::string> lines;
    if (fixed_radius_ > 0.0f)
        lines.push_back(fmt::format("photons within {:.3g} scene units in the first pass", fixed_radius_));
    else
        lines.push_back(fmt::format(
            "photons within {:.3g} px in the first pass: {:.3g} scene units at a distance of {:.3g} (half the scene's "
            "size)",
            radius_pixels_, first_radius(world.camera, 0.5f * scene_size(world)), 0.5f * scene_size(world)));
    lines.push_back(fmt::format("radii fall as pass^{:.3g}; {} kernel", 0.5f * (alpha_ - 1.0f),
                                kernel_names[static_cast<size_t>(kernel_)]));
    lines.push_back("light paths per pass: " +
                    (paths_ > 0 ? std::to_string(paths_)
                                : "one per pixel of the full image for each set of wavelengths, at least 25000"));
    if (moving_) lines.push_back("shapes move: each pass shows them at a few times, and passes average these");
    return lines;
}

Spectrum photon_radiance(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi, const Spectrum& flux, PathClass path_class,
                         bool from_delta_light, float weight)
{
    const Spectrum f = evaluate(bsdf, wo, wi, TransportMode::radiance);
    if (f.is_black()) return f;
    float share = 1.0f;
    const bool caustic = path_class == PathClass::caustic;
    if (!bsdf.is_matte() && !(caustic && from_delta_light)) {
        const float density = pdf(bsdf, wo, wi, TransportMode::radiance);
        share = 1.0f - (caustic ? eye_share_of_caustic(density) : narrow_share(density));
    }
    return f * flux * (weight * share * shading_per_area(bsdf, wi));
}

}  // namespace dapple
