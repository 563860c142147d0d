// LinearOctree: the entries of all objects, sorted by octal code, with the directory of where each octant's begin.
//
// Invariants
//   Every octant that a box touches has an entry of it, in a leaf or, where the box is too large for at most eight
//   smaller octants, in the octant above (its natural level): what is stored there occupies all below.
//   entries(node) lists first the boxes whose home it is, the leaf that they begin in, then the ghosts of those that reach
//   into it or are too large for a leaf, each ascending by object; class bits are set as entry.hpp says.
//   All of it is a function of the source alone; blocks of objects are only the shares of work.
//
// A sample gives frame and directory; then the steps of build_steps.hpp, shared out by an executor.
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
#include "octree/frame.hpp"
#include "octree/sample.hpp"

namespace octopair {

struct BuildSeconds {
    double encode = 0, sort = 0, merge = 0;
};

/// The octree's space and its octants: a function of a sample of the objects.
struct PlantedOctants {
    Frame frame;
    Directory directory;
};

/// The positions of the sample, of so many objects.
Sample octant_sample(std::uint64_t objects);
/// What decides on their octants.
OctantGrowth octant_growth(std::uint64_t objects, const std::stop_token& stop);
/// What octants grow from, small enough to be told to others.
struct OctantPlan {
    Frame frame;
    OctantShape shape;

    PlantedOctants planted() const { return {frame, Directory(frame, shape)}; }
};
/// From the sampled entries. Throws Error{cancelled}.
OctantPlan plan_octants(std::span<const Entry> sampled, std::uint64_t objects, const std::stop_token& stop);
OctantPlan plan_octants(const EntrySource& source, const std::stop_token& stop);
/// The same, planted.
PlantedOctants plant_octants(const EntrySource& source, const std::stop_token& stop);

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
    void build(PlantedOctants octants, const EntrySource& source, Executor& executor, std::stop_token stop);

    /// The same, in the octants that there are: sooner done, and as good while boxes are much where they were.
    void refill(const EntrySource& source, Executor& executor, std::stop_token stop);

    /// Of lists whose objects follow each other: merges them, one octant after another, on the calling thread.
    void assemble(PlantedOctants octants, std::span<const SortedList> lists, const std::stop_token& stop);

    const Frame& frame() const { return octants_.frame; }
    std::span<const Node> nodes() const { return octants_.directory.nodes(); }
    const Directory& directory() const { return octants_.directory; }
    std::span<const Entry> entries(NodeIndex node) const {
        return entries_.span().subspan(begins_[node], begins_[node + 1] - begins_[node]);
    }
    /// Entries of the nodes [begin, end).
    std::uint64_t entry_count(NodeIndex begin, NodeIndex end) const { return begins_[end] - begins_[begin]; }
    std::uint64_t entry_count() const { return begins_.back(); }
    const BuildSeconds& seconds() const { return seconds_; }

private:
    using Clock = std::chrono::steady_clock::time_point;
    void fill(const EntrySource& source, Executor& executor, const std::stop_token& stop, Clock clock);
    void join_ranges(std::span<const NumberedNodes> ranges, std::vector<std::uint64_t>& range_begins);
    bool crowded() const;

    PlantedOctants octants_;
    std::vector<std::uint64_t> begins_ = {0, 0};  // of each node's entries, and the end
    Buffer<Entry> entries_;
    BuildMemory memory_{own_pages(), own_pages()};
    BuildSeconds seconds_;
};

}  // namespace octopair
