// Crossing a medium along a ray: free-flight sampling (delta tracking) and transmittance (ratio tracking) over local
// majorants. Miller, Georgiev, Jarosz 2019, "A null-scattering path integral formulation of light transport"; Novak,
// Selle, Jarosz 2014, "Residual ratio tracking" (without the residual). Factors are per lane, relative to the density
// of the deciding lane; see walk.h for path_pdf and light_pdf.
#pragma once

#include "dapple/sampling/random_stream.h"
#include "dapple/world/world.h"

namespace dapple {

struct MediumEvent {
    enum class Kind : uint8_t { pass, scatter, absorb };
    Kind kind = Kind::pass;
    float t = 0.0f;             // of the scattering [m along the unit ray direction]
    Spectrum throughput{1.0f};  // factors of this crossing
    Spectrum path_pdf{1.0f};
    Spectrum light_pdf{1.0f};
    Spectrum emission;  // radiance the medium added, relative to the throughput before the crossing
};

// Travels through `medium` along `ray` up to t_max. path_pdf: the walk's so far, to weight emission.
MediumEvent cross_medium(const World& world, MediumId medium, const Ray& ray, float t_max,
                         const Wavelengths& wavelengths, int kept_lane, const Spectrum& path_pdf, RandomStream& random);

// What a straight connection lets through: value / mean(path_pdf or light_pdf ...) estimates the transmittance.
struct Transmittance {
    Spectrum value{1.0f};
    Spectrum path_pdf{1.0f};
    Spectrum light_pdf{1.0f};
    bool blocked() const { return value.is_black(); }
};

// From `from`, in `medium`, to `to` (both already offset from their surfaces): opaque surfaces block, interfaces change
// the medium. `to` at infinity: pass a direction and t_max = infinity.
Transmittance transmittance(const World& world, Ray ray, float t_max, MediumId medium, const Wavelengths& wavelengths,
                            int kept_lane, RandomStream& random);

}  // namespace dapple
