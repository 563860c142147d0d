// SceneQueries: answers of a scene's octree to queries (queries.hpp), many at once.
//
// The octree says which objects may be an answer; whether they are is decided on the table. Objects that have changed
// since the octree was brought up to date are not looked for in it, but each of them in turn.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "boxes/box_kernel.hpp"
#include "octopair/queries.hpp"
#include "octree/dynamic/mutable_octree.hpp"
#include "parallel/team.hpp"
#include "scene/change_log.hpp"
#include "scene/object_table.hpp"

namespace octopair {

class SceneQueries {
public:
    struct Scene {
        const ObjectTable& table;
        const MutableOctree& octree;
        const OutwardRounding& rounding;  ///< of the boxes in the octree
        const ChangeLog* log;             ///< of what has changed since; null if nothing has
        std::uint32_t groups;             ///< an answer is in one of them
    };

    explicit SceneQueries(Team& team) : team_(team), workers_(team.threads()) {}

    void overlaps(const Scene& scene, std::span<const Box3d> boxes, Answers<std::uint32_t>& answers);
    void overlaps(const Scene& scene, std::span<const Sphere> spheres, Answers<std::uint32_t>& answers);
    void first_hits(const Scene& scene, std::span<const Ray> rays, Answers<RayHit>& answers);
    void all_hits(const Scene& scene, std::span<const Ray> rays, Answers<RayHit>& answers);
    void nearest(const Scene& scene, std::span<const Box3d> places, std::size_t count, Answers<Neighbor>& answers);

private:
    /// A worker's own.
    struct Worker {
        std::vector<std::uint32_t> found;
        std::vector<std::uint32_t> indices;
        std::vector<RayHit> hits;
        std::vector<Neighbor> neighbors;
    };
    /// Where the answers to a query are.
    struct Part {
        unsigned worker;
        std::size_t begin, end;
    };

    template <typename Answer, typename Find>
    void answer(std::size_t queries, std::vector<Answer> Worker::*collected, Answers<Answer>& answers, Find&& find);
    template <typename Query>
    void find_overlaps(const Scene& scene, const Box3d& around, const Query& query, Worker& worker) const;

    Team& team_;
    std::vector<Worker> workers_;
    std::vector<Part> parts_;
};

}  // namespace octopair
