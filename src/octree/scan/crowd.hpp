// CrowdScan: finds the pairs of a crowd, which is a set of an octant's entries whose sweep on cells would cost too much.
//
// The first of these that is cheap enough finds the pairs
//   1. a sweep in float32 along one axis (sweep/sweep_choice.hpp),
//   2. parts of one shape, each pair of parts by such a sweep,
//   3. a nested octree of a part's entries, with a space of its own,
//   4. the recursive sweep, whose cost is bounded on every scene (sweep/recursive_sweep.hpp).
//
// Invariant
//   Each choice is a function of the entries alone. So the order of the pairs is the same for any number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "octree/build/linear_octree.hpp"
#include "octree/executor.hpp"
#include "octree/plan/octant_cells.hpp"
#include "octree/sweep/sweep_choice.hpp"

namespace octopair {

/// The entries that meet in an octant. Borrows all of them.
struct OctantEntries {
    OctantCells cells;  ///< map from coordinates to the cells of own entries
    std::span<const std::span<const CellEntry>> own;
    std::span<const Entry> handed;  ///< entries that are handed down to the octant

    std::size_t own_count() const {
        std::size_t count = 0;
        for (const auto run : own) count += run.size();
        return count;
    }
};

/// A part of the entries that meet in an octant.
struct OctantPart {
    static constexpr std::uint32_t any_set = 0;
    static constexpr std::size_t numbers = 4;

    bool handed = false;          ///< the entries handed down; otherwise the own entries
    std::uint32_t set = any_set;  ///< first_set or second_set of a join, or any_set

    bool has(std::uint32_t mask) const { return set == any_set || (mask & set) != 0; }
    std::size_t number() const { return (handed ? 2u : 0u) + (set == second_set ? 1u : 0u); }
    friend bool operator==(const OctantPart&, const OctantPart&) = default;
};

/// Keeps its memory from octant to octant.
/// Thread safety: one thread at a time.
class CrowdScan {
public:
    /// Borrows all arguments.
    CrowdScan(const LinearOctree& octree, const ScanContext& context, Executor& executor)
        : octree_(octree), context_(context), executor_(executor), chooser_(context.stop) {}

    /// Forgets the entries of the last octant. Must be called before the calls of scan() for another octant.
    void clear();

    /// Finds the pairs of a row and a column, or the pairs within a part if `rows` and `columns` are the same part.
    /// Throws: Error{cancelled}.
    void scan(const OctantEntries& octant, OctantPart rows, OctantPart columns);

private:
    /// The entries of a part: with their bounds, or ids alone.
    struct Crowd {
        std::vector<Entry> whole;
        std::vector<EntryId> ids;
    };

    EntryList list_of(const OctantEntries& octant, OctantPart part);
    void collect(const OctantEntries& octant, OctantPart part, Crowd& crowd) const;
    void scan(const SweepInput& join);
    void scan_part(const SweepInput& join, bool same_shape);
    bool try_sweep(const SweepInput& join);
    bool try_nested_scan(const SweepInput& join);
    bool thins(const LinearOctree& nested, std::size_t entries) const;

    const LinearOctree& octree_;
    const ScanContext& context_;
    Executor& executor_;
    SweepChooser chooser_;
    std::array<Crowd, OctantPart::numbers> crowd_of_part_;  // empty until they are needed
};

}  // namespace octopair
