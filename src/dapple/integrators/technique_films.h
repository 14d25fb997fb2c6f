// What each technique of a bidirectional method brings, on request: for paths of up to `longest` edges one layer per
// technique, weighted (all of them sum to the beauty) and as the technique would estimate its paths alone (unweighted:
// the same mean picture for all techniques of one length, where each of them can find all paths). Longer paths are
// collected in one layer, "rest".
#pragma once

#include "dapple/film/film.h"

#include <optional>
#include <string>
#include <vector>

namespace dapple {

// s vertices from the light, t from the eye; merged: the last of both is the same point.
struct Technique {
    int s = 0, t = 0;
    bool merged = false;
    int edges() const { return s + t - (merged ? 2 : 1); }
};

class TechniqueFilms {
public:
    // `like`: the film of the beauty.
    explicit TechniqueFilms(const FilmSettings& like, int longest = default_longest);
    // Of each of the two films.
    static FilmSettings film_settings(const FilmSettings& like, int longest = default_longest);

    LightGroup layer(const Technique& technique) const;

    void splat(const Vec2& raster, const Vec3& sensor_rgb, float weight, const Technique& technique);
    void end_pass();

    // All layers of the crop window, names "weighted.s1t2.R", "unweighted.m2t2.R", ...
    Image layers(std::vector<std::string>& channel_names) const;

    // The contributions of one eye path.
    class Sample {
    public:
        Sample(TechniqueFilms& films, Int2 pixel);
        void add(const Vec3& sensor_rgb, float weight, const Technique& technique);
        ~Sample();
        Sample(const Sample&) = delete;
        Sample& operator=(const Sample&) = delete;

    private:
        TechniqueFilms& films_;
        Int2 pixel_;
        PixelSample weighted_, unweighted_;
    };

private:
    static constexpr int default_longest = 6;

    int longest_;
    std::vector<std::string> names_;  // by layer
    Film weighted_, unweighted_;
};

}  // namespace dapple
