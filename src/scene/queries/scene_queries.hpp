// SceneQueries: answers many queries (queries.hpp) at once with a scene's octree.
// Start here to add a new query of Scene.
//
// Invariants
//   The octree yields candidates. The boxes in the object table decide.
//   Objects that changed after the octree was brought up to date are ignored in it. Each query tests them one by one.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "base/radix_sort.hpp"
#include "boxes/outward_rounding.hpp"
#include "octopair/queries.hpp"
#include "octree/dynamic/mutable_octree.hpp"
#include "parallel/team.hpp"
#include "scene/change_log.hpp"
#include "scene/object_table.hpp"

namespace octopair {

class SceneQueries {
public:
    /// The parts of a scene that queries read.
    struct View {
        const ObjectTable& table;
        const MutableOctree& octree;
        const OutwardRounding& rounding;  ///< rounding of the octree's entries
        const ChangeLog* log;             ///< changes since the octree was brought up to date; null: none
        std::uint32_t groups;             ///< bit mask: an object is an answer only if it is in one of these groups
        const std::stop_token& stop;      ///< ends the queries with Error{cancelled}
    };

    explicit SceneQueries(Team& team) : team_(team), workers_(team.threads()) {}

    void overlaps(const View& scene, std::span<const Box3d> boxes, Answers<std::uint32_t>& answers);
    void overlaps(const View& scene, std::span<const Sphere> spheres, Answers<std::uint32_t>& answers);
    void first_hits(const View& scene, std::span<const Ray> rays, Answers<RayHit>& answers);
    void all_hits(const View& scene, std::span<const Ray> rays, Answers<RayHit>& answers);
    void nearest(const View& scene, std::span<const Box3d> places, const NearestLimits& limits,
                 Answers<Neighbor>& answers);

private:
    /// Buffers of one thread.
    struct Worker {
        std::vector<std::uint32_t> found;
        std::vector<std::uint32_t> indices;
        std::vector<RayHit> hits;
        std::vector<Neighbor> neighbors;
    };
    /// Location of the answers to one query: a range in a thread's buffer.
    struct Part {
        unsigned worker;
        std::size_t begin, end;
    };

    /// Order in which queries are answered.
    struct Order {
        std::size_t queries;
        std::span<const std::uint64_t> sorted;  ///< number of a query in the low 32 bits; empty: the order of the call

        std::size_t operator[](std::size_t at) const { return sorted.empty() ? at : std::uint32_t(sorted[at]); }
    };

    template <typename Begin>
    Order sorted_by_place(const View& scene, std::size_t queries, Begin&& begin);
    /// Order of the queries, and the request that ends them.
    struct Run {
        Order order;
        const std::stop_token& stop;
    };
    template <typename Answer>
    class KeptBuffers;
    template <typename Answer, typename Find>
    void answer(const Run& run, std::vector<Answer> Worker::*collected, Answers<Answer>& answers, Find&& find);
    template <typename Answer>
    void join(const std::stop_token& stop, std::vector<Answer> Worker::*collected, Answers<Answer>& answers);
    template <typename Query>
    void find_overlaps(const View& scene, const Box3d& around, const Query& query, Worker& worker) const;

    Team& team_;
    std::vector<Worker> workers_;
    std::vector<Part> parts_;
    RadixSort<std::uint64_t> sorter_;
};

}  // namespace octopair
