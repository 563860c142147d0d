#include "scene/queries/scene_queries.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "octree/dynamic/nearest_search.hpp"
#include "scene/queries/query_rules.hpp"

namespace octopair {

namespace {

constexpr double farthest = std::numeric_limits<double>::max();
constexpr Box3d everywhere = {{-farthest, -farthest, -farthest}, {farthest, farthest, farthest}};

/// Returns a point as a box.
Box3d point(const double (&at)[3]) { return {{at[0], at[1], at[2]}, {at[0], at[1], at[2]}}; }

/// Returns a box that contains all points whose rounded distance from `box` is at most `distance`.
Box3d widened(const Box3d& box, double distance) {
    // More than the relative rounding errors of the distance and of the bounds.
    constexpr double roundings = 0x1p-48;
    Box3d wide;
    for (int axis = 0; axis < 3; ++axis) {
        const double size = std::max(std::abs(box.min[axis]), std::abs(box.max[axis]));
        const double reach = distance + roundings * (distance + size);
        wide.min[axis] = std::max(box.min[axis] - reach, -farthest);
        wide.max[axis] = std::min(box.max[axis] + reach, farthest);
    }
    return wide;
}

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

/// Searches the objects of a scene with a visitor (NearestSearch) that has try_object(index) in place of take().
template <typename Visitor>
class SceneProbe {
public:
    SceneProbe(const SceneQueries::View& scene, Visitor& visitor) : scene_(scene), visitor_(visitor) {}

    double at_least(const Box3d& region) const { return visitor_.at_least(region); }
    double limit() const { return visitor_.limit(); }
    CellBox reach() const { return cells(visitor_.reach()); }
    void take(std::uint32_t index) {
        if (is_unchanged(scene_, index) && is_wanted(scene_, index)) visitor_.try_object(index);
    }
    /// `begin`: where the search begins.
    void search(const RegionMap& map, const Box3d& begin) {
        for_each_changed(scene_, [&](std::uint32_t index) { visitor_.try_object(index); });
        NearestSearch(scene_.octree, map, cells(begin).lo, *this).run();
    }

private:
    CellBox cells(const Box3d& box) const { return scene_.octree.space().cells(scene_.rounding.entry(box, 0)); }

    const SceneQueries::View& scene_;
    Visitor& visitor_;
};

/// Base of ray queries. A region that the ray misses has an infinite distance, which is beyond each limit here.
class RayProbe {
public:
    RayProbe(const SceneQueries::View& scene, const Ray& ray) : table_(scene.table), ray_(ray) {}

    double at_least(const Box3d& region) const {
        const auto along = hit(ray_, region);
        if (!along) return std::numeric_limits<double>::infinity();
        // Rounding may put the entry into a box in the region slightly before the entry into the region.
        constexpr double underflow = std::numeric_limits<double>::min();
        constexpr double roundings = 4 * std::numeric_limits<double>::epsilon();
        return std::min(*along * (1 - roundings) - underflow, std::numeric_limits<double>::max());
    }

    Box3d reach() const { return everywhere; }

protected:
    std::optional<double> hit_object(std::uint32_t index) const { return hit(ray_, table_.box(index)); }

private:
    const ObjectTable& table_;
    const Ray& ray_;
};

class FirstHit : public RayProbe {
public:
    using RayProbe::RayProbe;
    const RayHit& best() const { return best_; }
    double limit() const { return std::min(best_.along, std::numeric_limits<double>::max()); }
    void try_object(std::uint32_t index) {
        const auto along = hit_object(index);
        if (along && (*along < best_.along || (*along == best_.along && index < best_.index))) best_ = {index, *along};
    }

private:
    RayHit best_{ObjectTable::none, std::numeric_limits<double>::infinity()};
};

class AllHits : public RayProbe {
public:
    AllHits(const SceneQueries::View& scene, const Ray& ray, std::vector<RayHit>& hits)
        : RayProbe(scene, ray), hits_(hits) {}
    double limit() const { return std::numeric_limits<double>::max(); }
    void try_object(std::uint32_t index) {
        if (const auto along = hit_object(index)) hits_.push_back({index, *along});
    }

private:
    std::vector<RayHit>& hits_;
};

/// Appends the nearest objects, in order, to a list. Searches by squared distances.
class Nearest {
public:
    Nearest(const SceneQueries::View& scene, const Box3d& place, const NearestLimits& limits,
            std::vector<Neighbor>& list)
        : table_(scene.table),
          place_(place),
          limits_(limits),
          list_(list),
          begin_(list.size()),
          square_limit_(square_at_most(limits.within)) {}

    double at_least(const Box3d& region) const { return square_at_least(place_, region); }
    // Rounded distances have the order of the exact ones. So an object with a larger rounded distance than the last one in
    // the list is farther. An object with an equal rounded distance may be nearer, and is compared exactly.
    double limit() const { return square_limit_; }
    Box3d reach() const { return widened(place_, is_full() ? list_.back().distance : limits_.within); }
    void try_object(std::uint32_t index) {
        const Box3d box = table_.box(index);
        if (square_at_least(place_, box) > square_limit_) return;
        const Neighbor found{index, distance(place_, box)};
        if (found.distance > limits_.within) return;
        const auto at = std::lower_bound(list_.begin() + std::ptrdiff_t(begin_), list_.end(), found,
                                         [&](const Neighbor& a, const Neighbor& b) { return nearer(a, b); });
        if (at != list_.end() && at->index == index) return;
        const bool full = is_full();
        if (full && at == list_.end()) return;
        list_.insert(at, found);
        if (full) list_.pop_back();
        if (is_full()) square_limit_ = square_at_most(list_.back().distance);
    }

private:
    bool is_full() const { return list_.size() - begin_ == limits_.count; }
    bool nearer(const Neighbor& a, const Neighbor& b) const {
        if (a.distance != b.distance) return a.distance < b.distance;
        if (a.distance == 0 || a.index == b.index) return a.index < b.index;
        const int sign = exactly_compare_distances(place_, table_.box(a.index), table_.box(b.index));
        return sign != 0 ? sign < 0 : a.index < b.index;
    }

    const ObjectTable& table_;
    const Box3d& place_;
    const NearestLimits& limits_;
    std::vector<Neighbor>& list_;
    std::size_t begin_;
    double square_limit_;
};

/// Returns a box that contains a sphere.
Box3d box_around(const Sphere& sphere) { return widened(point(sphere.centre), sphere.radius); }

/// Returns the origin of a ray, as a box.
Box3d origin_of(const Ray& ray) { return point(ray.origin); }

}  // namespace

/// Returns an order in which queries that follow each other read the same memory: that of the units that hold the low corners of the boxes
/// begin(i) of the queries. Few queries keep the order of the call. The order is valid until the next call.
template <typename Begin>
SceneQueries::Order SceneQueries::sorted_by_place(const View& scene, std::size_t queries, Begin&& begin) {
    if (scene.octree.empty() || queries < tuning().scene.min_sorted_queries ||
        queries > std::numeric_limits<std::uint32_t>::max())
        return {queries, {}};
    count_path(Path::queries_sorted);
    const std::span<std::uint64_t> keys = sorter_.take(queries);
    const std::size_t share_size = tuning().scene.share_queries;
    const auto set_keys = [&](std::size_t share, unsigned) {
        throw_if_stopped(scene.stop);
        const std::size_t end = std::min((share + 1) * share_size, queries);
        for (std::size_t i = share * share_size; i < end; ++i) {
            const CellBox cells = scene.octree.space().cells(scene.rounding.entry(begin(i), 0));
            keys[i] = std::uint64_t(scene.octree.unit_at(cells.lo).index) << 32 | i;
        }
    };
    team_.for_each((queries + share_size - 1) / share_size, std::ref(set_keys));
    return {queries, sorter_.sort(32, 32 + unsigned(std::bit_width(scene.octree.units())))};
}

/// Frees large buffers of the workers at the end of a call, whether it returns or fails.
template <typename Answer>
class SceneQueries::KeptBuffers {
public:
    KeptBuffers(std::vector<Worker>& workers, std::vector<Answer> Worker::*buffer)
        : workers_(workers), buffer_(buffer) {}
    ~KeptBuffers() {
        for (Worker& worker : workers_) {
            std::vector<Answer>& buffer = worker.*buffer_;
            if (buffer.capacity() > tuning().scene.max_kept_answers) std::vector<Answer>().swap(buffer);
        }
    }
    KeptBuffers(const KeptBuffers&) = delete;
    KeptBuffers& operator=(const KeptBuffers&) = delete;

private:
    std::vector<Worker>& workers_;
    std::vector<Answer> Worker::*buffer_;
};

/// Calls find(query, worker) for each query in parallel, in this order, and joins the answers in the order of the queries. `find` appends
/// its answers to `collected`.
template <typename Answer, typename Find>
void SceneQueries::answer(const Run& run, std::vector<Answer> Worker::*collected, Answers<Answer>& answers,
                          Find&& find) {
    const std::size_t queries = run.order.queries;
    const KeptBuffers kept(workers_, collected);
    for (Worker& worker : workers_) (worker.*collected).clear();
    parts_.resize(queries);
    const std::size_t share_size = tuning().scene.share_queries;
    const auto find_share = [&](std::size_t share, unsigned number) {
        Worker& worker = workers_[number];
        const std::size_t end = std::min((share + 1) * share_size, queries);
        for (std::size_t at = share * share_size; at < end; ++at) {
            throw_if_stopped(run.stop);
            const std::size_t i = run.order[at];
            const std::size_t begin = (worker.*collected).size();
            find(i, worker);
            parts_[i] = {number, begin, (worker.*collected).size()};
        }
    };
    team_.for_each((queries + share_size - 1) / share_size, std::ref(find_share));
    join(run.stop, collected, answers);
}

/// Joins the answers of all workers in the order of the queries.
template <typename Answer>
void SceneQueries::join(const std::stop_token& stop, std::vector<Answer> Worker::*collected, Answers<Answer>& answers) {
    std::size_t size = 0;
    for (const Worker& worker : workers_) size += (worker.*collected).size();
    answers.all.clear();
    answers.all.reserve(size);
    answers.ends.clear();
    answers.ends.reserve(parts_.size());
    for (const Part& part : parts_) {
        throw_if_stopped(stop);
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
    const Order order = sorted_by_place(scene, boxes.size(), [&](std::size_t i) { return boxes[i]; });
    answer({order, scene.stop}, &Worker::indices, answers,
           [&](std::size_t i, Worker& worker) { find_overlaps(scene, boxes[i], boxes[i], worker); });
}

void SceneQueries::overlaps(const View& scene, std::span<const Sphere> spheres, Answers<std::uint32_t>& answers) {
    const Order order = sorted_by_place(scene, spheres.size(), [&](std::size_t i) { return box_around(spheres[i]); });
    answer({order, scene.stop}, &Worker::indices, answers,
           [&](std::size_t i, Worker& worker) { find_overlaps(scene, box_around(spheres[i]), spheres[i], worker); });
}

void SceneQueries::first_hits(const View& scene, std::span<const Ray> rays, Answers<RayHit>& answers) {
    const RegionMap map(scene.octree.space(), scene.rounding.origin);
    const Order order = sorted_by_place(scene, rays.size(), [&](std::size_t i) { return origin_of(rays[i]); });
    answer({order, scene.stop}, &Worker::hits, answers, [&](std::size_t i, Worker& worker) {
        FirstHit first(scene, rays[i]);
        SceneProbe(scene, first).search(map, origin_of(rays[i]));
        if (first.best().index != ObjectTable::none) worker.hits.push_back(first.best());
    });
}

void SceneQueries::all_hits(const View& scene, std::span<const Ray> rays, Answers<RayHit>& answers) {
    const RegionMap map(scene.octree.space(), scene.rounding.origin);
    const Order order = sorted_by_place(scene, rays.size(), [&](std::size_t i) { return origin_of(rays[i]); });
    answer({order, scene.stop}, &Worker::hits, answers, [&](std::size_t i, Worker& worker) {
        const auto begin = std::ptrdiff_t(worker.hits.size());
        AllHits all(scene, rays[i], worker.hits);
        SceneProbe(scene, all).search(map, origin_of(rays[i]));
        std::sort(worker.hits.begin() + begin, worker.hits.end(), [](const RayHit& a, const RayHit& b) {
            return a.along != b.along ? a.along < b.along : a.index < b.index;
        });
        worker.hits.erase(std::unique(worker.hits.begin() + begin, worker.hits.end()), worker.hits.end());
    });
}

void SceneQueries::nearest(const View& scene, std::span<const Box3d> places, const NearestLimits& limits,
                           Answers<Neighbor>& answers) {
    const RegionMap map(scene.octree.space(), scene.rounding.origin);
    const Order order = sorted_by_place(scene, places.size(), [&](std::size_t i) { return places[i]; });
    answer({order, scene.stop}, &Worker::neighbors, answers, [&](std::size_t i, Worker& worker) {
        if (limits.count == 0) return;
        Nearest nearest(scene, places[i], limits, worker.neighbors);
        SceneProbe(scene, nearest).search(map, places[i]);
    });
}

}  // namespace octopair
