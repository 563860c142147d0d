// in_second_set(): places the errors of a check in the second set of a filter.
#pragma once

#include <utility>

#include "octopair/error.hpp"

namespace octopair {

/// Calls `check`, which checks the objects of a second set. An error about one of them gets the set 1 (Error::place()).
/// Throws: what `check` throws.
template <typename Check>
void in_second_set(Check&& check) {
    try {
        std::forward<Check>(check)();
    } catch (const Error& error) {
        auto place = error.place();
        if (!place) throw;
        place->set = 1;
        throw PlacedError(error.code(), error.what(), *place);
    }
}

}  // namespace octopair
