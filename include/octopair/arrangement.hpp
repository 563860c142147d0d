// Arrangement: how the processes or ranks of an engine share a call.
#pragma once

#include <cstdint>

namespace octopair {

/// The result is the same.
enum class Arrangement : std::uint8_t {
    shared,  ///< every step
    paper,   ///< they build sorted lists, which one merges and scans alone, as in the paper: there to be compared with
};

}  // namespace octopair
