// LinearOctree: the entries of all objects, sorted by octal code, and the directory of each octant's range of entries.
//
// Invariants
//   The octants with an entry of a box tile the cells that the box touches. They are leaves or, if the box would need more
//   than eight smaller octants, octants of its natural level. An entry there stands for all octants below.
//   entries(octant) lists first the boxes that have their home there: the leaf that they begin in. Ghosts follow: boxes
//   that reach into the octant from elsewhere or are too large for a leaf. Both parts ascend by object.
//   Class bits are set as boxes/entry.hpp says.
//   The octree is a function of the source alone. Blocks of objects are only shares of the work.
//
// A build takes space and directory from a sample, and then runs the steps of build_steps.hpp with an executor.
//
// Source: Lucchesi, Egbert, Harris 2014, sections 3.2 and 3.3.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "base/memory.hpp"
#include "base/private_export.hpp"
#include "boxes/box_source.hpp"
#include "octree/build/build_steps.hpp"
#include "octree/executor.hpp"
#include "octree/plan/directory.hpp"
#include "octree/plan/sample.hpp"
#include "octree/plan/space.hpp"

namespace octopair {

/// Seconds of the steps. Encode and scatter alternate, so only a sample of the batches is timed. This sample gives the parts of both.
struct BuildSeconds {
    double encode = 0, scatter = 0, count = 0;
};

/// An octree's space and octants. Both are a function of a sample of the objects.
struct OctreeLayout {
    Space space;
    Directory directory;
};

/// Returns the positions of the sampled objects, from which the octants of an octree of `objects` objects are chosen.
OCTOPAIR_PRIVATE_EXPORT Sample octant_sample(std::uint64_t objects);
/// Returns the rule that decides, from the objects of octant_sample(), which octants are divided.
OCTOPAIR_PRIVATE_EXPORT SplitRule split_rule(std::uint64_t objects, const std::stop_token& stop);
/// Space and shape of an octree, small enough to be sent to other processes.
struct OctreePlan {
    Space space;
    SplitFlags shape;

    OctreeLayout layout() const { return {space, Directory(space, shape)}; }
};
/// Plans an octree of `objects` objects. `sampled`: the entries at the positions octant_sample(objects).
/// Throws: Error{cancelled}.
OCTOPAIR_PRIVATE_EXPORT OctreePlan plan_octree(std::span<const Entry> sampled, std::uint64_t objects,
                                               const std::stop_token& stop);
OCTOPAIR_PRIVATE_EXPORT OctreePlan plan_octree(const EntrySource& source, const std::stop_token& stop);
/// Samples `source`, calls plan_octree(), and returns the layout of this plan.
OCTOPAIR_PRIVATE_EXPORT OctreeLayout make_layout(const EntrySource& source, const std::stop_token& stop);

class OCTOPAIR_PRIVATE_EXPORT LinearOctree {
public:
    LinearOctree() = default;
    /// Stores entries in `pages`. Requires: `pages` outlives the octree. If several processes build one octree together, all of
    /// them share these pages.
    explicit LinearOctree(PageSource& pages) : memory_(pages) {}

    /// Replaces the contents and reuses the memory.
    /// Throws: Error{cancelled}; Invalid if an object is not a valid box.
    void build(const EntrySource& source, Executor& executor, std::stop_token stop);

    /// Exception for an invalid object. No object before the position in it is invalid.
    struct Invalid {
        std::size_t begin;
    };

    /// Builds with the octants of `layout`, without a sample. Throws as build() above does.
    void build(OctreeLayout layout, const EntrySource& source, Executor& executor, std::stop_token stop);

    /// Builds with the octants of the last build. Takes less time than build(). Scans stay as fast as long as boxes have moved little.
    /// Throws as build() does.
    void refill(const EntrySource& source, Executor& executor, std::stop_token stop);

    const Space& space() const { return layout_.space; }
    std::span<const Octant> octants() const { return layout_.directory.octants(); }
    const Directory& directory() const { return layout_.directory; }
    /// Calls visit(entries) for each run of adjacent entries of an octant, in order.
    template <typename Visit>
    void for_each_run(OctantIndex octant, Visit&& visit) const {
        memory_.lists.for_each_run(memory_.home_list(octant), visit);
        memory_.lists.for_each_run(memory_.ghost_list(octant), visit);
    }
    /// Returns a copy of the entries of an octant, in order.
    std::vector<CellEntry> entries(OctantIndex octant) const;
    std::uint64_t entry_count(OctantIndex octant) const { return begins_[octant + 1] - begins_[octant]; }
    /// Returns the number of entries of the octants [begin, end).
    std::uint64_t entry_count(OctantIndex begin, OctantIndex end) const { return begins_[end] - begins_[begin]; }
    std::uint64_t entry_count() const { return begins_.back(); }
    const BuildSeconds& seconds() const { return seconds_; }

private:
    using Clock = std::chrono::steady_clock::time_point;
    void fill(const EntrySource& source, Executor& executor, const std::stop_token& stop, Clock clock);
    double scatter_part(std::size_t blocks) const;
    void join_ranges(std::span<const NumberedOctants> ranges);

    OctreeLayout layout_;
    std::vector<std::uint64_t> begins_ = {0, 0};  // position of each octant's first entry, and the number of entries
    BuildMemory memory_{own_pages()};
    BuildSeconds seconds_;
};

}  // namespace octopair
