#include "dapple/base/error.h"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <vector>

namespace dapple {
namespace {

int edit_distance(std::string_view a, std::string_view b)
{
    std::vector<int> row(b.size() + 1);
    std::iota(row.begin(), row.end(), 0);
    for (size_t i = 1; i <= a.size(); ++i) {
        int diagonal = row[0];
        row[0] = static_cast<int>(i);
        for (size_t j = 1; j <= b.size(); ++j) {
            const int substitution = diagonal + (std::tolower(a[i - 1]) != std::tolower(b[j - 1]));
            diagonal = row[j];
            row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitution});
        }
    }
    return row.back();
}

}  // namespace

std::string SourceLocation::to_string() const
{
    std::string text = file;
    if (line > 0) text.append(1, ':').append(std::to_string(line));
    if (line > 0 && column > 0) text.append(1, ':').append(std::to_string(column));
    return text;
}

UserError::UserError(const std::string& message) : std::runtime_error(message) {}

UserError::UserError(const SourceLocation& where, const std::string& message)
    : std::runtime_error(where.file.empty() ? message : where.to_string() + ": " + message)
{
}

std::string_view nearest_word(std::string_view word, std::span<const std::string_view> known)
{
    std::string_view best;
    // A third of the letters may differ: enough for a slip, too little for another word.
    int best_distance = std::max<int>(1, static_cast<int>(word.size()) / 3) + 1;
    for (std::string_view candidate : known) {
        const int distance = edit_distance(word, candidate);
        if (distance < best_distance) {
            best_distance = distance;
            best = candidate;
        }
    }
    return best;
}

std::string did_you_mean(std::string_view word, std::span<const std::string_view> known)
{
    const std::string_view nearest = nearest_word(word, known);
    return nearest.empty() ? std::string() : "; did you mean '" + std::string(nearest) + "'?";
}

}  // namespace dapple
