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
    // The same samples in rounds of one pixel in every block of 16 x 16, for a first pass that may be cut: it has
    // reached all parts of the image after one round.
    bool coarse_to_fine = false;
    static constexpr int block = 16;
    // Given where a part of the pass may be kept; set when half of the time that it may take is over. For passes whose
    // eye paths come first: they end then, so that light paths have the other half.
    const std::atomic<bool>* half_time = nullptr;
    // To see how long that takes: return before the first eye path.
    bool without_eye_paths = false;
    bool cancelled() const { return cancel && cancel->load(std::memory_order_relaxed); }
};

class TechniqueFilms;

// What passes keep in memory beside the film.
struct PassMemory {
    double bytes = 0.0;
    std::string_view of;  // "photon maps", ...
};

// A setting whose automatic number decides how long passes take before their first eye path, or whole epochs of them.
struct Effort {
    std::string_view setting;
    std::string_view of;     // "light paths per pass", ...
    int64_t automatic = 0;   // what "auto" stands for in this film
    int64_t least = 0;       // fewer are not worth a pass
    double share = 1.0 / 3;  // of the time of a render that they may take at once
};

class Integrator {
public:
    virtual ~Integrator() = default;
    // Adds pass context.pass to the film (without calling film.end_pass()).
    virtual void render_pass(const PassContext& context, Film& film) = 0;
    // From now on what each technique brings goes to these films too; false when the algorithm has no techniques.
    virtual bool record_techniques(TechniqueFilms& /*films*/) { return false; }
    // Whether all light of a pass comes to the film by Film::add_pixel: then pixels that a cut pass did not reach are
    // as they were before it. Of other passes, what is cut may be kept together with the image before them: pixels that
    // Film::add_pixel was called for have all of their light, or Film::give_up_pass was called.
    virtual bool adds_eye_samples_alone() const { return false; }
    // Whether much of the light of a pass that may be cut comes to the film at its end alone.
    virtual bool light_comes_last() const { return false; }
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
    // What may be lowered for passes to begin their eye paths sooner.
    virtual std::vector<Effort> efforts(const PassContext& /*context*/, const FilmSettings& /*film*/) const
    {
        return {};
    }
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
    bool second_film = false;      // under a time limit a pass keeps its light in a film of its own
};

std::span<const IntegratorEntry> integrator_registry();
// Throws UserError with the nearest known name.
const IntegratorEntry& find_integrator(std::string_view name);

}  // namespace dapple
