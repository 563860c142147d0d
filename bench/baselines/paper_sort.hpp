// How the slaves of the paper's algorithm sort: by std::sort, as the paper does by qsort, or by octopair's radix sort.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "baselines/baselines.hpp"
#include "octopair/octal_code.hpp"

namespace octopair::baselines {

using PaperEntry = std::pair<OctalCode, std::uint32_t>;

/// Sorts entries that are ascending by object, with codes of `level` at most, into the pre-order of the octree, then by
/// object. Deeper than level 9 a code does not fit a key of 32 bits, and std::sort does it.
void sort_entries(std::vector<PaperEntry>& entries, PaperSort sort, unsigned level);

}  // namespace octopair::baselines
