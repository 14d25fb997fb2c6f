// How much a render under a time limit can afford before its first eye path: light paths, records of a cache. Automatic
// numbers are for renders that take their time; under a short limit they would leave none for the picture. So they are
// tried out first, with growing shares of the work that are thrown away, and halved until they fit. What comes of it is
// a setting like one that the user gives: it is in the header of the file, and checkpoints go on with it.
//
// The trials take some 5 % of the time where they find that numbers must be lowered (a fifth at worst, for each of the
// numbers), and some 20 ms where the limit is long. Halves, and not just any number, so that renders on machines of a
// kind can be merged.
#pragma once

#include "dapple/render/scene_defaults.h"

#include <functional>
#include <string>
#include <vector>

namespace dapple {

// The largest of effort.automatic, its half, its quarter, ... that takes no more than its share of `seconds`, and
// effort.least at least. try_out(n) does the work of n and returns how long it took [s].
int64_t affordable(const Effort& effort, double seconds, const std::function<double(int64_t n)>& try_out);

// Lowers the settings of choice that are automatic, and too large for a render that has `seconds` [s] for everything;
// others stay. Returns a line for each that was lowered: "250,000 light paths per pass instead of 1,000,000".
std::vector<std::string> fit_to_time(IntegratorChoice& choice, const World& world, const FilmSettings& film,
                                     uint64_t seed, double seconds);

}  // namespace dapple
