// Participating media: coefficients, phase function, and the tracking of majorants along a ray.
#pragma once

#include "dapple/base/id.h"
#include "dapple/math/ray.h"
#include "dapple/math/transform.h"
#include "dapple/spectrum/spectrum_value.h"

#include <cstdint>
#include <vector>

namespace dapple {

// Values on a regular grid over the unit cube, sample positions at cell centres, trilinear between them, zero outside.
struct Grid {
    int nx = 0, ny = 0, nz = 0;
    int channels = 1;               // 1: density or temperature; 3: RGB
    std::vector<float> values;      // x fastest, channels interleaved
};

// Upper bounds of a density on a coarse grid over the same box, for local majorants.
struct MajorantGrid {
    int nx = 1, ny = 1, nz = 1;
    std::vector<float> values;
};

struct Medium {
    enum class Kind : uint8_t { homogeneous, uniform_grid, rgb_grid };
    Kind kind = Kind::homogeneous;
    SpectrumValue sigma_a, sigma_s;      // [1/m]; scale included; of density 1 for grids
    SpectrumValue emission;              // Le [W/(m2 sr nm)] (times sigma_a, as pbrt's)
    float g = 0.0f;                      // Henyey-Greenstein mean cosine
    Transform medium_from_world;         // grids: to the grid's own space
    Box3 grid_bounds;                    // grids: in medium space
    uint32_t density = Id<int>::none_value;      // uniform_grid: index into Media::grids
    uint32_t emission_scale = Id<int>::none_value;  // grid of emission scale
    uint32_t temperature = Id<int>::none_value;  // grid of temperature [K] for blackbody emission
    float temperature_scale = 1.0f, temperature_offset = 0.0f;
    uint32_t sigma_a_grid = Id<int>::none_value, sigma_s_grid = Id<int>::none_value, emission_grid = Id<int>::none_value;
    float sigma_scale = 1.0f, emission_grid_scale = 1.0f;  // rgb_grid
    uint32_t majorants = Id<int>::none_value;    // index into Media::majorants
    bool scatters() const;               // sigma_s not identically zero
};

struct Media {
    std::vector<Medium> list;
    std::vector<Grid> grids;
    std::vector<MajorantGrid> majorants;
};

// Builds the majorant grid of a medium from its grids, appends it to media.majorants and sets medium.majorants.
void build_majorants(Media& media, Medium& medium, const SpectrumPool& pool);

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
    float t_min = 0.0f, t_max = 0.0f;   // along the unit-length ray direction [m]
    Spectrum majorant;                  // >= sigma_t everywhere in the segment [1/m]
};
class MajorantTracker {
public:
    MajorantTracker(const Media& media, const SpectrumPool& pool, const Medium& medium, const Ray& ray, float t_max,
                    const Wavelengths& wavelengths);
    bool next_segment(MajorantSegment& segment);

private:
    const Media* media_;
    const Medium* medium_;
    Spectrum sigma_t_;                  // of density 1
    float t_ = 0.0f, t_end_ = 0.0f;
    bool done_ = false;
    // 3D DDA over the majorant grid (Amanatides and Woo 1987).
    int cell_[3] = {0, 0, 0}, step_[3] = {0, 0, 0}, stop_[3] = {0, 0, 0};
    float next_t_[3] = {0, 0, 0}, delta_t_[3] = {0, 0, 0};
};

// Henyey-Greenstein phase function [1/sr]; wo points back along the incoming ray, wi on along the outgoing one, so that
// cos = -dot(wo, wi) is the scattering angle's cosine and g > 0 is forward.
float evaluate_phase(float g, const Vec3& wo, const Vec3& wi);
// Samples wi in proportion to the phase function; returns its density (= value).
float sample_phase(float g, const Vec3& wo, const Vec2& u, Vec3& wi);

}  // namespace dapple
