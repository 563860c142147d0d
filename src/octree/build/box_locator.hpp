// BoxLocator: finds the leaves of a batch of boxes, and the boxes that reach beyond them.
//
// Functions whose names end in _scalar are the specification of the SIMD versions (box_locator_kernel.cpp).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "base/private_export.hpp"
#include "boxes/box_source.hpp"
#include "boxes/entry.hpp"
#include "octree/plan/directory.hpp"
#include "octree/plan/space.hpp"

namespace octopair {

inline constexpr std::size_t max_encoded = 256;  ///< maximum number of boxes in a batch

/// The crossers of a batch: boxes that reach beyond the leaf that they begin in. All arrays but the counter are by crosser.
struct CrosserBatch {
    static constexpr std::size_t room = max_encoded + 16;  ///< SIMD versions write a few numbers behind the last one

    std::size_t crossers = 0;
    /// Initialised, because SIMD versions read a few numbers behind the last one.
    std::array<std::uint32_t, room> crosser = {};  ///< position in the batch, ascending
    std::array<std::uint32_t, room> leaf = {};     ///< leaf that the box begins in, as Directory::Leaf::element()
    std::array<std::array<std::uint32_t, room>, 3> low = {}, high = {};  ///< ends in fine cells, by coordinate axis

    CellBox cells(std::size_t i) const {
        CellBox box;
        for (unsigned axis = 0; axis < 3; ++axis) {
            box.lo[axis] = low[axis][i] >> SpaceMap::fine_bits;
            box.hi[axis] = high[axis][i] >> SpaceMap::fine_bits;
        }
        return box;
    }
};

/// A batch of boxes with the leaves of their corners, as Directory::Leaf::element().
struct LocatedBatch : CrosserBatch {
    std::array<std::uint32_t, room> leaves;    ///< leaf that each box begins in
    std::array<std::uint32_t, room> end_leaf;  ///< by crosser: leaf that the high corner lies in
};

using BatchEntries = std::array<Entry, max_encoded>;
/// Converts boxes to entries with mask 0. Returns false if a box is invalid.
bool make_entries(const Float32Boxes& boxes, BatchEntries& entries);

class OCTOPAIR_PRIVATE_EXPORT BoxLocator {
public:
    /// Borrows both.
    BoxLocator(const Space& space, const Directory& directory);

    /// Finds the leaves of boxes. Returns false if a box is invalid; the leaves of an invalid box are unspecified.
    bool locate(std::span<const Box3f> boxes, LocatedBatch& batch) const;
    bool locate_scalar(std::span<const Box3f> boxes, LocatedBatch& batch) const;
    void locate(std::span<const Entry> entries, LocatedBatch& batch) const;
    void locate_scalar(std::span<const Entry> entries, LocatedBatch& batch) const;

    /// Specification of locate() for one box. Returns the leaf that the box begins in. Appends the box to `crossers` if it reaches beyond
    /// this leaf.
    Directory::Leaf locate(const Entry& entry, std::uint32_t position, CrosserBatch& crossers) const;

    SpaceMap map;
    Directory::LeafTable table;
    bool large_table;  ///< true if the table is larger than the L2 cache, so that its elements are prefetched

private:
    const Space& space_;
    const Directory& directory_;
};

}  // namespace octopair
