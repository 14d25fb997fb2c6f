// From a material and a point to a Bsdf: textures are looked up, the frame is bumped, the values brought into range.
// Bump mapping: Blinn 1978, "Simulation of wrinkled surfaces", by forward differences as in pbrt-v4 (whose fixed step
// stands in for ray differentials here). An absent texture (invalid id) counts as 0, an absent second roughness as the
// first. Cost: the textures' look-ups; no allocation.

#include "dapple/materials/material.h"

#include "dapple/materials/image_lookup.h"
#include "dapple/math/hash.h"

namespace dapple {

namespace {

constexpr float bump_step = 0.0005f;
// Where the lines of an index of refraction are quoted; the rgb model has no wavelengths of its own.
constexpr float sodium_line = 589.3f;
// More mixes than this below one another are a circle.
constexpr int max_mix_depth = 64;

// A material's textures at a point.
struct Lookup {
    const Textures& textures;
    const SpectrumPool& pool;
    const SurfacePoint& at;
    const Wavelengths& wavelengths;

    float number(FloatTextureId id) const { return id.valid() ? evaluate(textures, id, at) : 0.0f; }
    Spectrum spectrum(SpectrumTextureId id) const
    {
        if (!id.valid()) return Spectrum();
        const TextureNode& node = textures.spectra[id.value];
        if (node.kind == TextureNode::Kind::constant) return pool.evaluate(node.spectrum[0], wavelengths);
        return evaluate(textures, pool, id, at, wavelengths);
    }
    // A share of light, per lane in [0, limit].
    Spectrum share(SpectrumTextureId id, float factor = 1.0f, float limit = 1.0f) const
    {
        Spectrum s = spectrum(id);
        for (float& lane : s.v) lane = std::min(std::max(lane * factor, 0.0f), limit);
        return s;
    }
    Roughness roughness(FloatTextureId u, FloatTextureId v, bool remap) const
    {
        Roughness r{std::max(0.0f, number(u)), 0.0f};
        r.y = v.valid() && v != u ? std::max(0.0f, number(v)) : r.x;
        if (remap) r = {std::sqrt(r.x), std::sqrt(r.y)};
        return r;
    }
};

// The shading normal of a surface displaced along it by a texture, on the side of the geometric normal.
Vec3 bumped_normal(const Textures& textures, FloatTextureId displacement, const SurfacePoint& at)
{
    const Vec3& n = at.n_shading;
    // Not dpdu_shading, which is of unit length and may follow the mesh's own tangents: slopes are per uv.
    const Vec3 dpdu = at.dpdu - n * dot(n, at.dpdu);
    const Vec3 dpdv = at.dpdv - n * dot(n, at.dpdv);
    // Where the parametrisation collapses, slopes along it mean nothing.
    if (!(length_squared(cross(dpdu, dpdv)) > 0.0f)) return n;
    SurfacePoint shifted = at;
    shifted.position = at.position + dpdu * bump_step;
    shifted.uv.x = at.uv.x + bump_step;
    const float along_u = evaluate(textures, displacement, shifted);
    shifted.position = at.position + dpdv * bump_step;
    shifted.uv = Vec2(at.uv.x, at.uv.y + bump_step);
    const float along_v = evaluate(textures, displacement, shifted);
    const float here = evaluate(textures, displacement, at);
    const Vec3 u = dpdu + n * ((along_u - here) / bump_step) + at.dndu * here;
    const Vec3 v = dpdv + n * ((along_v - here) / bump_step) + at.dndv * here;
    const Vec3 raw = cross(u, v);
    const float len = length(raw);
    return len > 0.0f && std::isfinite(len) ? face_forward(raw * (1.0f / len), at.n_geometric) : n;
}

// The normal of a tangent-space normal map, components stored as (n + 1) / 2.
Vec3 mapped_normal(const Image& map, const SurfacePoint& at)
{
    const ImageLookup pixels(map, at.uv, ImageFilter::bilinear, ImageWrap::repeat);
    Vec3 local(2.0f * pixels.channel(0) - 1.0f, 2.0f * pixels.channel(1) - 1.0f, 2.0f * pixels.channel(2) - 1.0f);
    const float len = length(local);
    if (!(len > 0.0f && std::isfinite(len))) return at.n_shading;
    local *= 1.0f / len;
    return face_forward(Frame::from_normal_tangent(at.n_shading, at.dpdu_shading).to_world(local), at.n_geometric);
}

Frame shading_frame(const Materials& materials, const Material& material, const SurfacePoint& at)
{
    if (!uses_tangents(material)) return Frame(at.n_shading);
    Vec3 n = at.n_shading;
    if (material.normal_map != Id<int>::none_value)
        n = mapped_normal(materials.textures.images[material.normal_map], at);
    else if (material.displacement.valid())
        n = bumped_normal(materials.textures, material.displacement, at);
    return Frame::from_normal_tangent(n, at.dpdu_shading);
}

void set_dielectric(Bsdf& bsdf, const Material& material, const SpectrumPool& pool, const Wavelengths& wavelengths,
                    int kept_lane)
{
    const bool table = material.dielectric_eta.kind != SpectrumValue::Kind::constant;
    if (!table) {
        bsdf.eta = material.dielectric_eta.scale;
    } else if (wavelengths.model == ColorModel::spectral) {
        bsdf.eta = pool.evaluate(material.dielectric_eta, wavelengths.lambda[kept_lane]);
        bsdf.dispersive = true;
    } else {
        bsdf.eta = pool.evaluate(material.dielectric_eta, sodium_line);
    }
    // Outside of the wavelengths of its table an index is 0: as good as absent.
    if (!(bsdf.eta > 0.0f)) bsdf.eta = 1.0f;
}

// eta and k; relative to the index of a coat above it (1: none).
void set_conductor(Bsdf& bsdf, const Material& material, const Lookup& look, float coat_eta)
{
    if (material.conductor_from_reflectance) {
        // The k that reflects r at normal incidence with eta = 1; r = 1 would need an infinite one.
        const Spectrum r = look.share(material.reflectance, 1.0f, 0.9999f);
        bsdf.a = Spectrum(1.0f);
        bsdf.b = safe_divide(2.0f * sqrt(r), sqrt(Spectrum(1.0f) - r));
    } else {
        bsdf.a = look.spectrum(material.eta);
        bsdf.b = look.spectrum(material.k);
    }
    bsdf.a /= coat_eta;
    bsdf.b /= coat_eta;
}

void set_layers(Bsdf& bsdf, const Material& material, const Lookup& look)
{
    bsdf.layer_max_depth = material.layer_max_depth;
    bsdf.layer_samples = material.layer_samples;
    bsdf.pbrt_coat_weights = material.pbrt_coat_weights;
    bsdf.layer_thickness = std::max(0.0f, look.number(material.thickness));
    bsdf.layer_g = std::clamp(look.number(material.g), -1.0f, 1.0f);
    bsdf.layer_albedo = look.share(material.albedo);
    const Vec3& p = look.at.position;
    bsdf.layer_seed = static_cast<uint32_t>(hash_words(float_bits(p.x), float_bits(p.y), float_bits(p.z)));
}

}  // namespace

MaterialId follow_mix(const Materials& materials, MaterialId id, const SurfacePoint& at)
{
    for (int depth = 0; depth < max_mix_depth; ++depth) {
        const Material& material = materials.list[id.value];
        if (material.kind != Material::Kind::mix) return id;
        const float amount = evaluate(materials.textures, material.mix_amount, at);
        const Vec3& p = at.position;
        const float u = to_unit_float(hash_words(float_bits(p.x), float_bits(p.y), float_bits(p.z),
                                                 material.mix[0].value, material.mix[1].value));
        id = material.mix[u < amount ? 1 : 0];
    }
    return id;
}

bool uses_tangents(const Material& material)
{
    const auto differ = [](FloatTextureId u, FloatTextureId v) { return v.valid() && v != u; };
    return material.displacement.valid() || material.normal_map != Id<int>::none_value ||
           differ(material.u_roughness, material.v_roughness) ||
           differ(material.coat_u_roughness, material.coat_v_roughness);
}

namespace {

// Whether some texture of the material may change from point to point.
bool is_textured(const Textures& textures, const Material& material)
{
    for (const SpectrumTextureId id :
         {material.reflectance, material.transmittance, material.eta, material.k, material.albedo})
        if (id.valid() && textures.spectra[id.value].kind != TextureNode::Kind::constant) return true;
    for (const FloatTextureId id : {material.u_roughness, material.v_roughness, material.coat_u_roughness,
                                    material.coat_v_roughness, material.thickness, material.g, material.mix_amount})
        if (id.valid() && textures.floats[id.value].kind != TextureNode::Kind::constant) return true;
    return false;
}

}  // namespace

SurfaceDetail needed_detail(const Materials& materials, MaterialId id)
{
    SurfaceDetail detail = SurfaceDetail::bare;
    // Materials of a mix come before it or after it, and mixes may form a circle: each is looked at once.
    std::vector<bool> seen(materials.list.size(), false);
    std::vector<MaterialId> open{id};
    while (!open.empty()) {
        const MaterialId next = open.back();
        open.pop_back();
        if (!next.valid() || seen[next.value]) continue;
        seen[next.value] = true;
        const Material& material = materials.list[next.value];
        if (material.kind != Material::Kind::mix && uses_tangents(material)) return SurfaceDetail::tangents;
        if (is_textured(materials.textures, material)) detail = SurfaceDetail::no_tangents;
        if (material.kind == Material::Kind::mix) open.insert(open.end(), {material.mix[0], material.mix[1]});
    }
    return detail;
}

Bsdf make_bsdf(const Materials& materials, const SpectrumPool& pool, MaterialId id, const SurfacePoint& at,
               const Wavelengths& wavelengths, int kept_lane)
{
    Bsdf bsdf;
    make_bsdf(materials, pool, id, at, wavelengths, kept_lane, bsdf);
    return bsdf;
}

void make_bsdf(const Materials& materials, const SpectrumPool& pool, MaterialId id, const SurfacePoint& at,
               const Wavelengths& wavelengths, int kept_lane, Bsdf& bsdf)
{
    const Material& material = materials.list[resolve_mix(materials, id, at).value];
    const Lookup look{materials.textures, pool, at, wavelengths};
    bsdf.dispersive = false;
    bsdf.n_geometric = at.n_geometric;
    bsdf.frame = shading_frame(materials, material, at);
    switch (material.kind) {
        case Material::Kind::interface: bsdf.kind = BsdfKind::interface; break;
        case Material::Kind::diffuse:
            bsdf.kind = BsdfKind::diffuse;
            bsdf.a = look.share(material.reflectance);
            break;
        case Material::Kind::diffuse_transmission:
            bsdf.kind = BsdfKind::diffuse_transmission;
            bsdf.a = look.share(material.reflectance, material.scale);
            bsdf.b = look.share(material.transmittance, material.scale);
            break;
        case Material::Kind::dielectric:
            bsdf.kind = BsdfKind::dielectric;
            set_dielectric(bsdf, material, pool, wavelengths, kept_lane);
            bsdf.roughness = look.roughness(material.u_roughness, material.v_roughness, material.remap_roughness);
            break;
        case Material::Kind::thin_dielectric:
            bsdf.kind = BsdfKind::thin_dielectric;
            set_dielectric(bsdf, material, pool, wavelengths, kept_lane);
            break;
        case Material::Kind::conductor:
            bsdf.kind = BsdfKind::conductor;
            set_conductor(bsdf, material, look, 1.0f);
            bsdf.roughness = look.roughness(material.u_roughness, material.v_roughness, material.remap_roughness);
            break;
        case Material::Kind::coated_diffuse:
            bsdf.kind = BsdfKind::coated_diffuse;
            set_layers(bsdf, material, look);
            set_dielectric(bsdf, material, pool, wavelengths, kept_lane);
            bsdf.a = look.share(material.reflectance);
            bsdf.roughness =
                look.roughness(material.coat_u_roughness, material.coat_v_roughness, material.remap_roughness);
            break;
        case Material::Kind::coated_conductor:
            bsdf.kind = BsdfKind::coated_conductor;
            set_layers(bsdf, material, look);
            set_dielectric(bsdf, material, pool, wavelengths, kept_lane);
            set_conductor(bsdf, material, look, bsdf.eta);
            bsdf.roughness =
                look.roughness(material.coat_u_roughness, material.coat_v_roughness, material.remap_roughness);
            bsdf.base_roughness = look.roughness(material.u_roughness, material.v_roughness, material.remap_roughness);
            break;
        case Material::Kind::mix: bsdf.kind = BsdfKind::none; break;  // a circle of mixes: black
    }
}

}  // namespace dapple
