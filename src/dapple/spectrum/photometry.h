// Photometric units and thermal emission.
#pragma once

#include <cmath>

namespace dapple {

// Luminous efficacy of monochromatic light at 540 THz [lm/W], the definition of the candela.
inline constexpr float luminous_efficacy = 683.0f;

// Photometric from radiometric quantities and back: `y_weighted` is the integral of ybar(lambda) * Q(lambda) dlambda in
// watts (per area, solid angle, ...), the result is in lumens (per the same): lm, lx, cd, nt.
inline constexpr float photometric_from_y(float y_weighted) { return luminous_efficacy * y_weighted; }
inline constexpr float y_from_photometric(float lumens) { return lumens / luminous_efficacy; }

// Spectral radiance of a black body at a wavelength in vacuum [W/(m2 sr nm)] (Planck's law, constants of the SI of
// 2019); 0 at temperatures of 0 and below.
inline float blackbody(float lambda_nm, float kelvin)
{
    if (!(kelvin > 0.0f)) return 0.0f;
    constexpr double c = 299792458.0, h = 6.62607015e-34, k = 1.380649e-23;
    const double lambda = lambda_nm * 1e-9;
    const double lambda2 = lambda * lambda;
    const double per_metre = 2.0 * h * c * c / (lambda2 * lambda2 * lambda) / std::expm1(h * c / (lambda * k * kelvin));
    return static_cast<float>(per_metre * 1e-9);
}

// Wavelength [nm] at which a black body of that temperature radiates most per wavelength (Wien's displacement law).
inline constexpr float blackbody_peak(float kelvin) { return 2.897771955e6f / kelvin; }

}  // namespace dapple
