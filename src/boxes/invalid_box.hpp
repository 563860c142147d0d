// The error for an object that is not a valid box: which object, and which of its numbers is wrong. The rule is in box_check.hpp.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/private_export.hpp"
#include "octopair/objects.hpp"

namespace octopair {

/// Index of the first object of each set, if this process has only a part of the sets. Error messages add this index to their own.
struct SetBegins {
    std::uint64_t first = 0, second = 0;
};

/// Throws: Error{bad_input} for an object that was a valid box when it was read before.
[[noreturn]] OCTOPAIR_PRIVATE_EXPORT void throw_object_changed();

/// Throws: Error{bad_input} with the first object from position `begin` on that is not a valid box, and the wrong value. The objects of
/// `second`, which may be null, follow those of `first`.
[[noreturn]] void throw_invalid_box(const Objects& first, const Objects* second, std::size_t begin,
                                    const SetBegins& begins);

}  // namespace octopair
