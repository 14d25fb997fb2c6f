// The films of `dapple render --techniques`, kept in step with the render.
#pragma once

#include "dapple/integrators/technique_films.h"
#include "dapple/render/render_job.h"

#include <string>
#include <string_view>

namespace dapple {

class TechniqueRecord final : public PassObserver {
public:
    // settings: of the film of the beauty. Throws UserError if the integrator, called `name`, has no techniques.
    TechniqueRecord(const FilmSettings& settings, Integrator& integrator, std::string_view name);

    // What it takes beside such a film, at most: two films, and copies of their layers while they are written.
    static uint64_t bytes(const FilmSettings& settings);

    void after_pass(const Film& film, const RenderCounters& counters) override;

    // Writes all layers as .exr and returns true; warns instead where the films do not hold whole passes. Throws
    // UserError as write_image does.
    bool write(const std::string& path, const RenderResult& result) const;

private:
    TechniqueFilms films_;
    Int2 crop_min_;
    Int2 full_size_;
};

}  // namespace dapple
