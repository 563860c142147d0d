#include "cli/command/suggestion.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <limits>

namespace octopair::cli {

namespace {

std::string plain(std::string_view word) {
    word.remove_prefix(std::min(word.find_first_not_of('-'), word.size()));
    std::string letters(word);
    for (char& c : letters) c = char(std::tolower(static_cast<unsigned char>(c)));
    return letters;
}

/// Returns the least number of typing errors between two words (optimal string alignment).
/// Complexity: O(a.size() * b.size()).
std::size_t typing_errors(std::string_view a, std::string_view b) {
    // rows[0][j]: errors between the first i letters of `a` and the first j of `b`. rows[1] and rows[2]: for i - 1 and i - 2.
    std::array<std::vector<std::size_t>, 3> rows;
    for (auto& row : rows) row.resize(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) rows[0][j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::rotate(rows.begin(), rows.begin() + 2, rows.end());
        rows[0][0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t wrong = rows[1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            rows[0][j] = std::min({wrong, rows[1][j] + 1, rows[0][j - 1] + 1});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                rows[0][j] = std::min(rows[0][j], rows[2][j - 2] + 1);
        }
    }
    return rows[0][b.size()];
}

}  // namespace

std::string did_you_mean(std::string_view word, const std::vector<std::string_view>& candidates) {
    constexpr std::size_t longest = 100;  // a longer word is a path or a list, not a name
    if (word.size() > longest) return {};
    const std::string typed = plain(word);
    std::string_view closest;
    std::size_t fewest = std::numeric_limits<std::size_t>::max();
    for (const std::string_view candidate : candidates) {
        const std::string right = plain(candidate);
        const bool begins = typed.size() >= 3 && right.starts_with(typed);
        const std::size_t errors = begins ? 1 : typing_errors(typed, right);
        if (errors < fewest && errors <= std::max(typed.size(), right.size()) / 3) {
            fewest = errors;
            closest = candidate;
        }
    }
    return closest.empty() ? std::string() : "; did you mean '" + std::string(closest) + "'?";
}

}  // namespace octopair::cli
