// Sort of the slaves in the paper's algorithm: std::sort, where the paper uses qsort, or octopair's radix sort.
#pragma once

#include "baselines/baselines.hpp"
#include "baselines/paper_steps.hpp"

namespace octopair::baselines {

/// Sorts entries into the pre-order of the octree, then by object. Requires: entries ascend by object, and codes have
/// at most `level`. Deeper than level 9 a code does not fit into a key of 32 bits, so std::sort is used.
void sort_entries(PaperList& entries, PaperSort sort, unsigned level);

}  // namespace octopair::baselines
