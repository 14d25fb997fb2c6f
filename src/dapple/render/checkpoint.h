// Checkpoints: the film of a render with everything that says which render it is, how far it is, and how to go on. A
// pass is a function of world, seed and its index, and the film's sums are exact; so a render goes on from a checkpoint
// to the bits of an uninterrupted one, and checkpoints of disjoint passes merge to those of one render.
#pragma once

#include "dapple/film/film.h"
#include "dapple/render/content_hash.h"
#include "dapple/render/output.h"
#include "dapple/render/render_job.h"

#include <memory>
#include <string>
#include <vector>

namespace dapple {

// Passes [first, first + count).
struct PassRange {
    uint32_t first = 0;
    uint32_t count = 0;
    uint32_t end() const { return first + count; }
};

// "0 to 3, 10 to 13".
std::string ranges_text(const std::vector<PassRange>& ranges);

struct CheckpointHeader {
    // Which render: all of this must be equal for two files to belong together.
    RenderRecord record;  // its version, integrator and seed; the rest only tells how it was made
    std::vector<std::pair<std::string, std::string>> settings;  // of the integrator, those that were set
    std::vector<HashedFile> files;                              // of the scene
    bool pbrt_coats = false;
    FilmSettings film;  // without filter, sensor and bias_scale, which follow from the scene

    // How far: ranges in order, none touching another.
    std::vector<PassRange> ranges;
    RenderCounters counters;

    bool automatic = false;  // nobody asked for this file: it is removed when the render is done

    // How to go on: the arguments of `dapple render`, and the folder it was started in.
    std::vector<std::string> arguments;
    std::string folder;

    uint32_t passes() const;
};

void write_checkpoint(const std::string& path, const CheckpointHeader& header, const Film& film);

struct Checkpoint {
    CheckpointHeader header;
    std::unique_ptr<Film> film;  // of header.film: it can be merged and shown, not continued
};

// Throw UserError when the file is missing, foreign, of another format, cut or damaged.
CheckpointHeader read_checkpoint_header(const std::string& path);
Checkpoint read_checkpoint(const std::string& path);
// Into the film of the same render.
void read_checkpoint_film(const std::string& path, Film& film);

// What keeps `b` from belonging to the same render as `a`, in words ("seed 2, not 1"), or an empty string.
std::string difference(const CheckpointHeader& a, const CheckpointHeader& b);

// Adds the passes of `other`, read from `path`, to `whole`. Throws UserError, naming `path` and the reason, when they
// are of another render or when passes would count twice.
void merge_checkpoint(Checkpoint& whole, const Checkpoint& other, const std::string& path);

}  // namespace dapple
