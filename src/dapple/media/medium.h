// Participating media: coefficients, phase function, and the tracking of majorants along a ray.
#pragma once

#include "dapple/base/id.h"
#include "dapple/math/ray.h"
#include "dapple/math/transform.h"
#include "dapple/sampling/henyey_greenstein.h"
#include "dapple/spectrum/spectrum_value.h"

#include <cstdint>
#include <vector>

namespace dapple {

// Values on a regular grid over the unit cube, sample positions at cell centres, trilinear between them, zero outside.
struct Grid {
    int nx = 0, ny = 0, nz = 0;
    int channels = 1;           // 1: density or temperature; 3: RGB (colour space of SpectrumPool::prepare_rgb)
    std::vector<float> values;  // x fastest, channels interleaved
};

// Upper bounds of a density on a coarse grid over the same box, for local majorants.
struct MajorantGrid {
    int nx = 1, ny = 1, nz = 1;
    std::vector<float> values;
};

struct Medium {
    enum class Kind : uint8_t { homogeneous, uniform_grid, rgb_grid };
    Kind kind = Kind::homogeneous;
    SpectrumValue sigma_a, sigma_s;                 // [1/m]; scale included; of density 1 for grids
    SpectrumValue emission;                         // Le [W/(m2 sr nm)] (times sigma_a, as pbrt's)
    float g = 0.0f;                                 // Henyey-Greenstein mean cosine
    Transform medium_from_world;                    // grids: to the grid's own space
    Box3 grid_bounds;                               // grids: in medium space
    uint32_t density = Id<int>::none_value;         // uniform_grid: index into Media::grids
    uint32_t emission_scale = Id<int>::none_value;  // grid of emission scale
    uint32_t temperature = Id<int>::none_value;     // grid of temperature [K] for blackbody emission
    float temperature_scale = 1.0f, temperature_offset = 0.0f;
    uint32_t sigma_a_grid = Id<int>::none_value, sigma_s_grid = Id<int>::none_value,
             emission_grid = Id<int>::none_value;
    float sigma_scale = 1.0f;          // rgb_grid; a sigma grid that is absent stands for 1
    float emission_grid_scale = 1.0f;  // rgb_grid, and blackbody emission (whose peak over wavelengths is 1 otherwise)
    uint32_t majorants = Id<int>::none_value;  // index into Media::majorants
    bool scatters() const;                     // may be true where sigma_s is zero, never the reverse
    bool emits() const;                        // may be true where the emission is zero, never the reverse
};

struct Media {
    std::vector<Medium> list;
    std::vector<Grid> grids;
    std::vector<MajorantGrid> majorants;
    // Of black bodies whose largest value over wavelengths is 1, as linear sRGB, at 100 K * 2^(i / steps). Filled by
    // build_majorants when a medium has a temperature.
    std::vector<Vec3> blackbody_rgb;
};
inline constexpr int blackbody_steps_per_octave = 32;

// Builds the majorant grid of a medium from its grids, appends it to media.majorants and sets medium.majorants; fills
// media.blackbody_rgb if needed. Does nothing for homogeneous media. Cold code.
void build_majorants(Media& media, Medium& medium);

// What the medium is at a point.
struct MediumPoint {
    Spectrum sigma_a, sigma_s;  // [1/m]
    Spectrum emission;          // sigma_a * Le [W/(m3 sr nm)]
};
MediumPoint evaluate(const Media& media, const SpectrumPool& pool, const Medium& medium, const Vec3& p,
                     const Wavelengths& wavelengths);

// Walks along a ray through the pieces of constant majorant. Usage:
//     MajorantTracker tracker(media, pool, medium, ray, t_max, wavelengths);
//     while (tracker.next_segment(segment)) ...
struct MajorantSegment {
    float t_min = 0.0f, t_max = 0.0f;  // along the unit-length ray direction [m]
    Spectrum majorant;                 // >= sigma_t everywhere in the segment [1/m]
};
class MajorantTracker {
public:
    MajorantTracker(const Media& media, const SpectrumPool& pool, const Medium& medium, const Ray& ray, float t_max,
                    const Wavelengths& wavelengths);
    bool next_segment(MajorantSegment& segment);

private:
    // Sets up the walk through the majorant grid; leaves the tracker empty when the ray misses the box.
    void begin_traversal(const Medium& medium, const Ray& ray, float t_max);
    float crossing(int axis) const;  // t of the wall at which the ray leaves the cell along an axis
    float cell_majorant() const;

    const MajorantGrid* grid_ = nullptr;  // none: one segment
    Spectrum sigma_t_;                    // of majorant 1
    float t_ = 0.0f, t_end_ = 0.0f;
    int cell_[3] = {0, 0, 0}, step_[3] = {0, 0, 0}, stop_[3] = {0, 0, 0};
    float next_t_[3] = {0, 0, 0};
    double start_[3] = {0, 0, 0}, inverse_slope_[3] = {0, 0, 0};  // the ray in units of cells
};

// The phase function of all media [1/sr], Henyey and Greenstein's; wo points back along the incoming ray, wi on along
// the outgoing one.
inline float evaluate_phase(float g, const Vec3& wo, const Vec3& wi) { return henyey_greenstein(g, wo, wi); }
// Samples wi in proportion to the phase function; returns its density (= value).
inline float sample_phase(float g, const Vec3& wo, const Vec2& u, Vec3& wi)
{
    return sample_henyey_greenstein(g, wo, u, wi);
}

}  // namespace dapple
