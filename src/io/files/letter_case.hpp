// Comparison of texts without regard to the case of ASCII letters.
#pragma once

#include <algorithm>
#include <string_view>

namespace octopair::io {

/// Returns whether two texts are equal but for the case of ASCII letters.
inline bool equal_in_any_case(std::string_view a, std::string_view b) {
    constexpr auto small = [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; };
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) { return small(x) == small(y); });
}

}  // namespace octopair::io
