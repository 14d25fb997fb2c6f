// Construction of SpectrumValues (see make_spectrum.h).
#include "dapple/spectrum/make_spectrum.h"

#include "dapple/spectrum/named_tables.h"
#include "dapple/spectrum/photometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

namespace dapple {
namespace {

Vec3 without_negatives(const Vec3& v) { return {std::max(0.0f, v.x), std::max(0.0f, v.y), std::max(0.0f, v.z)}; }

// XYZ of the table under the white of sRGB, relative to the white's Y.
Vec3 srgb_of_factor(const std::vector<float>& table)
{
    const std::vector<float>& white = srgb().illuminant;
    std::vector<float> lit(table.size());
    for (size_t i = 0; i < table.size(); ++i) lit[i] = table[i] * white[i];
    return multiply(srgb().rgb_from_xyz, xyz_of_table(lit) * (1.0f / cie_y_integral));
}

// Mean over each channel's matching function under equal energy.
Vec3 srgb_of_index(const std::vector<float>& table)
{
    const Vec3 sum = multiply(srgb().rgb_from_xyz, xyz_of_table(table));
    const Vec3 unit = multiply(srgb().rgb_from_xyz, xyz_of_table(std::vector<float>(table.size(), 1.0f)));
    return {sum.x / unit.x, sum.y / unit.y, sum.z / unit.z};
}

Vec3 srgb_of(const std::vector<float>& table, SpectrumRole role)
{
    switch (role) {
        case SpectrumRole::factor: return without_negatives(srgb_of_factor(table));
        case SpectrumRole::index: return without_negatives(srgb_of_index(table));
        case SpectrumRole::light: break;
    }
    return without_negatives(multiply(srgb().rgb_from_xyz, xyz_of_table(table)));
}

SpectrumValue from_table(SpectrumPool& pool, const std::vector<float>& table, SpectrumRole role)
{
    SpectrumValue value;
    value.kind = SpectrumValue::Kind::table;
    value.table = pool.add_table(table);
    value.scale = 1.0f;
    value.rgb = srgb_of(table, role);
    return value;
}

void set_coefficients(SpectrumValue& value, const SigmoidCoefficients& sigmoid)
{
    for (int i = 0; i < 3; ++i) value.c[i] = sigmoid.c[i];
}

}  // namespace

SpectrumValue make_constant(float number, SpectrumRole role)
{
    SpectrumValue value;
    value.scale = number;
    value.rgb = Vec3(number);
    if (role == SpectrumRole::light) value.rgb = srgb_of(std::vector<float>(spectrum_table_size, number), role);
    return value;
}

SpectrumValue make_albedo(SpectrumPool&, const ColorSpace& space, const Vec3& rgb)
{
    SpectrumValue value;
    value.kind = SpectrumValue::Kind::albedo;
    value.scale = 1.0f;
    const Vec3 clamped(clamp01(rgb.x), clamp01(rgb.y), clamp01(rgb.z));
    set_coefficients(value, rgb_to_sigmoid(space, clamped));
    const Vec3 linear = to_srgb(space, clamped);
    value.rgb = Vec3(clamp01(linear.x), clamp01(linear.y), clamp01(linear.z));
    return value;
}

SpectrumValue make_unbounded(SpectrumPool&, const ColorSpace& space, const Vec3& rgb)
{
    SpectrumValue value;
    value.kind = SpectrumValue::Kind::albedo;
    const Vec3 positive = without_negatives(rgb);
    value.scale = 2.0f * max_component(positive);
    if (value.scale > 0.0f) set_coefficients(value, rgb_to_sigmoid(space, positive * (1.0f / value.scale)));
    value.rgb = without_negatives(to_srgb(space, positive));
    return value;
}

SpectrumValue make_illuminant(SpectrumPool& pool, const ColorSpace& space, const Vec3& rgb)
{
    SpectrumValue value = make_unbounded(pool, space, rgb);
    value.kind = SpectrumValue::Kind::illuminant;
    value.table = pool.add_table(space.illuminant);
    value.rgb *= cie_y_integral;
    return value;
}

SpectrumValue make_blackbody(SpectrumPool& pool, float kelvin, SpectrumRole role)
{
    if (!(kelvin > 0.0f) || !std::isfinite(kelvin))
        throw UserError(fmt::format("the temperature of a black body must be above 0 K, not {}", kelvin));
    const float peak = blackbody(blackbody_peak(kelvin), kelvin);
    std::vector<float> table(spectrum_table_size);
    for (int i = 0; i < spectrum_table_size; ++i)
        table[i] = blackbody(lambda_min + static_cast<float>(i), kelvin) / peak;
    return from_table(pool, table, role);
}

SpectrumValue make_sampled(SpectrumPool& pool, std::span<const float> lambdas, std::span<const float> values,
                           SpectrumRole role, TableEnds ends)
{
    if (lambdas.empty()) throw UserError("a sampled spectrum needs at least one wavelength and value");
    if (lambdas.size() != values.size())
        throw UserError(
            fmt::format("a sampled spectrum has {} wavelengths but {} values", lambdas.size(), values.size()));
    for (size_t i = 0; i < lambdas.size(); ++i) {
        if (!std::isfinite(lambdas[i]) || !std::isfinite(values[i]))
            throw UserError(fmt::format("entry {} of a sampled spectrum is not a finite number", i + 1));
        if (i > 0 && !(lambdas[i] > lambdas[i - 1]))
            throw UserError(fmt::format("wavelengths of a sampled spectrum must increase, but {} nm follows {} nm",
                                        lambdas[i], lambdas[i - 1]));
    }
    return from_table(pool, resample(lambdas, values, ends), role);
}

SpectrumValue make_named(SpectrumPool& pool, std::string_view name)
{
    if (const std::vector<float>* illuminant = illuminant_table(name))
        return from_table(pool, *illuminant, SpectrumRole::light);
    const std::vector<float> index = refractive_index_table(name);
    if (!index.empty()) return from_table(pool, index, SpectrumRole::index);
    throw UserError(fmt::format("unknown spectrum '{}'{}", name, named_spectrum_hint(name)));
}

std::vector<std::string_view> named_spectrum_names()
{
    std::vector<std::string_view> names = illuminant_names();
    const std::vector<std::string_view> indices = refractive_index_names();
    names.insert(names.end(), indices.begin(), indices.end());
    return names;
}

std::string named_spectrum_hint(std::string_view name)
{
    constexpr size_t longest = 64;  // no known name is longer
    if (name.size() > longest) return {};
    constexpr std::pair<std::string_view, std::string_view> metals[] = {
        {"silver", "Ag"}, {"aluminium", "Al"}, {"aluminum", "Al"}, {"gold", "Au"}, {"copper", "Cu"}, {"brass", "CuZn"}};
    std::string lower(name);
    for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    for (const auto& [metal, symbol] : metals) {
        if (lower.find(metal) == lower.npos) continue;
        if (lower.ends_with("eta") || lower.ends_with("-k"))
            return fmt::format("; did you mean 'metal-{}-{}'?", symbol, lower.back() == 'k' ? "k" : "eta");
        return fmt::format("; did you mean 'metal-{0}-eta' or 'metal-{0}-k'?", symbol);
    }

    // Symbols of two letters are all near one another: another one is not meant.
    constexpr std::string_view prefix = "metal-", suffix = "-eta";
    const std::vector<std::string_view> known = named_spectrum_names();
    std::vector<std::string_view> symbols;
    for (const std::string_view word : known)
        if (word.starts_with(prefix) && word.ends_with(suffix))
            symbols.push_back(word.substr(prefix.size(), word.size() - prefix.size() - suffix.size()));
    const size_t end = lower.rfind('-');
    if (!lower.starts_with(prefix) || end < prefix.size()) return did_you_mean(name, known);
    const std::string symbol = lower.substr(prefix.size(), end - prefix.size());
    const auto is_symbol = [&](std::string_view candidate) {
        return std::equal(candidate.begin(), candidate.end(), symbol.begin(), symbol.end(),
                          [](unsigned char a, unsigned char b) { return std::tolower(a) == b; });
    };
    if (std::any_of(symbols.begin(), symbols.end(), is_symbol)) return did_you_mean(name, known);
    return fmt::format("; the metals are {}, as in 'metal-{}-eta' and 'metal-{}-k'", fmt::join(symbols, ", "),
                       symbols.front(), symbols.front());
}

float photometric_scale(const SpectrumPool& pool, const SpectrumValue& value)
{
    SpectrumValue measured = value;
    if (value.kind == SpectrumValue::Kind::illuminant) {
        measured.kind = SpectrumValue::Kind::table;
        measured.scale = 1.0f;
    }
    std::vector<float> table(spectrum_table_size);
    for (int i = 0; i < spectrum_table_size; ++i)
        table[i] = pool.evaluate(measured, lambda_min + static_cast<float>(i));
    const float y = xyz_of_table(table).y;
    return y > 0.0f ? 1.0f / y : 0.0f;
}

}  // namespace dapple
