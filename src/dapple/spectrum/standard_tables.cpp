// Standard tables (see standard_tables.h). Each is put on the 1 nm grid once, when first asked for.
// CIE D series: ISO/CIE 11664-2; chromaticity from temperature by Judd, MacAdam and Wyszecki 1964.
#include "dapple/spectrum/standard_tables.h"

#include "dapple/base/assert.h"
#include "dapple/spectrum/photometry.h"
#include "dapple/spectrum/spectrum_value.h"

#include <map>

namespace dapple {
namespace {

struct RegularTable {
    std::string_view name;
    float first, step;
    std::vector<float> values;
};

struct CameraTable {
    std::string_view name;
    std::array<std::vector<float>, 3> channels;
};

using TableMap = std::map<std::string_view, std::vector<float>>;

std::vector<float> resample_regular(float first, float step, std::span<const float> values)
{
    std::vector<float> lambdas(values.size());
    for (size_t i = 0; i < values.size(); ++i) lambdas[i] = first + step * static_cast<float>(i);
    return resample(lambdas, values, TableEnds::clamp);
}

void normalize_luminance(std::vector<float>& table)
{
    const float scale = cie_y_integral / xyz_of_table(table).y;
    for (float& value : table) value *= scale;
}

const TableMap& illuminants()
{
    static const TableMap tables = [] {
        const std::vector<RegularTable> sources = {
#include "dapple/spectrum/tables/illuminants.inc"
        };
        TableMap result;
        for (const RegularTable& source : sources)
            result[source.name] = resample_regular(source.first, source.step, source.values);
        result["stdillum-E"] = std::vector<float>(spectrum_table_size, 1.0f);
        for (auto& [name, table] : result) normalize_luminance(table);
        return result;
    }();
    return tables;
}

const std::map<std::string_view, std::array<std::vector<float>, 3>>& sensors()
{
    static const std::map<std::string_view, std::array<std::vector<float>, 3>> tables = [] {
        const std::vector<CameraTable> sources = {
#include "dapple/spectrum/tables/sensors.inc"
        };
        std::map<std::string_view, std::array<std::vector<float>, 3>> result;
        for (const CameraTable& source : sources)
            for (size_t i = 0; i < 3; ++i) result[source.name][i] = resample_regular(380.0f, 10.0f, source.channels[i]);
        result["cie1931"] = cie_matching_functions();
        return result;
    }();
    return tables;
}

template <class Map>
std::vector<std::string_view> keys(const Map& map)
{
    std::vector<std::string_view> names;
    for (const auto& entry : map) names.push_back(entry.first);
    return names;
}

}  // namespace

const std::array<std::vector<float>, 3>& cie_matching_functions()
{
    static const std::array<std::vector<float>, 3> tables = {{
#include "dapple/spectrum/tables/cie1931.inc"
    }};
    return tables;
}

std::vector<float> resample(std::span<const float> lambdas, std::span<const float> values, TableEnds ends)
{
    DAPPLE_ASSERT(!lambdas.empty() && lambdas.size() == values.size());
    std::vector<float> result(spectrum_table_size, 0.0f);
    size_t next = 0;
    for (int i = 0; i < spectrum_table_size; ++i) {
        const float lambda = lambda_min + static_cast<float>(i);
        while (next < lambdas.size() && lambdas[next] < lambda) ++next;
        if (next < lambdas.size() && lambdas[next] == lambda)
            result[i] = values[next];
        else if (next == 0 || next == lambdas.size())
            result[i] = ends == TableEnds::zero ? 0.0f : next == 0 ? values.front() : values.back();
        else
            result[i] = lerp((lambda - lambdas[next - 1]) / (lambdas[next] - lambdas[next - 1]), values[next - 1],
                             values[next]);
    }
    return result;
}

Vec3 xyz_of_table(std::span<const float> table)
{
    DAPPLE_ASSERT(table.size() == spectrum_table_size);
    const auto& matching = cie_matching_functions();
    double sums[3] = {0.0, 0.0, 0.0};
    for (size_t k = 0; k < 3; ++k)
        for (size_t i = 0; i < table.size(); ++i) sums[k] += static_cast<double>(matching[k][i]) * table[i];
    return {static_cast<float>(sums[0]), static_cast<float>(sums[1]), static_cast<float>(sums[2])};
}

const std::vector<float>* illuminant_table(std::string_view name)
{
    const auto found = illuminants().find(name);
    return found == illuminants().end() ? nullptr : &found->second;
}

std::vector<std::string_view> illuminant_names() { return keys(illuminants()); }

const std::vector<float>* sensor_curve(std::string_view name, int channel)
{
    DAPPLE_ASSERT(channel >= 0 && channel < 3);
    const auto found = sensors().find(name);
    return found == sensors().end() ? nullptr : &found->second[static_cast<size_t>(channel)];
}

std::vector<std::string_view> sensor_names() { return keys(sensors()); }

const std::array<std::vector<float>, 24>& swatch_reflectances()
{
    static const std::array<std::vector<float>, 24> tables = [] {
        std::array<std::vector<float>, 24> result = {{
#include "dapple/spectrum/tables/swatches.inc"
        }};
        for (auto& table : result) table = resample_regular(380.0f, 10.0f, table);
        return result;
    }();
    return tables;
}

std::vector<float> daylight_table(float kelvin)
{
    const double t = kelvin * (1.4388 / 1.4380);
    std::vector<float> result(spectrum_table_size);
    if (t < 4000.0) {
        for (int i = 0; i < spectrum_table_size; ++i)
            result[i] = blackbody(lambda_min + static_cast<float>(i), static_cast<float>(t));
        return result;
    }
    const double x = t <= 7000.0 ? -4.607e9 / (t * t * t) + 2.9678e6 / (t * t) + 0.09911e3 / t + 0.244063
                                 : -2.0064e9 / (t * t * t) + 1.9018e6 / (t * t) + 0.24748e3 / t + 0.23704;
    const double y = -3.0 * x * x + 2.870 * x - 0.275;
    const double m = 0.0241 + 0.2562 * x - 0.7341 * y;
    const double m1 = (-1.3515 - 1.7703 * x + 5.9114 * y) / m;
    const double m2 = (0.0300 - 31.4424 * x + 30.0717 * y) / m;

    const std::array<std::vector<float>, 3> basis = {{
#include "dapple/spectrum/tables/daylight.inc"
    }};
    std::vector<float> values(basis[0].size());
    for (size_t i = 0; i < values.size(); ++i)
        values[i] = static_cast<float>(basis[0][i] + m1 * basis[1][i] + m2 * basis[2][i]);
    return resample_regular(lambda_min, 5.0f, values);
}

}  // namespace dapple
