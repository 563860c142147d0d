// Checks options whose value is one of a few words.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace octopair::cli {

/// The words of an option.
struct Words {
    std::string_view option;
    std::vector<std::string_view> present;  ///< valid words
    std::vector<std::string_view> later;    ///< words that a later version will accept
};

/// Throws: Error{usage} that lists the valid words, unless `word` is valid.
void check_word(const Words& words, const std::string& word);

}  // namespace octopair::cli
