#include "scene/queries/scene_queries.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "base/tuning.hpp"
#include "scene/queries/query_rules.hpp"

namespace octopair {

namespace {

/// Returns whether the object is alive and in one of the groups of the query.
bool is_wanted(const SceneQueries::View& scene, std::uint32_t index) {
    return scene.table.alive(index) && (scene.table.traits(index).groups & scene.groups) != 0;
}

/// Returns whether the octree holds the current box of the object.
bool is_unchanged(const SceneQueries::View& scene, std::uint32_t index) {
    return scene.log == nullptr || scene.table.mark(index) == ObjectTable::none;
}

/// Calls visit(index) for each object that is wanted and has changed since the octree was brought up to date.
template <typename Visit>
void for_each_changed(const SceneQueries::View& scene, Visit&& visit) {
    if (scene.log == nullptr) return;
    for (const PreviousState& former : scene.log->previous_states()) {
        if (is_wanted(scene, former.index)) visit(former.index);
    }
}

/// Base of the nearest-first searches. Maps regions of the octree to the scene's coordinates.
class SceneProbe : public NearestVisitor {
public:
    explicit SceneProbe(const SceneQueries::View& scene) : scene_(scene) {}

    double at_least(const Box3d& region) const final {
        // Entries are boxes minus the origin, rounded, and clamped to the range of float32. Margin and paddings only
        // enlarge them.
        constexpr double roundings = 0x1p-50, end = double(std::numeric_limits<float>::max()) * (1 - 0x1p-20);
        Box3d moved;
        for (int axis = 0; axis < 3; ++axis) {
            const double origin = scene_.rounding.origin[axis];
            const double lo = origin + region.min[axis], hi = origin + region.max[axis];
            moved.min[axis] = region.min[axis] > -end ? lo - roundings * (std::abs(origin) + std::abs(lo)) : -infinity;
            moved.max[axis] = region.max[axis] < end ? hi + roundings * (std::abs(origin) + std::abs(hi)) : infinity;
        }
        return from(moved);
    }
    void take(std::uint32_t index) final {
        if (is_unchanged(scene_, index) && is_wanted(scene_, index)) try_object(index);
    }
    void search() {
        for_each_changed(scene_, [&](std::uint32_t index) { try_object(index); });
        scene_.octree.search(*this);
    }

protected:
    static constexpr double infinity = std::numeric_limits<double>::infinity();
    const ObjectTable& table() const { return scene_.table; }

private:
    virtual double from(const Box3d& region) const = 0;
    virtual void try_object(std::uint32_t index) = 0;

    const SceneQueries::View& scene_;
};

/// Base of ray queries. A region that the ray misses has an infinite distance, which is beyond each limit here.
class RayProbe : public SceneProbe {
public:
    RayProbe(const SceneQueries::View& scene, const Ray& ray) : SceneProbe(scene), ray_(ray) {}

protected:
    const Ray& ray() const { return ray_; }

private:
    double from(const Box3d& region) const final {
        const auto along = hit(ray_, region);
        if (!along) return infinity;
        // Rounding may put the entry into a box in the region slightly before the entry into the region.
        constexpr double underflow = std::numeric_limits<double>::min();
        constexpr double roundings = 4 * std::numeric_limits<double>::epsilon();
        return std::min(*along * (1 - roundings) - underflow, std::numeric_limits<double>::max());
    }

    const Ray& ray_;
};

class FirstHit final : public RayProbe {
public:
    using RayProbe::RayProbe;
    const RayHit& best() const { return best_; }

private:
    double limit() const override { return std::min(best_.along, std::numeric_limits<double>::max()); }
    void try_object(std::uint32_t index) override {
        const auto along = hit(ray(), table().box(index));
        if (along && (*along < best_.along || (*along == best_.along && index < best_.index))) best_ = {index, *along};
    }

    RayHit best_{ObjectTable::none, infinity};
};

class AllHits final : public RayProbe {
public:
    AllHits(const SceneQueries::View& scene, const Ray& ray, std::vector<RayHit>& hits)
        : RayProbe(scene, ray), hits_(hits) {}

private:
    double limit() const override { return std::numeric_limits<double>::max(); }
    void try_object(std::uint32_t index) override {
        if (const auto along = hit(ray(), table().box(index))) hits_.push_back({index, *along});
    }

    std::vector<RayHit>& hits_;
};

/// Appends the nearest objects, in order, to a list.
class Nearest final : public SceneProbe {
public:
    Nearest(const SceneQueries::View& scene, const Box3d& place, const NearestLimits& limits,
            std::vector<Neighbor>& list)
        : SceneProbe(scene), place_(place), limits_(limits), list_(list), begin_(list.size()) {}

private:
    // Rounded distances have the order of the exact ones. So an object with a larger rounded distance than the last one in
    // the list is farther. An object with an equal rounded distance may be nearer, and is compared exactly.
    double from(const Box3d& region) const override { return distance_at_least(place_, region); }
    double limit() const override { return is_full() ? list_.back().distance : limits_.within; }
    void try_object(std::uint32_t index) override {
        const Box3d box = table().box(index);
        if (distance_at_least(place_, box) > limit()) return;
        const Neighbor found{index, distance(place_, box)};
        if (found.distance > limits_.within) return;
        const auto at = std::lower_bound(list_.begin() + std::ptrdiff_t(begin_), list_.end(), found,
                                         [&](const Neighbor& a, const Neighbor& b) { return nearer(a, b); });
        if (at != list_.end() && at->index == index) return;
        const bool full = is_full();
        if (full && at == list_.end()) return;
        list_.insert(at, found);
        if (full) list_.pop_back();
    }

    bool is_full() const { return list_.size() - begin_ == limits_.count; }
    bool nearer(const Neighbor& a, const Neighbor& b) const {
        if (a.distance != b.distance) return a.distance < b.distance;
        if (a.distance == 0 || a.index == b.index) return a.index < b.index;
        const int sign = exactly_compare_distances(place_, table().box(a.index), table().box(b.index));
        return sign != 0 ? sign < 0 : a.index < b.index;
    }

    const Box3d& place_;
    const NearestLimits& limits_;
    std::vector<Neighbor>& list_;
    std::size_t begin_;
};

}  // namespace

/// Calls find(query, worker) for each query in parallel, and joins the answers in the order of the queries. `find` appends
/// its answers to `collected`.
template <typename Answer, typename Find>
void SceneQueries::answer(std::size_t queries, std::vector<Answer> Worker::*collected, Answers<Answer>& answers,
                          Find&& find) {
    for (Worker& worker : workers_) (worker.*collected).clear();
    parts_.resize(queries);
    const std::size_t share_size = tuning().scene.share_queries;
    const auto find_share = [&](std::size_t share, unsigned number) {
        Worker& worker = workers_[number];
        const std::size_t end = std::min((share + 1) * share_size, queries);
        for (std::size_t i = share * share_size; i < end; ++i) {
            const std::size_t begin = (worker.*collected).size();
            find(i, worker);
            parts_[i] = {number, begin, (worker.*collected).size()};
        }
    };
    team_.for_each((queries + share_size - 1) / share_size, std::ref(find_share));
    answers.all.clear();
    answers.ends.clear();
    for (const Part& part : parts_) {
        const auto all = (workers_[part.worker].*collected).begin();
        answers.all.insert(answers.all.end(), all + std::ptrdiff_t(part.begin), all + std::ptrdiff_t(part.end));
        answers.ends.push_back(answers.all.size());
    }
}

/// Finds the objects that overlap `query`. Requires: the box `around` contains the query.
template <typename Query>
void SceneQueries::find_overlaps(const View& scene, const Box3d& around, const Query& query, Worker& worker) const {
    const std::size_t begin = worker.indices.size();
    const auto try_object = [&](std::uint32_t index) {
        if (overlap(query, scene.table.box(index))) worker.indices.push_back(index);
    };
    worker.found.clear();
    scene.octree.search(scene.octree.space().cells(scene.rounding.entry(around, 0)), worker.found);
    for (const std::uint32_t index : worker.found) {
        if (is_unchanged(scene, index) && is_wanted(scene, index)) try_object(index);
    }
    for_each_changed(scene, try_object);
    std::sort(worker.indices.begin() + std::ptrdiff_t(begin), worker.indices.end());
}

void SceneQueries::overlaps(const View& scene, std::span<const Box3d> boxes, Answers<std::uint32_t>& answers) {
    answer(boxes.size(), &Worker::indices, answers,
           [&](std::size_t i, Worker& worker) { find_overlaps(scene, boxes[i], boxes[i], worker); });
}

void SceneQueries::overlaps(const View& scene, std::span<const Sphere> spheres, Answers<std::uint32_t>& answers) {
    // More than the relative rounding error of the box around a sphere.
    constexpr double roundings = 0x1p-48;
    constexpr double most = std::numeric_limits<double>::max();
    answer(spheres.size(), &Worker::indices, answers, [&](std::size_t i, Worker& worker) {
        Box3d around;
        for (int axis = 0; axis < 3; ++axis) {
            const double centre = spheres[i].centre[axis];
            const double reach = spheres[i].radius + roundings * (spheres[i].radius + std::abs(centre));
            around.min[axis] = std::max(centre - reach, -most);
            around.max[axis] = std::min(centre + reach, most);
        }
        find_overlaps(scene, around, spheres[i], worker);
    });
}

void SceneQueries::first_hits(const View& scene, std::span<const Ray> rays, Answers<RayHit>& answers) {
    answer(rays.size(), &Worker::hits, answers, [&](std::size_t i, Worker& worker) {
        FirstHit first(scene, rays[i]);
        first.search();
        if (first.best().index != ObjectTable::none) worker.hits.push_back(first.best());
    });
}

void SceneQueries::all_hits(const View& scene, std::span<const Ray> rays, Answers<RayHit>& answers) {
    answer(rays.size(), &Worker::hits, answers, [&](std::size_t i, Worker& worker) {
        const auto begin = std::ptrdiff_t(worker.hits.size());
        AllHits(scene, rays[i], worker.hits).search();
        std::sort(worker.hits.begin() + begin, worker.hits.end(), [](const RayHit& a, const RayHit& b) {
            return a.along != b.along ? a.along < b.along : a.index < b.index;
        });
        worker.hits.erase(std::unique(worker.hits.begin() + begin, worker.hits.end()), worker.hits.end());
    });
}

void SceneQueries::nearest(const View& scene, std::span<const Box3d> places, const NearestLimits& limits,
                           Answers<Neighbor>& answers) {
    answer(places.size(), &Worker::neighbors, answers, [&](std::size_t i, Worker& worker) {
        if (limits.count > 0) Nearest(scene, places[i], limits, worker.neighbors).search();
    });
}

}  // namespace octopair
