// Faults of a result that concern one pair, and their messages.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "octopair/objects.hpp"
#include "verification/row_search.hpp"

namespace octopair {

/// Message for users that describes a fault of a result; none if there is no fault.
using ResultFault = std::optional<std::string>;

/// Throws: Error{engine_failed} with this message.
[[noreturn]] void throw_verification_failed(const std::string& message);

/// Returns a name such as "pair (12, 40)".
std::string name_of_pair(const Pair& pair);

/// Returns whether both numbers of a pair name objects: a < rows, b < columns, and a < b within one set.
bool has_position(const RowSearch& rows, const Pair& pair);
/// Returns a message that says why has_position() is false. Requires: it is.
std::string fault_of_position(const RowSearch& rows, const Pair& pair);

}  // namespace octopair
