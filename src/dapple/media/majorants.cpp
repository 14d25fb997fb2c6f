// Local majorants: a coarse grid of upper bounds, and the walk of a ray through it.
// Amanatides and Woo 1987, "A fast voxel traversal algorithm for ray tracing". Deviations: crossings are computed from
// the plane's index, not by repeated addition, so that errors do not add up; a segment always begins where the one
// before it ended and the last one ends at the end of the ray's overlap with the box, so that no length is lost or
// counted twice whatever the rounding; neighbouring cells of equal majorant make one segment. Rounding can still place
// a point on the wrong side of a cell's wall by some ulps; each cell's bound therefore covers a rim around the cell.
// Cost: one division per axis per ray, a comparison and a load per cell.

#include "dapple/media/grid.h"
#include "dapple/media/medium.h"
#include "dapple/spectrum/make_spectrum.h"

#include <limits>

namespace dapple {

namespace {

// Width of the rim around a cell that its bound covers, as a part of the cell's width.
constexpr float rim = 0.02f;

// Cells per axis for n samples: 16 where there are as many, more for large grids, whose empty space is worth skipping.
int majorant_resolution(int n) { return std::clamp(n / 8, std::min(n, 16), 64); }

bool present(uint32_t index) { return index != Id<int>::none_value; }

// The bound of the medium's density (uniform_grid) or extinction (rgb_grid) over a box of the unit cube.
float bound(const Media& media, const Medium& medium, const Vec3& lower, const Vec3& upper)
{
    if (medium.kind == Medium::Kind::uniform_grid) return grid_maximum(media.grids[medium.density], lower, upper);
    float sum = 0.0f;
    for (const uint32_t grid : {medium.sigma_a_grid, medium.sigma_s_grid})
        sum += present(grid) ? grid_maximum(media.grids[grid], lower, upper) : 1.0f;
    return sum * medium.sigma_scale;
}

// The grids of a medium share one box but may differ in resolution; the finest of them decides.
void finest(const Media& media, uint32_t grid, int (&samples)[3])
{
    if (!present(grid)) return;
    samples[0] = std::max(samples[0], media.grids[grid].nx);
    samples[1] = std::max(samples[1], media.grids[grid].ny);
    samples[2] = std::max(samples[2], media.grids[grid].nz);
}

// Up to 51200 K; a hotter body has that one's colour.
void fill_blackbody_table(Media& media)
{
    SpectrumPool scratch;
    for (int i = 0; i <= 9 * blackbody_steps_per_octave; ++i) {
        const float kelvin = 100.0f * std::exp2(static_cast<float>(i) / blackbody_steps_per_octave);
        media.blackbody_rgb.push_back(make_blackbody(scratch, kelvin).rgb);
    }
}

// How much larger than its largest component, at most, a lane of an unbounded RGB is.
Spectrum rgb_bound(const SpectrumPool& pool, const Wavelengths& wavelengths)
{
    if (wavelengths.model == ColorModel::spectral) return Spectrum(2.0f);
    // Linear but for negative components, which become 0: exact for sRGB (1), an upper bound for wider spaces.
    Spectrum sum(0.0f);
    for (const Vec3& unit : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
        sum += pool.evaluate_rgb(RgbUse::unbounded, unit, wavelengths);
    for (float& lane : sum.v) lane = std::max(1.0f, lane);
    return sum;
}

}  // namespace

float grid_maximum(const Grid& grid, const Vec3& lower, const Vec3& upper)
{
    const detail::GridAxis x0(lower.x, grid.nx), y0(lower.y, grid.ny), z0(lower.z, grid.nz);
    const detail::GridAxis x1(upper.x, grid.nx), y1(upper.y, grid.ny), z1(upper.z, grid.nz);
    float largest = 0.0f;
    for (int z = std::max(0, z0.index); z <= std::min(grid.nz - 1, z1.index + 1); ++z)
        for (int y = std::max(0, y0.index); y <= std::min(grid.ny - 1, y1.index + 1); ++y)
            for (int x = std::max(0, x0.index); x <= std::min(grid.nx - 1, x1.index + 1); ++x) {
                const size_t at = ((size_t(z) * grid.ny + y) * grid.nx + x) * grid.channels;
                for (int c = 0; c < grid.channels; ++c) largest = std::max(largest, grid.values[at + c]);
            }
    return largest;
}

void build_majorants(Media& media, Medium& medium)
{
    if (medium.kind == Medium::Kind::homogeneous) return;
    if (present(medium.temperature) && media.blackbody_rgb.empty()) fill_blackbody_table(media);
    int samples[3] = {1, 1, 1};
    finest(media, medium.density, samples);
    finest(media, medium.sigma_a_grid, samples);
    finest(media, medium.sigma_s_grid, samples);
    MajorantGrid grid;
    grid.nx = majorant_resolution(samples[0]);
    grid.ny = majorant_resolution(samples[1]);
    grid.nz = majorant_resolution(samples[2]);
    grid.values.reserve(size_t(grid.nx) * grid.ny * grid.nz);
    const Vec3 cell(1.0f / static_cast<float>(grid.nx), 1.0f / static_cast<float>(grid.ny),
                    1.0f / static_cast<float>(grid.nz));
    for (int z = 0; z < grid.nz; ++z)
        for (int y = 0; y < grid.ny; ++y)
            for (int x = 0; x < grid.nx; ++x) {
                const Vec3 index(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
                // The factor covers the rounding of the interpolation's weights.
                grid.values.push_back(1.00001f *
                                      bound(media, medium, (index - Vec3(rim)) * cell, (index + Vec3(1 + rim)) * cell));
            }
    medium.majorants = static_cast<uint32_t>(media.majorants.size());
    media.majorants.push_back(std::move(grid));
}

MajorantTracker::MajorantTracker(const Media& media, const SpectrumPool& pool, const Medium& medium, const Ray& ray,
                                 float t_max, const Wavelengths& wavelengths)
{
    if (!(t_max > 0.0f)) return;
    if (medium.kind == Medium::Kind::homogeneous) {
        sigma_t_ = pool.evaluate(medium.sigma_a, wavelengths) + pool.evaluate(medium.sigma_s, wavelengths);
        // Not infinite: a lane of majorant 0 would get 0 times infinity for its optical depth.
        t_end_ = std::min(t_max, std::numeric_limits<float>::max());
        return;
    }
    sigma_t_ = medium.kind == Medium::Kind::rgb_grid
                   ? rgb_bound(pool, wavelengths)
                   : pool.evaluate(medium.sigma_a, wavelengths) + pool.evaluate(medium.sigma_s, wavelengths);
    grid_ = &media.majorants[medium.majorants];
    begin_traversal(medium, ray, t_max);
}

void MajorantTracker::begin_traversal(const Medium& medium, const Ray& ray, float t_max)
{
    const Vec3 origin = medium.medium_from_world.point(ray.origin);
    const Vec3 direction = medium.medium_from_world.vector(ray.direction);
    const int cells[3] = {grid_->nx, grid_->ny, grid_->nz};
    double t_enter = 0.0, t_leave = t_max;
    double start[3], slope[3];
    for (int axis = 0; axis < 3; ++axis) {
        // In units of cells: the box is [0, cells]. The parameter t stays that of the ray.
        const double lower = medium.grid_bounds.min[axis];
        const double scale = cells[axis] / (double(medium.grid_bounds.max[axis]) - lower);
        start[axis] = (origin[axis] - lower) * scale;
        slope[axis] = direction[axis] * scale;
        if (slope[axis] == 0.0) {
            if (!(start[axis] >= 0.0 && start[axis] <= cells[axis])) return;
            continue;
        }
        const double t0 = -start[axis] / slope[axis];
        const double t1 = (cells[axis] - start[axis]) / slope[axis];
        t_enter = std::max(t_enter, std::min(t0, t1));
        t_leave = std::min(t_leave, std::max(t0, t1));
    }
    t_ = static_cast<float>(t_enter);
    t_end_ = static_cast<float>(t_leave);
    for (int axis = 0; axis < 3; ++axis) {
        cell_[axis] = static_cast<int>(std::clamp(start[axis] + t_enter * slope[axis], 0.0, cells[axis] - 1.0));
        step_[axis] = slope[axis] > 0.0 ? 1 : (slope[axis] < 0.0 ? -1 : 0);
        stop_[axis] = slope[axis] > 0.0 ? cells[axis] : -1;
        start_[axis] = start[axis];
        inverse_slope_[axis] = slope[axis] != 0.0 ? 1.0 / slope[axis] : 0.0;
        next_t_[axis] = crossing(axis);
    }
}

float MajorantTracker::crossing(int axis) const
{
    if (step_[axis] == 0) return infinity;
    const int plane = step_[axis] > 0 ? cell_[axis] + 1 : cell_[axis];
    return static_cast<float>((plane - start_[axis]) * inverse_slope_[axis]);
}

float MajorantTracker::cell_majorant() const
{
    return grid_->values[(size_t(cell_[2]) * grid_->ny + cell_[1]) * grid_->nx + cell_[0]];
}

bool MajorantTracker::next_segment(MajorantSegment& segment)
{
    if (!(t_ < t_end_)) return false;
    segment.t_min = t_;
    segment.t_max = t_end_;
    float majorant = grid_ != nullptr ? cell_majorant() : 1.0f;
    while (grid_ != nullptr) {
        const int axis =
            next_t_[0] < next_t_[1] ? (next_t_[0] < next_t_[2] ? 0 : 2) : (next_t_[1] < next_t_[2] ? 1 : 2);
        const float wall = next_t_[axis];
        if (!(wall < t_end_) || cell_[axis] + step_[axis] == stop_[axis]) break;
        cell_[axis] += step_[axis];
        next_t_[axis] = crossing(axis);
        const float beyond = cell_majorant();
        if (beyond == majorant) continue;
        if (wall > t_) {
            segment.t_max = wall;
            break;
        }
        majorant = beyond;  // the segment begins at this wall: nothing of the cell before it was crossed
    }
    segment.majorant = sigma_t_ * majorant;
    t_ = segment.t_max;
    return true;
}

}  // namespace dapple
