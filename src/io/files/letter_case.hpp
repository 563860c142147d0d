// The case of ASCII letters in texts of files.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace octopair::io {

constexpr char in_lower_case(char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; }

inline std::string in_lower_case(std::string_view text) {
    std::string lower(text);
    for (char& c : lower) c = in_lower_case(c);
    return lower;
}

inline std::string in_upper_case(std::string_view text) {
    std::string upper(text);
    for (char& c : upper) c = c >= 'a' && c <= 'z' ? char(c - 'a' + 'A') : c;
    return upper;
}

/// Returns whether two texts are equal but for the case of ASCII letters.
inline bool equal_in_any_case(std::string_view a, std::string_view b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](char x, char y) { return in_lower_case(x) == in_lower_case(y); });
}

}  // namespace octopair::io
