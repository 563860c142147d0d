// foretells(): compares messages about results that cannot fit.
#pragma once

#include <regex>
#include <string>

namespace octopair::test {

/// Returns true if `message` is `exact`. A slow machine counts only a part of the pairs: then the message says "more than" and has other
/// numbers, and the rest is the same.
inline bool foretells(const std::string& message, const std::string& exact) {
    if (message.find("more than ") == std::string::npos) return message == exact;
    const auto words = [](const std::string& text) {
        const std::string bounds = std::regex_replace(text, std::regex("(more than|at least) "), "");
        return std::regex_replace(bounds, std::regex("[0-9][0-9,.]* ([KMGT]?B|bytes|pairs)"), "#");
    };
    return words(message) == words(exact);
}

}  // namespace octopair::test
