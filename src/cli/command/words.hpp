// Options whose value is one of a few words.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace octopair::cli {

/// Those of `later` are known but not there yet.
struct Words {
    std::string_view option;
    std::vector<std::string_view> present;
    std::vector<std::string_view> later;
};

/// Throws Error{usage} that lists those present, unless `word` is one of them.
void check_word(const Words& words, const std::string& word);

}  // namespace octopair::cli
