// What a render will take, known before it starts.
#include "dapple/render/memory.h"

#include "dapple/base/error.h"
#include "dapple/render/duration.h"

#include <fmt/format.h>

#include <algorithm>

namespace dapple {

uint64_t pixel_count(const FilmSettings& settings)
{
    const Int2 size = settings.crop_max - settings.crop_min;
    return static_cast<uint64_t>(size.x) * static_cast<uint64_t>(size.y);
}

uint64_t film_bytes(const FilmSettings& settings)
{
    // Sums exist per class even where only the beauty is shown; see PixelSample.
    const uint64_t channels = 3 * static_cast<uint64_t>(settings.class_layers ? path_class_count : 1) +
                              3 * settings.light_groups.size() + (settings.guide_layers ? 10 : 0) +
                              (settings.photon_layers ? 2 : 0);
    const uint64_t errors = settings.error_layer ? (settings.fading_bias ? 3 : 2) : 0;
    return pixel_count(settings) * (channels + errors) * 16;
}

uint64_t scene_bytes(const CompileReport& report)
{
    return report.geometry_bytes + report.accelerator_bytes + report.texture_bytes + report.medium_bytes;
}

void check_memory(uint64_t limit, const CompileReport& report, const FilmSettings& settings, IntegratorChoice& choice,
                  uint64_t techniques)
{
    if (limit == 0) return;
    const auto size = [](uint64_t bytes) { return format_size(static_cast<double>(bytes)); };
    const uint64_t scene = scene_bytes(report);
    const uint64_t film = film_bytes(settings) / 4 * 5;
    const uint64_t points = pixel_count(settings) * choice.entry->bytes_per_pixel;
    const uint64_t fixed = program_bytes + scene + film + points + techniques;
    if (fixed >= limit)
        throw UserError(fmt::format(
            "--memory {} is not enough: the program takes {}, the scene {}, the film {}{}{} (fewer --layers or "
            "a smaller --resolution take less)",
            size(limit), size(program_bytes), size(scene), size(film),
            points > 0 ? fmt::format(", the pixels' points of {} {}", choice.entry->name, size(points)) : "",
            techniques > 0 ? fmt::format(", the layers of --techniques {}", size(techniques)) : ""));
    const auto has = [](const SettingInfo& info) { return info.name == "memory"; };
    if (std::any_of(choice.entry->settings.begin(), choice.entry->settings.end(), has) &&
        choice.settings.is_auto("memory"))
        choice.settings.set("memory", std::to_string(limit - fixed));
}

}  // namespace dapple
