#include "dapple/spectrum/medium_presets.h"
#include "dapple/world/compile_parts.h"

namespace dapple::detail {
namespace {

uint32_t add_grid(Media& media, int nx, int ny, int nz, int channels, std::vector<float> values)
{
    media.grids.push_back(Grid{nx, ny, nz, channels, std::move(values)});
    return static_cast<uint32_t>(media.grids.size() - 1);
}

uint32_t add_grid(Media& media, const scene::GridData& data)
{
    return data.values.empty() ? Id<int>::none_value : add_grid(media, data.nx, data.ny, data.nz, 1, data.values);
}

uint32_t add_grid(Media& media, const scene::RgbGridData& data)
{
    if (data.values.empty()) return Id<int>::none_value;
    std::vector<float> values;
    values.reserve(data.values.size() * 3);
    for (const Vec3& rgb : data.values) values.insert(values.end(), {rgb.x, rgb.y, rgb.z});
    return add_grid(media, data.nx, data.ny, data.nz, 3, std::move(values));
}

struct Fill {
    CompileContext& context;
    const scene::Medium& source;
    Medium& out;

    SpectrumPool& pool() const { return context.world.spectra; }
    SpectrumValue coefficient(const scene::SpectrumSource& spectrum) const
    {
        return scaled(compile_spectrum(pool(), spectrum, SpectrumUsage::unbounded), source.scale);
    }
    // pbrt's emission: of luminance `scale`, whatever the spectrum's own.
    SpectrumValue emission(const scene::SpectrumSource& spectrum, float scale) const
    {
        const SpectrumValue value = compile_spectrum(pool(), spectrum, SpectrumUsage::light);
        return scaled(value, scale * photometric_scale(pool(), value));
    }

    void operator()(const scene::HomogeneousMedium& m) const
    {
        out.kind = Medium::Kind::homogeneous;
        if (!m.preset.empty()) {
            const MediumPreset& preset = find_medium_preset(m.preset, source.at);
            out.sigma_a = scaled(make_unbounded(pool(), srgb(), preset.sigma_a), source.scale);
            out.sigma_s = scaled(make_unbounded(pool(), srgb(), preset.sigma_s), source.scale);
        } else {
            out.sigma_a = coefficient(m.sigma_a);
            out.sigma_s = coefficient(m.sigma_s);
        }
        if (m.emission) out.emission = emission(*m.emission, m.emission_scale);
    }
    void operator()(const scene::UniformGridMedium& m) const
    {
        out.kind = Medium::Kind::uniform_grid;
        out.sigma_a = coefficient(m.sigma_a);
        out.sigma_s = coefficient(m.sigma_s);
        out.grid_bounds = Box3(m.p0, m.p1);
        out.density = add_grid(context.world.media, m.density);
        out.emission_scale = add_grid(context.world.media, m.emission_scale);
        out.temperature = add_grid(context.world.media, m.temperature);
        out.temperature_scale = m.temperature_scale;
        out.temperature_offset = m.temperature_offset;
        if (m.emission) out.emission = emission(*m.emission, 1.0f);
    }
    void operator()(const scene::NanoVdbMedium&) const
    {
        throw UserError(source.at, "medium '" + source.name + "' was not read into a grid");
    }
    void operator()(const scene::RgbGridMedium& m) const
    {
        out.kind = Medium::Kind::rgb_grid;
        out.grid_bounds = Box3(m.p0, m.p1);
        out.sigma_a_grid = add_grid(context.world.media, m.sigma_a);
        out.sigma_s_grid = add_grid(context.world.media, m.sigma_s);
        out.emission_grid = add_grid(context.world.media, m.emission);
        out.sigma_scale = source.scale;
        out.emission_grid_scale = m.emission_scale;
    }
};

}  // namespace

void compile_media(CompileContext& context)
{
    World& world = context.world;
    for (const scene::Medium& medium : context.description.media) {
        Medium out;
        out.g = medium.g;
        out.medium_from_world = Transform(medium.world_from_medium).inverse();
        std::visit(Fill{context, medium, out}, medium.kind);
        if (out.kind != Medium::Kind::homogeneous) build_majorants(world.media, out);
        world.media.list.push_back(out);
    }
}

}  // namespace dapple::detail
