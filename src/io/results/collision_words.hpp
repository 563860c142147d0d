// Reads the words of collision results: the classes, the kinds of depth, the changes.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/json/json_fields.hpp"
#include "io/results/collision_row.hpp"

namespace octopair::io {

template <typename Word>
inline constexpr std::size_t words_of = 0;
template <>
inline constexpr std::size_t words_of<CollisionClass> = collision_classes;
template <>
inline constexpr std::size_t words_of<DepthKind> = 3;
template <>
inline constexpr std::size_t words_of<Change> = 3;

/// Returns the value whose word (word_of()) is `text`. Throws: Error{bad_input} that begins with `place` and names all words.
template <typename Word>
Word value_of_word(std::string_view text, const std::string& place) {
    std::string known;
    for (std::size_t i = 0; i < words_of<Word>; ++i) {
        if (word_of(Word(i)) == text) return Word(i);
        known += fmt::format("{}{}", i == 0 ? "" : ", ", word_of(Word(i)));
    }
    refuse(place, fmt::format("'{}' is none of {}", shown_text(text), known));
}

}  // namespace octopair::io
