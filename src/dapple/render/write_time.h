// How long writing the files of a render will take, so that a time limit can leave room for it. What takes the time is
// compressing, which depends on the picture: of values that are black it takes little, of those that repeat their
// neighbour some half. So black rows and rows of noise are written before the render, to the temporary folder, and the
// picture is looked at when the limit is near. On staircase2 (six algorithms, 28 to 30 layers, passes that were cut
// early and late; 1.0 to 1.3 s, 2.2 s for noise) that is right within 0.1 s.
#pragma once

#include "dapple/film/film.h"

#include <string>
#include <vector>

namespace dapple {

struct WriteTime {
    // For an image of black alone, and of noise alone, from the film to the files [s].
    double black = 0, noise = 0;

    // For one with so much detail, in [0, 1] [s].
    double seconds(double detail) const { return black + detail * (noise - black); }
    // Before anything is known of it.
    double expected() const { return seconds(usual_detail); }
    static constexpr double usual_detail = 0.42;
};

// For files of these endings with the layers of such a film. .dapple files are not counted: they are written for
// renders that keep no limit. 0 where the temporary folder takes no files. Takes some hundredths of a second.
WriteTime time_to_write(const std::vector<std::string>& paths, const FilmSettings& film, bool half);

// How much of an image takes time to compress, in [0, 1]; from some of its rows.
double detail_of(const Image& rows);

}  // namespace dapple
