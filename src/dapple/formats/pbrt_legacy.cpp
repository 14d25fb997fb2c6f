// The changes are those of the pbrt-v4 user's guide and of pbrt --upgrade.
#include "dapple/formats/pbrt_legacy.h"

#include <fmt/format.h>

namespace dapple {
namespace {

struct LegacyWord {
    LegacyKind kind;
    std::string_view word;
    std::string_view advice;
};

constexpr LegacyWord words[] = {
    {LegacyKind::directive, "SurfaceIntegrator", "pbrt-v2's SurfaceIntegrator is now Integrator"},
    {LegacyKind::directive, "VolumeIntegrator", "pbrt-v2's VolumeIntegrator is now part of Integrator \"volpath\""},
    {LegacyKind::directive, "Volume", "pbrt-v2's Volume is now MakeNamedMedium and MediumInterface"},
    {LegacyKind::directive, "Renderer", "pbrt-v2's Renderer is now Integrator"},
    {LegacyKind::directive, "SearchPath", "pbrt-v1's SearchPath is gone: paths are relative to the scene file"},
    {LegacyKind::parameter_type, "color", "pbrt-v3's type 'color' is now 'rgb'"},
    {LegacyKind::parameter_type, "xyz", "pbrt-v3's type 'xyz' is gone: convert the values and write 'rgb'"},
    {LegacyKind::film, "image", "pbrt-v3's film 'image' is now 'rgb'"},
    {LegacyKind::sampler, "lowdiscrepancy", "pbrt-v3's sampler 'lowdiscrepancy' is now 'paddedsobol'"},
    {LegacyKind::sampler, "02sequence", "pbrt-v3's sampler '02sequence' is now 'paddedsobol'"},
    {LegacyKind::sampler, "maxmindist", "pbrt-v3's sampler 'maxmindist' is now 'pmj02bn'"},
    {LegacyKind::sampler, "random", "pbrt-v3's sampler 'random' is now 'independent'"},
    {LegacyKind::material, "matte", "pbrt-v3's material 'matte' is now 'diffuse', its 'Kd' is 'reflectance'"},
    {LegacyKind::material, "plastic", "pbrt-v3's material 'plastic' is now 'coateddiffuse', its 'Kd' is 'reflectance'"},
    {LegacyKind::material, "glass", "pbrt-v3's material 'glass' is now 'dielectric', its 'index' is 'eta'"},
    {LegacyKind::material, "metal", "pbrt-v3's material 'metal' is now 'conductor'"},
    {LegacyKind::material, "mirror", "pbrt-v3's material 'mirror' is now 'conductor', its 'Kr' is 'reflectance'"},
    {LegacyKind::material, "translucent", "pbrt-v3's material 'translucent' is now 'diffusetransmission'"},
    {LegacyKind::material, "substrate",
     "pbrt-v3's material 'substrate' is now 'coateddiffuse', its 'Kd' is 'reflectance'"},
    {LegacyKind::material, "uber", "pbrt-v3's material 'uber' is gone: use 'coateddiffuse', 'dielectric' or 'mix'"},
    {LegacyKind::material, "disney", "pbrt-v3's material 'disney' is gone: use 'coateddiffuse' or 'coatedconductor'"},
    {LegacyKind::material, "fourier", "pbrt-v3's material 'fourier' is gone: use 'coateddiffuse' or 'conductor'"},
    {LegacyKind::material, "kdsubsurface", "pbrt-v3's material 'kdsubsurface' is now 'subsurface'"},
    {LegacyKind::material, "shinymetal", "pbrt-v2's material 'shinymetal' is now 'conductor'"},
    {LegacyKind::shape, "cone", "pbrt-v3's shape 'cone' is gone: use a 'trianglemesh'"},
    {LegacyKind::shape, "paraboloid", "pbrt-v3's shape 'paraboloid' is gone: use a 'trianglemesh'"},
    {LegacyKind::shape, "hyperboloid", "pbrt-v3's shape 'hyperboloid' is gone: use a 'trianglemesh'"},
    {LegacyKind::shape, "heightfield", "pbrt-v3's shape 'heightfield' is gone: use a 'trianglemesh'"},
    {LegacyKind::shape, "nurbs", "pbrt-v3's shape 'nurbs' is gone: use a 'trianglemesh'"},
    {LegacyKind::area_light, "area", "pbrt-v3's area light 'area' is now 'diffuse'"},
    {LegacyKind::texture_type, "color", "pbrt-v3's texture type 'color' is now 'spectrum'"},
    {LegacyKind::parameter, "Kd", "pbrt-v3's parameter 'Kd' is now 'reflectance'"},
    {LegacyKind::parameter, "Kr", "pbrt-v3's parameter 'Kr' is now 'reflectance' of a 'conductor'"},
    {LegacyKind::parameter, "Kt",
     "pbrt-v3's parameter 'Kt' is gone: a 'dielectric' transmits what it does not reflect"},
    {LegacyKind::parameter, "Ks", "pbrt-v3's parameter 'Ks' is gone: the index 'eta' sets the reflection"},
    {LegacyKind::parameter, "index", "pbrt-v3's parameter 'index' is now 'eta'"},
    {LegacyKind::parameter, "bumpmap", "pbrt-v3's parameter 'bumpmap' is now 'displacement'"},
    {LegacyKind::parameter, "mapname", "pbrt-v3's parameter 'mapname' is now 'filename' (equal-area map)"},
    {LegacyKind::parameter, "nsamples", "pbrt-v3's parameter 'nsamples' is gone: leave it out"},
    {LegacyKind::parameter, "samples", "pbrt-v3's parameter 'samples' is gone: leave it out"},
    {LegacyKind::parameter, "xwidth", "pbrt-v3's parameter 'xwidth' is now 'xradius'"},
    {LegacyKind::parameter, "ywidth", "pbrt-v3's parameter 'ywidth' is now 'yradius'"},
    {LegacyKind::parameter, "maxsampleluminance",
     "pbrt-v3's parameter 'maxsampleluminance' is now 'maxcomponentvalue'"},
    {LegacyKind::parameter, "trilinear", "pbrt-v3's parameter 'trilinear' is now 'string filter' \"trilinear\""},
    {LegacyKind::parameter, "st", "pbrt-v3's parameter 'st' is now 'point2 uv'"},
    {LegacyKind::parameter, "nlevels", "pbrt-v3's parameter 'nlevels' is now 'levels'"},
    {LegacyKind::parameter, "amount", "pbrt-v3's spectrum 'amount' of a mix is now 'float amount'"},
};

}  // namespace

std::string legacy_hint(LegacyKind kind, std::string_view word)
{
    for (const LegacyWord& entry : words)
        if (entry.kind == kind && entry.word == word) return fmt::format("; {}", entry.advice);
    return {};
}

}  // namespace dapple
