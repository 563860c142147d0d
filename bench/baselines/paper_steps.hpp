// Steps of the paper's algorithm as published (section 3.3), which slaves on threads (paper.cpp) and on ranks
// (cluster/paper_master.hpp) share:
// - Slaves compute octal codes of their objects and sort them: paper_list().
// - Each machine merges the lists of its slaves. Then the master merges the lists of all machines: merge_paper_lists().
// - A scan with CommonPath finds candidate pairs. A last step removes duplicates and tests the pairs: scan_paper_list().
//
// Two errors of the pseudo code are corrected: the inner loop of step 7 starts after object1 and stops at the end of
// the list.
#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "baselines/baselines.hpp"
#include "octopair/octal_code.hpp"

namespace octopair::baselines {

/// An octant that an object meets.
struct PaperEntry {
    OctalCode code;
    std::uint32_t object = 0;

    auto operator<=>(const PaperEntry&) const = default;
};
/// Entries in the pre-order of the octree, then by object.
using PaperList = std::vector<PaperEntry>;

/// The octree of a call: the root octant, a cube that contains all objects, and the fixed depth.
struct PaperOctree {
    Box3d root;
    unsigned level;
};

/// Returns the octree of the objects; level 0 stands for about one octant per object.
PaperOctree paper_octree(std::span<const Box3f> boxes, unsigned level);

/// Objects of one slave.
struct PaperSlice {
    std::span<const Box3f> boxes;
    std::uint32_t first_index;  ///< index of boxes[0] among all objects
};

/// Returns the octal codes of the slice's objects, in the order of the objects.
PaperList paper_codes(const PaperSlice& slice, const PaperOctree& octree);

/// Sorts the entries of a slave into the pre-order of the octree, then by object: by std::sort, where the paper uses qsort, or by the radix
/// sort of octopair. Deeper than level 9 a code does not fit into a key of 32 bits, so std::sort is used.
/// Requires: entries ascend by object, and codes have at most `level`.
void sort_entries(PaperList& entries, PaperSort sort, unsigned level);

/// Merges sorted lists, two and two.
PaperList merge_paper_lists(std::vector<PaperList> lists);

/// Returns the pairs of a sorted list in ascending order. `candidates` becomes the number of pairs that share an octant, counted once
/// per shared octant.
std::vector<Pair> scan_paper_list(const PaperList& list, std::span<const Box3f> boxes, std::uint64_t& candidates);

}  // namespace octopair::baselines
