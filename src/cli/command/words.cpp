#include "cli/command/words.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "octopair/error.hpp"

namespace octopair::cli {

void check_word(const Words& words, const std::string& word) {
    if (std::find(words.present.begin(), words.present.end(), word) != words.present.end()) return;
    const bool known = std::find(words.later.begin(), words.later.end(), word) != words.later.end();
    throw Error(ErrorCode::usage,
                fmt::format("{}: '{}' {}; valid values: {}", words.option, word,
                            known ? "is not supported yet" : "is not a valid value", fmt::join(words.present, ", ")));
}

}  // namespace octopair::cli
