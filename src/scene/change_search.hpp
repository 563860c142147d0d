// ChangeSearch: finds the pairs that begin and end because a few objects of a scene changed.
//
// Invariants
//   The result is that of applying the changes to the octree one after the other, in the order of the log.
//   Each change searches the octree around the old and the new box of its object. At that time, the octree has the new boxes of
//   objects of earlier changes, and the old boxes of objects of later changes.
//   A pair of two changed objects that ended is found by the earlier change of the two.
//   A pair of two changed objects that began is found by the later change of the two.
//   The octree yields candidates. The old and new boxes and traits of the two objects decide.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

#include "base/radix_sort.hpp"
#include "boxes/outward_rounding.hpp"
#include "octree/dynamic/mutable_octree.hpp"
#include "parallel/team.hpp"
#include "scene/change_log.hpp"
#include "scene/pair_history.hpp"

namespace octopair {

/// Rule by which the boxes of a scene are rounded to the float32 entries of its octree.
struct EntryRounding {
    bool exact = true;         ///< true: entries have the bounds of the boxes, without rounding
    OutwardRounding rounding;  ///< used if not `exact`

    Entry entry(const Box3d& box, double padding) const;
};

class ChangeSearch {
public:
    /// The parts of a scene that a search reads.
    struct View {
        const ObjectTable& table;
        const ChangeLog& log;
        const EntryRounding& rounding;
        double margin;
    };

    /// Limits beyond which a full detection is expected to be cheaper.
    struct Limits {
        std::chrono::steady_clock::time_point deadline;
        std::uint64_t visits;  ///< maximum number of visits of octree units
        std::uint64_t pairs;   ///< maximum number of pairs that begin or end
        const std::stop_token& stop;
    };
    /// Thrown when a limit is reached.
    struct LimitReached {};

    explicit ChangeSearch(Team& team) : team_(team), workers_(team.threads()) {}

    /// Brings `octree` up to date, and stores in `changes` the pairs that began and ended.
    /// Throws: Error{cancelled}; LimitReached if a limit is reached. The octree must be built anew after any exception.
    void run(const View& scene, MutableOctree& octree, PairChanges& changes, const Limits& limits);

private:
    /// Buffers of one thread.
    struct Worker {
        std::vector<Hit> hits;
        std::vector<std::uint64_t> began, ended;
    };
    /// The changed object whose hits are tested.
    struct Judged {
        std::uint32_t change = ~std::uint32_t(0);
        std::uint32_t object = 0;
        ObjectState before{}, after{};
    };

    void read_changes(const View& scene, const MutableOctree& octree);
    void list_visits(MutableOctree& octree, const Limits& limits);
    void apply_large_change(const View& scene, MutableOctree& octree, std::uint32_t number);
    void apply_listed_changes(const View& scene, MutableOctree& octree, const Limits& limits);
    void judge(const View& scene, Worker& worker) const;
    void judge(const View& scene, const Hit& hit, const Judged& judged, Worker& worker) const;
    /// Throws: Error{cancelled}; LimitReached if a limit is reached. Called between runs of visits, which find few pairs each.
    void throw_if_beyond(const Limits& limits, const Worker& worker) const;
    void collect(std::vector<std::uint64_t> Worker::*keys, std::vector<Pair>& pairs);

    Team& team_;
    std::vector<Worker> workers_;
    std::vector<OctreeChange> changes_;   // in the order of the log
    std::vector<std::uint8_t> is_large_;  // by change; 1: visits too many units, so it is applied first
    std::vector<MutableOctree::Visits> listed_;
    std::vector<Entry> entries_;
    std::vector<CellBox> cells_;
    std::vector<std::uint32_t> found_;
    RadixSort<std::uint64_t> sort_;
};

}  // namespace octopair
