// What can be wrong with a pair of a result, and how messages name it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "octopair/objects.hpp"
#include "verification/row_search.hpp"

namespace octopair {

/// What is wrong, for people; none: nothing.
using Fault = std::optional<std::string>;

/// Throws Error{engine_failed} with these words.
[[noreturn]] void throw_verification_failed(const std::string& words);

/// "pair (12, 40)"
std::string name_of_pair(const Pair& pair);

/// Whether the numbers of a pair are those of two objects: a < rows, b < columns, and a < b within one set.
bool has_position(const RowSearch& rows, const Pair& pair);
/// Says why a pair has none. Requires: has_position() is false.
std::string fault_of_position(const RowSearch& rows, const Pair& pair);

}  // namespace octopair
