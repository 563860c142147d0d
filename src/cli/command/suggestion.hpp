// Suggestions for words with a typing error.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace octopair::cli {

/// Returns "; did you mean 'CANDIDATE'?" for the candidate that is most similar to `word`, or an empty text if none is similar.
/// Similar are: a word of three letters or more that a candidate begins with; otherwise a word with at most one typing error for
/// each three letters. A typing error is a letter too many, missing, wrong, or exchanged with its neighbour. Dashes at the front
/// and the case of letters do not count.
std::string did_you_mean(std::string_view word, const std::vector<std::string_view>& candidates);

}  // namespace octopair::cli
