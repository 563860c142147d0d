// Checks of fuzzers. A violated check aborts, and libFuzzer then keeps the input.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "octopair/error.hpp"

namespace octopair::fuzz {

inline void require(bool holds) {
    if (!holds) std::abort();
}

/// How a reader may refuse its input.
struct Refusal {
    std::string_view begin = {};  ///< of the message
    std::vector<ErrorCode> codes = {ErrorCode::bad_input};
    bool printable = false;  ///< true: the message has no control characters
    bool one_line = true;
};

/// Calls a reader. Requires that an Error is as `refusal` says.
template <typename Read>
void require_clear_errors(const Refusal& refusal, const Read& read) {
    try {
        read();
    } catch (const Error& error) {
        const std::string_view words = error.what();
        require(std::ranges::find(refusal.codes, error.code()) != refusal.codes.end());
        require(words.starts_with(refusal.begin));
        require(!refusal.one_line || words.find('\n') == std::string_view::npos);
        const auto is_control = [](char c) { return c >= 0 && c < ' '; };
        require(!refusal.printable || std::ranges::none_of(words, is_control));
    }
}

}  // namespace octopair::fuzz
