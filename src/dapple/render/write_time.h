// How long writing the files of a render will take, so that a time limit can leave room for it. What takes the time is
// compressing, which depends on the picture: noise takes many times as long as black. So black rows and rows of noise
// are written before the render, to the temporary folder, and when the limit is near, some rows of the picture are
// compressed to see where between the two it lies.
#pragma once

#include "dapple/film/film.h"

#include <string>
#include <vector>

namespace dapple {

struct WriteTime {
    // For an image of black alone, and of noise alone, from the film to the files [s].
    double black = 0, noise = 0;
    double layers = 0;  // of these, for making the image out of the film
    // For compressing a row of each (zip_seconds) [s].
    double zip_black = 0, zip_noise = 0;

    // For an image with rows like these, of the same channels [s]. Takes as long as compressing them. to_come: channels
    // that will be as noise where the rows show anything, and are black now.
    double seconds(const Image& rows, int to_come = 0) const;
    static constexpr int late_channels = 6;  // where light comes last: indirect light, its noise in the beauty, density
    // Before anything is known of it.
    double expected() const { return black + usual_detail * (noise - black); }
    static constexpr double usual_detail = 0.3;
};

// For files of these endings with the layers of such a film. .dapple files are not counted: they are written for
// renders that keep no limit. 0 where the temporary folder takes no files. Takes some hundredths of a second.
WriteTime time_to_write(const std::vector<std::string>& paths, const FilmSettings& film, bool half);

}  // namespace dapple
