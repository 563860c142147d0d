// Arrangement: how worker processes or MPI ranks divide the work of a call. The result does not depend on it.
#pragma once

#include <cstdint>

namespace [[gnu::visibility("default")]] octopair {

enum class Arrangement : std::uint8_t {
    shared,  ///< workers or ranks share the work of every step
    paper,   ///< for comparison: one process merges and scans the sorted lists of all others, as in the paper
};

}  // namespace octopair
