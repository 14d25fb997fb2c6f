// What every algorithm is to the rest of the program: it renders pass i of a world into a film. A pass depends on the
// world, the settings, the seed and i alone.
#pragma once

#include "dapple/film/film.h"
#include "dapple/integrators/settings.h"
#include "dapple/world/world.h"

#include <atomic>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dapple {

// Counters of work done, for progress and performance reports. Not part of any result.
struct Statistics {
    std::atomic<uint64_t> eye_paths{0};
    std::atomic<uint64_t> light_paths{0};
    std::atomic<uint64_t> photons_stored{0};
    std::atomic<uint64_t> rays{0};
};

struct PassContext {
    const World& world;
    uint64_t seed = 0;
    uint32_t pass = 0;
    Statistics& statistics;
    const std::atomic<bool>* cancel = nullptr;  // set: return soon, without beginning more pixels
    // The same samples in rounds of one pixel in every block of 4 x 4, for a first pass that may be cut: it has reached
    // all parts of the image after one round.
    bool coarse_to_fine = false;
    static constexpr int block = 4;
    bool cancelled() const { return cancel && cancel->load(std::memory_order_relaxed); }
};

class TechniqueFilms;

// What passes keep in memory beside the film.
struct PassMemory {
    double bytes = 0.0;
    std::string_view of;  // "photon maps", ...
};

class Integrator {
public:
    virtual ~Integrator() = default;
    // Adds pass context.pass to the film (without calling film.end_pass()).
    virtual void render_pass(const PassContext& context, Film& film) = 0;
    // From now on what each technique brings goes to these films too; false when the algorithm has no techniques.
    virtual bool record_techniques(TechniqueFilms& /*films*/) { return false; }
    // Whether all light of a pass comes to the film by Film::add_pixel: then a pass that is cut short may be kept.
    virtual bool adds_eye_samples_alone() const { return false; }
    // One line each: what the settings resolved to for this world ("radius 3.2 mm from the pixel footprint", ...).
    virtual std::vector<std::string> report() const { return {}; }
    // Passes in a row that share what they trace (photon maps of an epoch, say) and are therefore no independent
    // samples: passes [k n, (k + 1) n). Error estimates go by such groups.
    virtual uint32_t correlated_passes() const { return 1; }
    // Size of the bias of a pass's light that fades with the passes, relative to that of pass 0: the squared radius of
    // a progressive estimate, say, in (0, 1]. The same for correlated passes. 0: nothing fades (no bias, or all of it
    // stays).
    virtual double bias_scale(uint32_t /*pass*/) const { return 0.0; }
    // About what a pass for such a film keeps (IntegratorEntry::bytes_per_pixel apart), from a few thousand light
    // paths.
    virtual PassMemory pass_memory(const PassContext& /*context*/, const FilmSettings& /*film*/) const { return {}; }
};

// One line of the registry: everything the command line, the docs and the tests need to know of an algorithm.
struct IntegratorEntry {
    std::string_view name;
    std::string_view summary;
    std::span<const SettingInfo> settings;
    bool media = false;          // handles scattering media
    bool photon_layers = false;  // fills photon density and radius
    std::unique_ptr<Integrator> (*create)(const World& world, const Settings& settings);
    uint64_t bytes_per_pixel = 0;  // what a pass keeps for each pixel besides the film
};

std::span<const IntegratorEntry> integrator_registry();
// Throws UserError with the nearest known name.
const IntegratorEntry& find_integrator(std::string_view name);

}  // namespace dapple
