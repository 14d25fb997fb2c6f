#include "dapple/render/technique_record.h"

#include "dapple/base/error.h"
#include "dapple/base/log.h"
#include "dapple/image/image_file.h"
#include "dapple/render/memory.h"

#include <fmt/format.h>

namespace dapple {

TechniqueRecord::TechniqueRecord(const FilmSettings& settings, Integrator& integrator, std::string_view name)
    : films_(settings), crop_min_(settings.crop_min), full_size_(settings.resolution)
{
    if (!integrator.record_techniques(films_))
        throw UserError(
            fmt::format("--techniques: '{}' has one technique only; lightpath, bdpt and vcm have more", name));
}

uint64_t TechniqueRecord::bytes(const FilmSettings& settings)
{
    // The layers of both films as one image of floats, and those of one beside, are three quarters of a film.
    return film_bytes(TechniqueFilms::film_settings(settings)) / 4 * 11;
}

void TechniqueRecord::after_pass(const Film&, const RenderCounters&) { films_.end_pass(); }

bool TechniqueRecord::write(const std::string& path, const RenderResult& result) const
{
    if (!result.film_whole) {
        log_warning("'{}' is not written: the last pass was given up", path);
        return false;
    }
    WriteOptions options;
    const Image image = films_.layers(options.channel_names);
    options.data_origin = crop_min_;
    options.full_size = full_size_;
    write_image(path, image, options);
    return true;
}

}  // namespace dapple
