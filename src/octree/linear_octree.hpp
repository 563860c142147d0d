// LinearOctree: the entries of all objects, sorted by octal code, with the directory of where each octant's begin.
//
// Invariants
//   Every octant that a box touches has an entry of it, in a leaf or, where the box is too large for at most eight
//   smaller octants, in the octant above (its natural level): what is stored there occupies all below.
//   entries(octant) lists first the boxes whose home it is, the leaf that they begin in, then the ghosts of those that reach
//   into it or are too large for a leaf, each ascending by object; class bits are set as entry.hpp says.
//   All of it is a function of the source alone; blocks of objects are only the shares of work.
//
// A sample gives space and directory; then the steps of build_steps.hpp, shared out by an executor.
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
#include "octree/space.hpp"
#include "octree/sample.hpp"

namespace octopair {

struct BuildSeconds {
    double encode = 0, count = 0, scatter = 0, merge = 0;
};

/// The octree's space and its octants: a function of a sample of the objects.
struct OctreeLayout {
    Space space;
    Directory directory;
};

/// The positions of the sample, of so many objects.
Sample octant_sample(std::uint64_t objects);
/// What decides on their octants.
SplitRule split_rule(std::uint64_t objects, const std::stop_token& stop);
/// What octants grow from, small enough to be told to others.
struct OctreePlan {
    Space space;
    SplitFlags shape;

    OctreeLayout layout() const { return {space, Directory(space, shape)}; }
};
/// From the sampled entries. Throws Error{cancelled}.
OctreePlan plan_octree(std::span<const Entry> sampled, std::uint64_t objects, const std::stop_token& stop);
OctreePlan plan_octree(const EntrySource& source, const std::stop_token& stop);
/// The same, planted.
OctreeLayout make_layout(const EntrySource& source, const std::stop_token& stop);

class LinearOctree {
public:
    LinearOctree() = default;
    /// Its entries, and what the steps leave for each other, are in pages of `pages`; what nobody reads after the sort in
    /// those of `scratch`. Both must outlive it. Where each of several processes builds it with an executor that shares
    /// work out among them, these are the pages of all.
    LinearOctree(PageSource& pages, PageSource& scratch) : entries_(pages), memory_(pages, scratch) {}

    /// Replaces what it held, in the same memory. Throws Error{cancelled}; where an object is not a box, throws Invalid
    /// with the first position to look at.
    void build(const EntrySource& source, Executor& executor, std::stop_token stop);

    struct Invalid {
        std::size_t begin;
    };

    /// The same, in octants that are given.
    void build(OctreeLayout layout, const EntrySource& source, Executor& executor, std::stop_token stop);

    /// The same, in the octants that there are: sooner done, and as good while boxes are much where they were.
    void refill(const EntrySource& source, Executor& executor, std::stop_token stop);

    /// Of lists whose objects follow each other: merges them, one octant after another, on the calling thread.
    void assemble(OctreeLayout layout, std::span<const SortedList> lists, const std::stop_token& stop);

    const Space& space() const { return layout_.space; }
    std::span<const Octant> octants() const { return layout_.directory.octants(); }
    const Directory& directory() const { return layout_.directory; }
    std::span<const Entry> entries(OctantIndex octant) const {
        return entries_.span().subspan(begins_[octant], begins_[octant + 1] - begins_[octant]);
    }
    /// Entries of the octants [begin, end).
    std::uint64_t entry_count(OctantIndex begin, OctantIndex end) const { return begins_[end] - begins_[begin]; }
    std::uint64_t entry_count() const { return begins_.back(); }
    const BuildSeconds& seconds() const { return seconds_; }

private:
    using Clock = std::chrono::steady_clock::time_point;
    void fill(const EntrySource& source, Executor& executor, const std::stop_token& stop, Clock clock);
    void join_ranges(std::span<const NumberedOctants> ranges, std::vector<std::uint64_t>& range_begins);
    bool crowded() const;

    OctreeLayout layout_;
    std::vector<std::uint64_t> begins_ = {0, 0};  // of each octant's entries, and the end
    Buffer<Entry> entries_;
    BuildMemory memory_{own_pages(), own_pages()};
    BuildSeconds seconds_;
};

}  // namespace octopair
