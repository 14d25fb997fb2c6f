#include "dapple/formats/pbrt_context.h"

#include <fmt/format.h>

namespace dapple {

std::filesystem::path PbrtContext::resolve(const std::string& file)
{
    std::filesystem::path path(file);
    if (!path.is_absolute() && !base_folder_.empty()) path = base_folder_ / path;
    if (known_files_.insert(path).second) files_.push_back(path);
    return path;
}

void PbrtContext::check_files_allowed(const SourceLocation& where) const
{
    if (!limits_.other_files) throw UserError(where, "other files may not be read here");
}

void PbrtContext::warn(const SourceLocation& where, const std::string& text)
{
    const auto [entry, fresh] = warning_by_text_.try_emplace(text, warnings_.size());
    if (fresh)
        warnings_.push_back({where, text, 0});
    else
        ++warnings_[entry->second].repeats;
}

std::vector<std::string> PbrtContext::warnings() const
{
    std::vector<std::string> lines;
    for (const Warning& warning : warnings_) {
        std::string line = warning.where.file.empty() ? warning.text : warning.where.to_string() + ": " + warning.text;
        if (warning.repeats > 0) line += fmt::format(" (and {} more)", warning.repeats);
        lines.push_back(std::move(line));
    }
    return lines;
}

std::string suggest(std::string_view word, std::span<const std::string_view> known)
{
    constexpr size_t longest = 64;  // no known word is longer
    return word.size() > longest ? std::string() : did_you_mean(word, known);
}

}  // namespace dapple
