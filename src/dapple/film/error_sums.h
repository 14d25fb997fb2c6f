// Sums from which the error of the mean of the passes is estimated, kept on request beside those of the image.
//
// Passes are taken in batches of as many as are correlated (Integrator::correlated_passes). For each pixel the squares
// of the batches' luminances are added up: with the plain sum they give the variance between batches, and so the
// standard error of the mean, whatever the integrator. For integrators whose bias fades with the passes as x(pass)
// (Integrator::bias_scale: the squared radius of progressive photon mapping), the luminances weighted by x are added
// up too: the slope of the luminance over x, by least squares, times the mean of x is the bias that is left. That is
// the extrapolation from two radii with all radii used.
//
// All sums are exact and belong to batches, not to runs: a batch of which one film has only a part is kept open until
// merging brings the rest, so merged films have the bits of a single one. Memory: 32 bytes a pixel, 48 with a fading
// bias, 16 more for each open batch. Cost per batch: reading the beauty's sums.
#pragma once

#include "dapple/film/exact_sum.h"
#include "dapple/image/image.h"

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <map>
#include <vector>

namespace dapple {

// What a whole image is off by, as parts of its brightness: root mean squares over pixels of the error divided by
// sqrt(m^2 + (0.1 M)^2), where m is the pixel's luminance and M the image's mean one. So `noise` squared is the relMSE
// that is expected from noise for an image of mean luminance 1.
struct ErrorEstimate {
    uint32_t batches = 0;  // complete ones
    double noise = 0;      // meaningful from two batches on
    double bias = 0;       // of blocks of 16 x 16 pixels; what fades only; from four batches on
    double total() const;
};

class ErrorSums {
public:
    // Luminance of all passes of a pixel, in units of 2^-68: the exact integer 54 r + 183 g + 19 b of sums of RGB.
    using Luminance = std::function<Fixed128(size_t pixel)>;
    static Fixed128 luminance(Fixed128 r, Fixed128 g, Fixed128 b);

    // bias_scale: x of a pass in (0, 1], the same within a batch; empty where nothing fades.
    ErrorSums(int width, int height, uint32_t batch, bool fading, std::function<double(uint32_t pass)> bias_scale);

    // After pass `pass`.
    void end_pass(uint32_t pass, const Luminance& sums);
    // Adds the passes of a film of the same kind. To be called before the films' own sums are added.
    void merge(const ErrorSums& other, const Luminance& own_sums, const Luminance& other_sums);

    ErrorEstimate estimate(uint32_t passes, const Luminance& sums) const;
    // One channel: the standard error of each pixel, relative as in ErrorEstimate; 1 where fewer than two batches are
    // complete. With a fading bias a second one: the bias of the pixel's block, with its sign; 0 with fewer than four.
    Image image(uint32_t passes, const Luminance& sums) const;

    // As Film::write_state. Reading: `sums` are those of the film read; the stream is left failed if it ends early.
    void write(std::ostream& out, const Luminance& sums) const;
    void read(std::istream& in, const Luminance& sums);

    bool fading() const { return fading_; }

private:
    struct Open {
        uint32_t passes = 0;
        uint64_t weight = 0;          // x in units of 1/1024
        std::vector<Fixed128> light;  // luminance of these passes
    };
    // Of a pixel's mean over all passes: its variance, the bias that is left in it, and the variance of the latter.
    struct Fit {
        double variance = 0, bias = 0, bias_variance = 0;
    };
    struct Block {
        double mean = 0, bias = 0, bias_variance = 0;
    };

    size_t pixels() const { return start_.size(); }
    size_t block_of(size_t pixel) const;
    double mean(size_t pixel, uint32_t passes, const Luminance& sums) const;
    // A tenth of the image's mean luminance.
    double floor(uint32_t passes, const Luminance& sums) const;
    uint64_t weight_of(uint32_t pass) const;
    // Takes in a pixel's light in a complete batch, and counts the batch.
    void absorb(size_t pixel, Fixed128 light, uint64_t weight);
    void count(uint64_t weight);
    // Adds a part of a batch to what there is of it, and takes it in when it is complete.
    void close(uint32_t index, Open part);
    // The part of the running batch.
    Open running(const Luminance& sums) const;
    Fit fit(size_t pixel, uint32_t passes) const;
    std::vector<Block> blocks(uint32_t passes, const Luminance& sums) const;

    int width_, height_;
    uint32_t batch_;
    bool fading_;
    std::function<double(uint32_t)> bias_scale_;

    std::vector<Fixed128> start_;     // luminance when the running batch began
    std::vector<Fixed128> squares_;   // of the complete batches' mean luminances
    std::vector<Fixed128> weighted_;  // luminance times weight
    uint64_t batches_ = 0, weights_ = 0, squared_weights_ = 0;
    uint32_t running_index_ = 0, running_passes_ = 0;
    std::map<uint32_t, Open> open_;
};

}  // namespace dapple
