// HandedDown: the entries that inner octants keep and hand down to the octants below them.
//
// Invariants
//   An octant keeps an entry if the box is too large for smaller octants. The entry is handed down to each octant below that it touches.
//   Class bits are added, never cleared (boxes/entry.hpp).
#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "boxes/entry_source.hpp"
#include "octree/build/linear_octree.hpp"

namespace octopair {

/// The own entries of inner octants, with their bounds as coordinates. Each octant's are made once, when they are first used.
/// Thread safety: any thread may call it.
class KeptEntries {
public:
    KeptEntries(const LinearOctree& octree, const EntrySource& source);

    std::span<const Entry> of(OctantIndex inner);

private:
    struct Kept {
        std::once_flag made;
        std::vector<Entry> entries;
    };
    const LinearOctree& octree_;
    const EntrySource& source_;
    std::vector<Kept> kept_;
};

/// The entries handed down to the octants of one path, by level, each with its class bits in that octant.
/// Thread safety: one thread at a time.
class HandedDown {
public:
    /// `moved`: number of cells by which boxes are shifted, for Fault::nested_space_moved; otherwise 0.
    HandedDown(const LinearOctree& octree, KeptEntries& kept, std::uint32_t moved)
        : octree_(octree), kept_(kept), moved_(moved) {}

    /// Returns the entries that octants above keep and that touch `octant`. They are valid until the next call.
    /// Requires: calls come in pre-order of octants; any octant may be the first.
    std::span<const Entry> at(OctantIndex octant);

private:
    static constexpr OctantIndex none = ~OctantIndex(0);

    void hand_down(std::span<const Entry> from, OctantIndex to);
    void hand_down(const Entry& entry, const CellBox& box, OctantIndex to);
    void move(CellBox& box) const;

    const LinearOctree& octree_;
    KeptEntries& kept_;
    std::uint32_t moved_;
    std::vector<std::vector<Entry>> lists_;
    std::vector<OctantIndex> owners_;
};

}  // namespace octopair
