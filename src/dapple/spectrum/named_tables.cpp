// Refractive indices by name (see named_tables.h). Metals: tables/metals.inc. Glasses, crystals and water: dispersion
// formulas with the coefficients of the refractiveindex.info database (polyanskiy/refractiveindex.info-database,
// commit ff11b58, CC0): SCHOTT catalogue; fused silica Malitson 1965; sapphire (ordinary ray) Malitson and Dodge 1972;
// water at 20 C Daimon and Masumura 2007; diamond Peter 1923. pbrt's glasses "F5", "F10", "F11" are SF5, SF10, SF11.
#include "dapple/spectrum/named_tables.h"

#include "dapple/spectrum/spectrum_value.h"
#include "dapple/spectrum/standard_tables.h"

#include <cmath>

namespace dapple {
namespace {

// n^2 = 1 + sum of b L^2 / (L^2 - c), L in micrometres; c squared where the source gives resonance wavelengths.
struct Dispersion {
    std::string_view name;
    bool squared;
    std::vector<double> terms;  // b, c, b, c, ...
};

struct MetalTable {
    std::string_view name;
    std::vector<float> interleaved;
};

const std::vector<Dispersion>& dispersions()
{
    static const std::vector<Dispersion> list = {
        {"glass-BK7", false, {1.03961212, 0.00600069867, 0.231792344, 0.0200179144, 1.01046945, 103.560653}},
        {"glass-K5", false, {1.08511833, 0.00661099503, 0.199562005, 0.024110866, 0.930511663, 111.982777}},
        {"glass-FK51A", false, {0.971247817, 0.00472301995, 0.216901417, 0.0153575612, 0.904651666, 168.68133}},
        {"glass-BAF10", false, {1.5851495, 0.00926681282, 0.143559385, 0.0424489805, 1.08521269, 105.613573}},
        {"glass-LASF9", false, {2.00029547, 0.0121426017, 0.298926886, 0.0538736236, 1.80691843, 156.530829}},
        {"glass-F2", false, {1.34533359, 0.00997743871, 0.209073176, 0.0470450767, 0.937357162, 111.886764}},
        {"glass-F5", false, {1.46141885, 0.0111826126, 0.247713019, 0.0508594669, 0.949995832, 112.041888}},
        {"glass-F10", false, {1.61625977, 0.0127534559, 0.259229334, 0.0581983954, 1.07762317, 116.60768}},
        {"glass-F11", false, {1.73848403, 0.0136068604, 0.311168974, 0.0615960463, 1.17490871, 121.922711}},
        {"glass-SF5", false, {1.46141885, 0.0111826126, 0.247713019, 0.0508594669, 0.949995832, 112.041888}},
        {"glass-SF10", false, {1.61625977, 0.0127534559, 0.259229334, 0.0581983954, 1.07762317, 116.60768}},
        {"glass-SF11", false, {1.73848403, 0.0136068604, 0.311168974, 0.0615960463, 1.17490871, 121.922711}},
        {"glass-N-SF11", false, {1.73759695, 0.013188707, 0.313747346, 0.0623068142, 1.89878101, 155.23629}},
        {"glass-SF66", false, {2.0245976, 0.0147053225, 0.470187196, 0.0692998276, 2.59970433, 161.817601}},
        {"fused-silica", true, {0.6961663, 0.0684043, 0.4079426, 0.1162414, 0.8974794, 9.896161}},
        {"sapphire", true, {1.4313493, 0.0726631, 0.65054713, 0.1193242, 5.3414021, 18.028251}},
        {"water",
         false,
         {0.5684027565, 0.005101829712, 0.1726177391, 0.01821153936, 0.02086189578, 0.02620722293, 0.1130748688,
          10.69792721}},
        {"diamond", true, {0.3306, 0.175, 4.3356, 0.106}},
    };
    return list;
}

const std::vector<MetalTable>& metals()
{
    static const std::vector<MetalTable> list = {
#include "dapple/spectrum/tables/metals.inc"
    };
    return list;
}

float index_at(const Dispersion& dispersion, double lambda_nm)
{
    const double l2 = lambda_nm * lambda_nm * 1e-6;
    double n2 = 1.0;
    for (size_t i = 0; i < dispersion.terms.size(); i += 2) {
        const double c = dispersion.terms[i + 1];
        n2 += dispersion.terms[i] * l2 / (l2 - (dispersion.squared ? c * c : c));
    }
    return static_cast<float>(std::sqrt(n2));
}

}  // namespace

std::vector<float> refractive_index_table(std::string_view name)
{
    for (const Dispersion& dispersion : dispersions()) {
        if (dispersion.name != name) continue;
        std::vector<float> table(spectrum_table_size);
        for (int i = 0; i < spectrum_table_size; ++i)
            table[i] = index_at(dispersion, static_cast<double>(lambda_min) + i);
        return table;
    }
    for (const MetalTable& metal : metals()) {
        if (metal.name != name) continue;
        std::vector<float> lambdas, values;
        for (size_t i = 0; i < metal.interleaved.size(); i += 2) {
            lambdas.push_back(metal.interleaved[i]);
            values.push_back(metal.interleaved[i + 1]);
        }
        return resample(lambdas, values, TableEnds::clamp);
    }
    return {};
}

std::vector<std::string_view> refractive_index_names()
{
    std::vector<std::string_view> names;
    for (const Dispersion& dispersion : dispersions()) names.push_back(dispersion.name);
    for (const MetalTable& metal : metals()) names.push_back(metal.name);
    return names;
}

}  // namespace dapple
