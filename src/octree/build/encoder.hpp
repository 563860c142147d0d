// encode: finds the octants of each box, and makes the entries that these octants get.
//
//   for_each_octant_of()   the rule for one box, and the specification of ghosts
//   BoxLocator             the leaves of a batch of boxes, and the boxes that reach beyond them
//   BatchEncoder           the entries of a batch of boxes
//
// Functions whose names end in _scalar are the specification (encoder_scalar.cpp) of the SIMD versions (encoder_kernel.cpp).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/private_export.hpp"
#include "boxes/entry.hpp"
#include "boxes/entry_source.hpp"
#include "octree/plan/directory.hpp"
#include "octree/plan/octant_cells.hpp"
#include "octree/plan/space.hpp"

namespace octopair {

/// True if `box` lies within the octant of `level` that holds its low corner.
inline bool within(const CellBox& box, unsigned level) {
    return ((box.lo[0] ^ box.hi[0]) | (box.lo[1] ^ box.hi[1]) | (box.lo[2] ^ box.hi[2])) >> (deepest - level) == 0;
}

/// Returns a bit mask of the axes on which `box` touches more than one octant of `level`.
inline unsigned crossed_axes(const CellBox& box, unsigned level) {
    const unsigned shift = deepest - level;
    unsigned crossed = 0;
    for (unsigned axis = 0; axis < 3; ++axis) {
        crossed |= unsigned(box.lo[axis] >> shift != box.hi[axis] >> shift) << axis;
    }
    return crossed;
}

inline Cell corner_of(const CellBox& box, unsigned corner) {
    Cell cell = box.lo;
    for (unsigned axis = 0; axis < 3; ++axis) {
        if (corner >> axis & 1u) cell[axis] = box.hi[axis];
    }
    return cell;
}

/// Calls place(octant, class bits) for each octant that gets an entry of `box`, first for the octant that the box begins in.
/// `home`: the leaf that the box begins in. At the natural level of a box and above, each octant that the box touches holds a
/// corner of the box. A coarser leaf may hold several corners. Then place() is called for the lowest of these corners only.
/// Requires: `box` reaches beyond `home`.
template <typename Place>
void for_each_octant_of(const CellBox& box, const Directory& directory, Directory::Leaf home, Place&& place) {
    const unsigned natural = natural_level(box);
    std::array<std::pair<unsigned, OctantIndex>, 8> corners;
    std::size_t count = 0;
    // Starts with the corners at the level of the home leaf. If a finer leaf is found, starts again at that leaf's level.
    unsigned level = std::min(natural, home.level());
    for (bool again = true; again;) {
        const unsigned crossed = crossed_axes(box, level);
        unsigned finest = level;
        unsigned corner = 0;
        count = 0;
        do {
            const Directory::Leaf leaf = corner == 0 ? home : directory.leaf(corner_of(box, corner));
            finest = std::max(finest, std::min(natural, leaf.level()));
            corners[count++] = {corner, directory.at_most(leaf, natural)};
            corner = (corner - crossed) & crossed;  // the next subset of `crossed`
        } while (corner != 0);
        again = finest != level;
        level = finest;
    }
    for (const auto& [corner, octant] : std::span(corners).first(count)) {
        const unsigned begins = class_bits(box, directory.octants()[octant]);
        if ((corner & ~begins) == 0) place(octant, begins);
    }
}

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

/// A batch of boxes with their home entries.
struct EncodedBatch : CrosserBatch {
    alignas(64) std::array<CellEntry, room> homes;
    std::array<std::uint32_t, room>
        lists;  ///< home octant of each box; BatchEncoder::no_list if the box is too large for a leaf
};

/// The crossers [begin, begin + count) of a batch. Crossers are boxes that reach beyond the leaf that they begin in.
struct CrosserRange {
    std::size_t begin, count;
};

/// The ghosts of a few crossers.
struct GhostGroup {
    static constexpr std::size_t most = 16, slots = 8;
    // Arrays by crosser and slot: those of crosser k begin at slots * k. A crosser has at most 7 ghosts, in the order of the box's corners.
    alignas(64) std::array<CellEntry, most * slots> entries;
    std::array<std::uint32_t, most * slots> octants;
    alignas(64)
        std::array<std::uint32_t, most> counts;  ///< number of ghosts of each crosser; unspecified for those left out
    /// Bit mask of the crossers whose ghosts the caller must find by the general rule (for_each_octant_of()). A leaf is deep or finer
    /// than the home leaf, or the box is too large for its home leaf.
    std::uint32_t left_out;
};

class BatchEncoder {
public:
    /// Borrows `space` and `directory`. `no_list`: the list number of boxes that are too large for a leaf.
    BatchEncoder(const Space& space, const Directory& directory, std::uint32_t no_list);

    /// Encodes boxes. Returns false if a box is invalid; the entry of an invalid box is unspecified.
    bool encode(const Float32Boxes& boxes, EncodedBatch& batch) const;
    bool encode_scalar(const Float32Boxes& boxes, EncodedBatch& batch) const;
    /// Encodes entries. The entries of the batch have their objects and masks.
    void encode(std::span<const Entry> entries, EncodedBatch& batch) const;
    void encode_scalar(std::span<const Entry> entries, EncodedBatch& batch) const;

    /// Makes the ghosts of at most GhostGroup::most crossers.
    void ghosts(const EncodedBatch& batch, CrosserRange crossers, GhostGroup& group) const;
    /// Leaves all crossers to the general rule (for_each_octant_of()), which is the specification.
    static void ghosts_scalar(CrosserRange crossers, GhostGroup& group);

    BoxLocator locator;
    std::array<unsigned, 3> axes;  ///< coordinate axis of each axis of the sweep
    std::uint32_t no_list;
    /// By octant: OctantCells::deep_origin() of octants deeper than OctantCells::max_fine_level. Empty if there are none.
    std::vector<std::array<float, 4>> deep_origins;

private:
    const Space& space_;
    const Directory& directory_;
};

}  // namespace octopair
