// LinearOctree: the entries of all objects, sorted by octal code, and the directory of each octant's range of entries.
//
// Invariants
//   The octants with an entry of a box tile the cells that the box touches. They are leaves or, if the box would need more
//   than eight smaller octants, octants of its natural level. An entry there stands for all octants below.
//   entries(octant) lists first the boxes that have their home there: the leaf that they begin in. Ghosts follow: boxes
//   that reach into the octant from elsewhere or are too large for a leaf. Both parts ascend by object.
//   Class bits are set as boxes/entry.hpp says.
//   The octree is a function of the source alone, until arrange() replaces its entries. Blocks of objects are only shares of the work.
//
// A build takes space and directory from a plan (octree/plan/octree_plan.hpp). Then it runs these steps with an executor, each over blocks
// of objects or ranges of octants:
//
//   encode   a batch of objects -> the octants of each object, and its entries (encoder.hpp)
//   scatter  a batch's entries -> the lists of their octants, one list for each octant and block (chunk_lists.hpp). Encode and
//            scatter alternate, batch by batch, in one pass over the objects. They are an MSD radix sort by octal code.
//   count    the lists of all blocks, for a range of octants -> the number of entries of each octant
//
// A step reads only what earlier steps wrote, and writes memory that no other block or range writes. So threads or processes can run the
// shares of a step concurrently, and can run a share again.
//
// Source: Lucchesi, Egbert, Harris 2014, sections 3.2 and 3.3.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "base/memory.hpp"
#include "base/private_export.hpp"
#include "boxes/box_source.hpp"
#include "octree/build/chunk_lists.hpp"
#include "octree/executor.hpp"
#include "octree/plan/directory.hpp"
#include "octree/plan/octree_plan.hpp"
#include "octree/plan/space.hpp"

namespace octopair {

/// Seconds of the steps. Encode and scatter alternate, so only a sample of the batches is timed. This sample gives the parts of both.
struct BuildSeconds {
    double encode = 0, scatter = 0, count = 0;
};

inline constexpr std::size_t max_entries_per_object = 8;

/// Data that steps pass to later steps.
struct OCTOPAIR_PRIVATE_EXPORT BuildMemory {
    explicit BuildMemory(PageSource& pages)
        : lists(pages), begins(pages), totals(pages), valid(pages), seconds(pages) {}

    /// Makes room for the given numbers of objects, blocks, octants and ranges of octants.
    void resize(std::size_t objects, std::size_t blocks, std::size_t octants, std::size_t octant_ranges);

    /// Two lists for each octant: list i has the home entries of octant i, and list `octants` + i has its ghosts. A home entry is the
    /// entry in the leaf that the box begins in. All other entries are ghosts.
    ChunkLists lists;
    Buffer<std::uint64_t> begins;  // by octant: number of entries in earlier octants of the same range
    Buffer<std::uint64_t> totals;  // by range of octants: number of entries
    Buffer<std::uint8_t> valid;    // by block: 1 if all its objects are valid boxes
    /// Time of the steps in a sample of the batches.
    struct Seconds {
        double encode = 0, scatter = 0;
    };
    Buffer<Seconds> seconds;  // by block

    std::size_t octants = 0;
    std::size_t home_list(std::size_t octant) const { return octant; }
    std::size_t ghost_list(std::size_t octant) const { return octants + octant; }
};

struct NumberedOctants {
    std::size_t number;
    OctantIndex begin, end;
};

/// The two lists of an octant.
enum class OctantList : std::uint8_t { home, ghosts };

/// Runs of adjacent entries, by octant: those of octant i are runs[begins[i]] to runs[begins[i + 1] - 1]. Borrows the entries.
struct EntryRuns {
    std::vector<std::span<const CellEntry>> runs;
    std::vector<std::size_t> begins;

    std::span<const std::span<const CellEntry>> of(OctantIndex octant) const {
        return std::span(runs).subspan(begins[octant], begins[octant + 1] - begins[octant]);
    }
};

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

    /// Replaces the entries of all octants by `runs`, until the next build. The runs may contain entries of for_each_run(). So entries
    /// that several octrees built of parts of the objects, with the same octants, become the octree of all objects.
    void arrange(EntryRuns runs);
    /// Returns the runs of an octant. Requires: arrange() after the last build.
    std::span<const std::span<const CellEntry>> arranged_runs(OctantIndex octant) const {
        return arranged_->of(octant);
    }

    const Space& space() const { return layout_.space; }
    std::span<const Octant> octants() const { return layout_.directory.octants(); }
    const Directory& directory() const { return layout_.directory; }
    /// Calls visit(entries) for each run of adjacent entries of an octant, in order.
    template <typename Visit>
    void for_each_run(OctantIndex octant, Visit&& visit) const {
        if (arranged_) {
            for (const auto run : arranged_->of(octant)) visit(run);
            return;
        }
        for_each_run(octant, OctantList::home, visit);
        for_each_run(octant, OctantList::ghosts, visit);
    }
    /// As above, for one list of the octant, as it was built.
    template <typename Visit>
    void for_each_run(OctantIndex octant, OctantList list, Visit&& visit) const {
        const bool home = list == OctantList::home;
        memory_.lists.for_each_run(home ? memory_.home_list(octant) : memory_.ghost_list(octant), visit);
    }
    /// Returns a copy of the entries of an octant, in order.
    std::vector<CellEntry> entries(OctantIndex octant) const;
    std::uint64_t entry_count(OctantIndex octant) const { return begins_[octant + 1] - begins_[octant]; }
    /// Returns the number of entries of the octants [begin, end).
    std::uint64_t entry_count(OctantIndex begin, OctantIndex end) const { return begins_[end] - begins_[begin]; }
    std::uint64_t entry_count() const { return begins_.back(); }
    const BuildSeconds& seconds() const { return seconds_; }

private:
    using TimePoint = std::chrono::steady_clock::time_point;
    void fill(const EntrySource& source, Executor& executor, const std::stop_token& stop, TimePoint step_begin);
    double scatter_part(std::size_t blocks) const;
    void join_ranges(std::span<const NumberedOctants> ranges);

    OctreeLayout layout_;
    std::vector<std::uint64_t> begins_ = {0, 0};  // position of each octant's first entry, and the number of entries
    BuildMemory memory_{own_pages()};
    std::optional<EntryRuns> arranged_;
    BuildSeconds seconds_;
};

}  // namespace octopair
