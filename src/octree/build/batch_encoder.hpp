// Encoding of many boxes at once: octants and entries of a batch of boxes.
//
// Functions whose names end in _scalar are the specification of the SIMD versions (batch_encoder_kernel.cpp).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "octree/build/box_locator.hpp"
#include "octree/plan/directory.hpp"
#include "octree/plan/octant_cells.hpp"
#include "octree/plan/space.hpp"

namespace octopair {

/// A batch of boxes with their home entries.
struct EncodedBatch : CrosserBatch {
    alignas(64) std::array<CellEntry, room> homes;
    std::array<std::uint32_t, room>
        lists;  ///< home octant of each box; BatchEncoder::no_list if the box is too large for a leaf
};

/// The crossers [begin, begin + count) of a batch. Crossers are boxes that reach beyond the leaf that they begin in (box_locator.hpp).
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
    /// Bit mask of the crossers whose ghosts the caller must find by the general rule (octants_of.hpp). A leaf is deep or finer than the
    /// home leaf, or the box is too large for its home leaf.
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
    /// Leaves all crossers to the general rule (octants_of.hpp), which is the specification.
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
