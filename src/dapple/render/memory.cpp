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

MemoryAccount memory_account(const CompileReport& report, const FilmSettings& settings, const IntegratorEntry& entry,
                             uint64_t techniques, bool time_limit)
{
    MemoryAccount account;
    account.geometry = report.geometry_bytes;
    account.accelerator = report.accelerator_bytes;
    account.textures = report.texture_bytes;
    account.media = report.medium_bytes;
    account.film = film_bytes(settings) / 4 * 5;
    if (time_limit && entry.second_film) account.film += film_bytes(settings);
    account.points = pixel_count(settings) * entry.bytes_per_pixel;
    account.techniques = techniques;
    return account;
}

void check_memory(uint64_t limit, const MemoryAccount& account, IntegratorChoice& choice)
{
    if (limit == 0) return;
    const auto size = [](uint64_t bytes) { return format_size(static_cast<double>(bytes)); };
    if (account.total() >= limit)
        throw UserError(fmt::format(
            "--memory {} is not enough: the program takes {}, the scene {}, the film {}{}{} (fewer --layers or "
            "a smaller --resolution take less)",
            size(limit), size(account.program), size(account.scene()), size(account.film),
            account.points > 0
                ? fmt::format(", what {} keeps for each pixel {}", choice.entry->name, size(account.points))
                : "",
            account.techniques > 0 ? fmt::format(", the layers of --techniques {}", size(account.techniques)) : ""));
    const auto has = [](const SettingInfo& info) { return info.name == "memory"; };
    if (std::any_of(choice.entry->settings.begin(), choice.entry->settings.end(), has) &&
        choice.settings.is_auto("memory"))
        choice.settings.set("memory", std::to_string(limit - account.total()));
}

}  // namespace dapple
