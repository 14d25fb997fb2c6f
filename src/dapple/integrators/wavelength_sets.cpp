#include "dapple/integrators/wavelength_sets.h"

namespace dapple {
namespace {

// Van der Corput's sequence in base 2.
double radical_inverse(uint64_t i)
{
    double value = 0.0;
    for (double digit = 0.5; i != 0; i >>= 1, digit *= 0.5) value += digit * static_cast<double>(i & 1u);
    return value;
}

}  // namespace

float time_of_set(uint64_t seed, uint32_t pass, int set, int sets)
{
    const auto n = static_cast<uint64_t>(sets);
    const uint64_t index = pass * n + (static_cast<uint64_t>(set) + pass / n) % n;
    const double shift = to_unit_float(hash_words(seed, static_cast<uint64_t>(StreamPurpose::shutter)));
    const double time = radical_inverse(index) + shift;
    return static_cast<float>(std::min(time - std::floor(time), 0x1.fffffep-1));
}

Wavelengths wavelengths_of_set(ColorModel model, uint64_t seed, uint32_t epoch, int set, int sets)
{
    // sample_visible repeats itself every quarter (it takes four stratified wavelengths), so the sets divide a quarter.
    // The golden ratio spreads the epochs evenly between the sets' neighbours.
    const double start = to_unit_float(hash_words(static_cast<uint64_t>(StreamPurpose::wavelength_set), seed));
    const double turns = start + double(epoch) * 0.61803398874989485;
    const float jitter = std::min(static_cast<float>(turns - std::floor(turns)), one_minus_epsilon);
    return choose_wavelengths(model, (static_cast<float>(set) + jitter) / static_cast<float>(sets * Spectrum::lanes));
}

}  // namespace dapple
