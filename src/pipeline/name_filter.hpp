// Patterns for names: `*` matches any number of characters, `?` matches one character, every other character matches itself.
// Characters are UTF-8; each byte that is not valid UTF-8 counts as a character.
#pragma once

#include <string_view>

namespace octopair {

/// Returns whether `name` matches `pattern`. Complexity: O(|name| * |pattern|).
bool matches_pattern(std::string_view name, std::string_view pattern);

}  // namespace octopair
