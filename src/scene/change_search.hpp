// ChangeSearch: the pairs that begin and end where a few objects of a scene changed.
//
// The changes are made one after the other, or so that it looks like that: around where an object was, and where it is,
// the octree is searched, while those of lower number have changed already and those of higher number have not. So
//   a pair that ended    is found by the change of the lower number of the two that are in it,
//   a pair that began    by that of the higher number.
// What is found is judged on the boxes and traits themselves, as they were and as they are.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

#include "base/radix_sort.hpp"
#include "boxes/box_kernel.hpp"
#include "octree/dynamic/mutable_octree.hpp"
#include "parallel/team.hpp"
#include "scene/change_log.hpp"
#include "scene/pair_history.hpp"

namespace octopair {

/// How the boxes of a scene became those of its octree.
struct EntryRounding {
    bool exact = true;  ///< as they are
    OutwardRounding rounding;

    Entry entry(const Box3d& box, double padding) const;
};

class ChangeSearch {
public:
    struct Scene {
        const ObjectTable& table;
        const ChangeLog& log;
        const EntryRounding& rounding;
        double margin;
    };

    /// When to give up.
    struct Limits {
        std::chrono::steady_clock::time_point deadline;
        std::uint64_t visits;  ///< most, of units of the octree
        std::uint64_t pairs;   ///< most that begin and end
        const std::stop_token& stop;
    };
    /// Thrown where a limit is met: another way is cheaper.
    struct TooDear {};

    explicit ChangeSearch(Team& team) : team_(team), workers_(team.threads()) {}

    /// Brings the octree up to date, and tells what changed. Throws Error{cancelled} and TooDear; whatever it throws leaves
    /// the octree in no state to be used.
    void run(const Scene& scene, MutableOctree& octree, PairChanges& changes, const Limits& limits);

private:
    /// A worker's own.
    struct Worker {
        std::vector<Hit> hits;
        std::vector<std::uint64_t> began, ended;
    };
    /// The object of a change whose hits are looked at.
    struct Judged {
        std::uint32_t change = ~std::uint32_t(0);
        std::uint32_t object = 0;
        ObjectState before{}, after{};
    };

    void read_changes(const Scene& scene, const MutableOctree& octree);
    void list_visits(MutableOctree& octree, const Limits& limits);
    void make_alone(const Scene& scene, MutableOctree& octree, std::uint32_t number);
    void make_visits(const Scene& scene, MutableOctree& octree, const Limits& limits);
    void judge(const Scene& scene, Worker& worker) const;
    void judge(const Scene& scene, const Hit& hit, const Judged& judged, Worker& worker) const;
    /// Between runs of visits: what one finds is not much.
    void throw_if_beyond(const Limits& limits, const Worker& worker) const;
    void collect(std::vector<std::uint64_t> Worker::*keys, std::vector<Pair>& pairs);

    Team& team_;
    std::vector<Worker> workers_;
    std::vector<OctreeChange> changes_;  // in the order of the log
    std::vector<std::uint8_t> alone_;    // of changes too large to be listed: made before all others
    std::vector<MutableOctree::Visits> listed_;
    std::vector<Entry> entries_;
    std::vector<CellBox> cells_;
    std::vector<std::uint32_t> found_;
    RadixSort<std::uint64_t> sort_;
};

}  // namespace octopair
