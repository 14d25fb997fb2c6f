// Materials as the compiled world holds them, and how a Bsdf is made from one at a surface point.
#pragma once

#include "dapple/materials/bsdf.h"
#include "dapple/materials/texture.h"

#include <vector>

namespace dapple {

struct MaterialTag {};
using MaterialId = Id<MaterialTag>;

// Texture ids that are not valid count as 0; a second roughness that is not, as the first. Defaults are the reader's.
struct Material {
    enum class Kind : uint8_t {
        interface,
        diffuse,
        diffuse_transmission,
        dielectric,
        thin_dielectric,
        conductor,
        coated_diffuse,
        coated_conductor,
        mix,
    };
    Kind kind = Kind::diffuse;
    bool remap_roughness = true;              // roughness -> alpha = sqrt(roughness), as pbrt does
    bool conductor_from_reflectance = false;  // `reflectance` given in place of eta and k
    uint8_t layer_max_depth = 10;
    uint8_t layer_samples = 1;
    bool pbrt_coat_weights = false;   // see Bsdf
    SpectrumTextureId reflectance;    // diffuse kinds, coats, conductor (as reflectance)
    SpectrumTextureId transmittance;  // diffuse_transmission
    SpectrumTextureId eta;            // conductors (spectrum)
    SpectrumTextureId k;
    SpectrumValue dielectric_eta;                       // dielectrics and coats: constant, or a table (dispersive)
    FloatTextureId u_roughness, v_roughness;            // the only layer, or a conductor's base in a coated conductor
    FloatTextureId coat_u_roughness, coat_v_roughness;  // coats
    FloatTextureId thickness, g;                        // coats
    SpectrumTextureId albedo;                           // coats: of the medium between the layers
    float scale = 1.0f;                                 // diffuse_transmission
    FloatTextureId displacement;                        // bump map [m]
    uint32_t normal_map = Id<int>::none_value;          // image index
    MaterialId mix[2];
    FloatTextureId mix_amount;  // share of mix[1]
};

struct Materials {
    std::vector<Material> list;
    Textures textures;
};

MaterialId follow_mix(const Materials& materials, MaterialId id, const SurfacePoint& at);
// The material met at a point: follows `mix`, choosing by a hash of the point, so that eye and light paths agree.
inline MaterialId resolve_mix(const Materials& materials, MaterialId id, const SurfacePoint& at)
{
    return materials.list[id.value].kind == Material::Kind::mix ? follow_mix(materials, id, at) : id;
}

// Whether make_bsdf looks at the tangents of the surface point: bumped, normal-mapped or anisotropic materials.
bool uses_tangents(const Material& material);
// What textures and lobes look at, of any material that a mix may resolve to.
SurfaceDetail needed_detail(const Materials& materials, MaterialId id);

// The Bsdf at a surface point; applies bump and normal maps to the frame. kept_lane: the lane at which a dispersive
// index is taken (spectral model).
Bsdf make_bsdf(const Materials& materials, const SpectrumPool& pool, MaterialId id, const SurfacePoint& at,
               const Wavelengths& wavelengths, int kept_lane);
// The same in place. Members that `bsdf.kind` has no use for keep what they held.
void make_bsdf(const Materials& materials, const SpectrumPool& pool, MaterialId id, const SurfacePoint& at,
               const Wavelengths& wavelengths, int kept_lane, Bsdf& bsdf);

}  // namespace dapple
