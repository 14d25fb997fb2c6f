#include "dapple/base/error.h"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <vector>

namespace dapple {
namespace {

int lower(char c) { return std::tolower(static_cast<unsigned char>(c)); }

// Insertions, deletions, substitutions and swaps of neighbours that turn a into b (Damerau 1964), whatever the case.
int edit_distance(std::string_view a, std::string_view b)
{
    std::vector<int> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
    std::iota(row.begin(), row.end(), 0);
    for (size_t i = 1; i <= a.size(); ++i) {
        std::swap(before, above);
        std::swap(above, row);
        row[0] = static_cast<int>(i);
        for (size_t j = 1; j <= b.size(); ++j) {
            const bool same = lower(a[i - 1]) == lower(b[j - 1]);
            row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + !same});
            const bool swapped =
                i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
            if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
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
