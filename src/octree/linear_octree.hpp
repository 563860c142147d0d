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
#include "boxes/box_source.hpp"
#include "octree/build/build_steps.hpp"
#include "octree/build/sorted_list.hpp"
#include "octree/directory.hpp"
#include "octree/executor.hpp"
#include "octree/sample.hpp"
#include "octree/space.hpp"

namespace octopair {

struct BuildSeconds {
    double encode = 0, count = 0, scatter = 0, merge = 0;
};

/// An octree's space and octants. Both are a function of a sample of the objects.
struct OctreeLayout {
    Space space;
    Directory directory;
};

/// Returns the positions of the objects that an octree of `objects` objects is planned from.
Sample octant_sample(std::uint64_t objects);
/// Returns the rule that divides octants by such a sample.
SplitRule split_rule(std::uint64_t objects, const std::stop_token& stop);
/// Space and shape of an octree, small enough to be sent to other processes.
struct OctreePlan {
    Space space;
    SplitFlags shape;

    OctreeLayout layout() const { return {space, Directory(space, shape)}; }
};
/// Plans an octree of `objects` objects. `sampled`: the entries at the positions octant_sample(objects).
/// Throws: Error{cancelled}.
OctreePlan plan_octree(std::span<const Entry> sampled, std::uint64_t objects, const std::stop_token& stop);
OctreePlan plan_octree(const EntrySource& source, const std::stop_token& stop);
/// Returns the layout of plan_octree().
OctreeLayout make_layout(const EntrySource& source, const std::stop_token& stop);

class LinearOctree {
public:
    LinearOctree() = default;
    /// Stores entries and the results of steps in `pages`, and data that is not read after the scatter step in `scratch`.
    /// Requires: both outlive the octree. If several processes build one octree together, all of them share these pages.
    LinearOctree(PageSource& pages, PageSource& scratch) : entries_(pages), memory_(pages, scratch) {}

    /// Replaces the contents and reuses the memory.
    /// Throws: Error{cancelled}; Invalid if an object is not a valid box.
    void build(const EntrySource& source, Executor& executor, std::stop_token stop);

    /// Position from which to search for the first invalid object.
    struct Invalid {
        std::size_t begin;
    };

    /// Builds in the given octants. Throws as build() above does.
    void build(OctreeLayout layout, const EntrySource& source, Executor& executor, std::stop_token stop);

    /// Builds in the existing octants: faster than build(), and as good while boxes have moved little. Throws as build() does.
    void refill(const EntrySource& source, Executor& executor, std::stop_token stop);

    /// Replaces the contents by the merged lists. Merges one octant after another, on the calling thread.
    /// Requires: the objects of each list precede those of the next.
    /// Throws: Error{cancelled}.
    void assemble(OctreeLayout layout, std::span<const SortedList> lists, const std::stop_token& stop);

    const Space& space() const { return layout_.space; }
    std::span<const Octant> octants() const { return layout_.directory.octants(); }
    const Directory& directory() const { return layout_.directory; }
    std::span<const Entry> entries(OctantIndex octant) const {
        return entries_.span().subspan(begins_[octant], begins_[octant + 1] - begins_[octant]);
    }
    /// Returns the number of entries of the octants [begin, end).
    std::uint64_t entry_count(OctantIndex begin, OctantIndex end) const { return begins_[end] - begins_[begin]; }
    std::uint64_t entry_count() const { return begins_.back(); }
    const BuildSeconds& seconds() const { return seconds_; }

private:
    using Clock = std::chrono::steady_clock::time_point;
    void fill(const EntrySource& source, Executor& executor, const std::stop_token& stop, Clock clock);
    void join_ranges(std::span<const NumberedOctants> ranges, std::vector<std::uint64_t>& range_begins);
    bool is_crowded() const;

    OctreeLayout layout_;
    std::vector<std::uint64_t> begins_ = {0, 0};  // position of each octant's first entry, and the number of entries
    Buffer<Entry> entries_;
    BuildMemory memory_{own_pages(), own_pages()};
    BuildSeconds seconds_;
};

}  // namespace octopair
