#include "dapple/render/checkpoint.h"

#include "dapple/base/error.h"
#include "dapple/render/state_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>

namespace dapple {
namespace {

constexpr const char* kind = "render";

// Values separated by spaces.
template <class... Values>
std::string line(const Values&... values)
{
    std::ostringstream out;
    out.precision(17);
    ((out << values << ' '), ...);
    std::string text = out.str();
    text.pop_back();
    return text;
}

template <class... Values>
void parse(const std::string& path, const std::string& text, Values&... values)
{
    std::istringstream in(text);
    ((in >> values), ...);
    if (!in) throw UserError(fmt::format("'{}' is damaged: '{}' is no value of a checkpoint", path, text));
}

StateFields to_fields(const CheckpointHeader& header)
{
    StateFields fields;
    const auto add = [&](const char* key, const std::string& text) { fields.emplace_back(key, text); };
    const RenderRecord& record = header.record;
    add("version", record.version);
    add("command", record.command);
    add("scene", record.scene);
    add("integrator", record.integrator);
    for (const std::string& text : record.report) add("report", text);
    add("seed", line(record.seed));
    add("threads", line(record.threads));
    for (const auto& [name, value] : header.settings) add("setting", fmt::format("{}={}", name, value));
    for (const auto& [name, hash] : header.files) add("file", fmt::format("{} {}", hash, name));
    add("coats", line(header.pbrt_coats));

    const FilmSettings& film = header.film;
    add("resolution", line(film.resolution.x, film.resolution.y));
    add("crop", line(film.crop_min.x, film.crop_min.y, film.crop_max.x, film.crop_max.y));
    add("color", line(static_cast<int>(film.color_model)));
    add("layers", line(film.class_layers, film.guide_layers, film.photon_layers, film.error_layer));
    add("correlation", line(film.correlated_passes, film.fading_bias));
    for (const std::string& group : film.light_groups) add("group", group);

    for (const PassRange& range : header.ranges) add("range", line(range.first, range.count));
    const RenderCounters& counters = header.counters;
    add("seconds", line(counters.seconds));
    add("counters", line(counters.eye_paths, counters.light_paths, counters.photons, counters.rays));
    add("automatic", line(header.automatic));
    for (const std::string& argument : header.arguments) add("argument", argument);
    add("folder", header.folder);
    return fields;
}

class FieldReader {
public:
    FieldReader(std::string path, StateFields fields) : path_(std::move(path)), fields_(std::move(fields)) {}

    std::vector<std::string> all(const std::string& key) const
    {
        std::vector<std::string> texts;
        for (const auto& [name, text] : fields_)
            if (name == key) texts.push_back(text);
        return texts;
    }
    std::string text(const std::string& key) const
    {
        const std::vector<std::string> texts = all(key);
        if (texts.size() != 1) throw UserError(fmt::format("'{}' is damaged: it has no '{}'", path_, key));
        return texts[0];
    }
    template <class... Values>
    void get(const std::string& key, Values&... values) const
    {
        parse(path_, text(key), values...);
    }
    // "name separator value" of each field of that key.
    std::vector<std::pair<std::string, std::string>> pairs(const std::string& key, char separator) const
    {
        std::vector<std::pair<std::string, std::string>> found;
        for (const std::string& text : all(key)) {
            const size_t at = std::min(text.find(separator), text.size());
            found.emplace_back(text.substr(0, at), text.substr(std::min(at + 1, text.size())));
        }
        return found;
    }

private:
    std::string path_;
    StateFields fields_;
};

CheckpointHeader from_fields(const std::string& path, const FieldReader& fields)
{
    CheckpointHeader header;
    RenderRecord& record = header.record;
    record.version = fields.text("version");
    record.command = fields.text("command");
    record.scene = fields.text("scene");
    record.integrator = fields.text("integrator");
    record.report = fields.all("report");
    fields.get("seed", record.seed);
    fields.get("threads", record.threads);
    header.settings = fields.pairs("setting", '=');
    for (auto& [hash, name] : fields.pairs("file", ' ')) header.files.emplace_back(name, hash);
    fields.get("coats", header.pbrt_coats);

    FilmSettings& film = header.film;
    int color = 0;
    fields.get("resolution", film.resolution.x, film.resolution.y);
    fields.get("crop", film.crop_min.x, film.crop_min.y, film.crop_max.x, film.crop_max.y);
    fields.get("color", color);
    film.color_model = static_cast<ColorModel>(color);
    fields.get("layers", film.class_layers, film.guide_layers, film.photon_layers, film.error_layer);
    fields.get("correlation", film.correlated_passes, film.fading_bias);
    film.light_groups = fields.all("group");

    for (const std::string& text : fields.all("range")) {
        PassRange range;
        parse(path, text, range.first, range.count);
        header.ranges.push_back(range);
    }
    if (!header.ranges.empty()) film.first_pass = header.ranges.front().first;
    RenderCounters& counters = header.counters;
    fields.get("seconds", counters.seconds);
    fields.get("counters", counters.eye_paths, counters.light_paths, counters.photons, counters.rays);
    fields.get("automatic", header.automatic);
    header.arguments = fields.all("argument");
    header.folder = fields.text("folder");
    return header;
}

std::string settings_text(const CheckpointHeader& header)
{
    std::vector<std::string> texts;
    for (const auto& [name, value] : header.settings) texts.push_back(fmt::format("{}={}", name, value));
    std::sort(texts.begin(), texts.end());
    return texts.empty() ? "the defaults" : fmt::format("{}", fmt::join(texts, " "));
}

std::string layers_text(const FilmSettings& film)
{
    std::string text = "beauty";
    if (film.guide_layers) text += ",guides";
    if (film.class_layers) text += ",classes";
    if (film.photon_layers) text += ",photons";
    if (film.error_layer) text += ",error";
    for (const std::string& group : film.light_groups) text += ",group " + light_group_label(group);
    return text;
}

// Which file of the scene is another one, by the order in which they are read.
std::string scene_difference(const std::vector<HashedFile>& a, const std::vector<HashedFile>& b)
{
    for (size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        if (a[i].second != b[i].second) return fmt::format("another scene: '{}' differs", a[i].first);
    if (a.size() == b.size()) return {};
    const HashedFile& more = a.size() > b.size() ? a[b.size()] : b[a.size()];
    return fmt::format("another scene: only one of them reads '{}'", more.first);
}

// Adds ranges to ranges; false when a pass would be there twice.
bool unite(std::vector<PassRange>& ranges, const std::vector<PassRange>& others)
{
    std::vector<PassRange> all = ranges;
    all.insert(all.end(), others.begin(), others.end());
    std::sort(all.begin(), all.end(), [](const PassRange& a, const PassRange& b) { return a.first < b.first; });
    std::vector<PassRange> united;
    for (const PassRange& range : all) {
        if (range.count == 0) continue;
        if (!united.empty() && range.first < united.back().end()) return false;
        if (!united.empty() && range.first == united.back().end())
            united.back().count += range.count;
        else
            united.push_back(range);
    }
    ranges = std::move(united);
    return true;
}

}  // namespace

std::string ranges_text(const std::vector<PassRange>& ranges)
{
    std::string text;
    for (const PassRange& range : ranges)
        text += fmt::format("{}{} to {}", text.empty() ? "" : ", ", range.first, range.end() - 1);
    return text.empty() ? "none" : text;
}

uint32_t CheckpointHeader::passes() const
{
    uint32_t sum = 0;
    for (const PassRange& range : ranges) sum += range.count;
    return sum;
}

void write_checkpoint(const std::string& path, const CheckpointHeader& header, const Film& film)
{
    write_state_file(path, kind, to_fields(header), [&](std::ostream& out) { film.write_state(out); });
}

CheckpointHeader read_checkpoint_header(const std::string& path)
{
    return from_fields(path, FieldReader(path, read_state_fields(path, kind)));
}

void read_checkpoint_film(const std::string& path, Film& film)
{
    read_state_body(path, kind, [&](std::istream& in) {
        try {
            film.read_state(in);
        } catch (const UserError& error) {
            throw UserError(fmt::format("'{}' does not fit: {}", path, error.what()));
        }
    });
}

Checkpoint read_checkpoint(const std::string& path)
{
    Checkpoint checkpoint;
    checkpoint.header = read_checkpoint_header(path);
    checkpoint.film = std::make_unique<Film>(checkpoint.header.film);
    read_checkpoint_film(path, *checkpoint.film);
    return checkpoint;
}

std::string difference(const CheckpointHeader& a, const CheckpointHeader& b)
{
    if (a.record.version != b.record.version)
        return fmt::format("written by Dapple {}, not {}", b.record.version, a.record.version);
    if (const std::string scene = scene_difference(a.files, b.files); !scene.empty()) return scene;
    const auto values = [](const char* what, const auto& one, const auto& other) {
        return one == other ? std::string() : fmt::format("{} {}, not {}", what, other, one);
    };
    const auto size = [](const FilmSettings& film) {
        return fmt::format("{}x{}", film.resolution.x, film.resolution.y);
    };
    const auto crop = [](const FilmSettings& film) {
        return fmt::format("{},{},{},{}", film.crop_min.x, film.crop_max.x, film.crop_min.y, film.crop_max.y);
    };
    const auto color = [](const FilmSettings& film) {
        return film.color_model == ColorModel::rgb ? "rgb" : "spectral";
    };
    for (const std::string& text :
         {values("integrator", a.record.integrator, b.record.integrator),
          values("settings", settings_text(a), settings_text(b)), values("seed", a.record.seed, b.record.seed),
          values("resolution", size(a.film), size(b.film)), values("crop", crop(a.film), crop(b.film)),
          values("colour model", std::string(color(a.film)), std::string(color(b.film))),
          values("layers", layers_text(a.film), layers_text(b.film)),
          values("--pbrt-coats", a.pbrt_coats, b.pbrt_coats)})
        if (!text.empty()) return text;
    return {};
}

void merge_checkpoint(Checkpoint& whole, const Checkpoint& other, const std::string& path)
{
    if (const std::string reason = difference(whole.header, other.header); !reason.empty())
        throw UserError(fmt::format("'{}' belongs to another render: {}", path, reason));
    const std::string before = ranges_text(whole.header.ranges);
    if (!unite(whole.header.ranges, other.header.ranges))
        throw UserError(fmt::format("'{}' holds passes {}, of which some are already there ({})", path,
                                    ranges_text(other.header.ranges), before));
    whole.film->merge(*other.film);
    RenderCounters& sum = whole.header.counters;
    const RenderCounters& more = other.header.counters;
    sum.seconds += more.seconds;
    sum.eye_paths += more.eye_paths;
    sum.light_paths += more.light_paths;
    sum.photons += more.photons;
    sum.rays += more.rays;
}

}  // namespace dapple
