// BroadPhaseManager: a broad phase of FCL, with octopair behind it.
//
//     #include <octopair/fcl/broad_phase_manager.hpp>
//     octopair::fcl::BroadPhaseManager<double> manager;  // was: fcl::DynamicAABBTreeCollisionManager<double> manager;
//
// Result    collide() calls the callback for each pair whose boxes overlap, once. Boxes that touch overlap. distance() calls the
//           callback for pairs whose boxes are less than the callback's `dist` apart; pairs with near boxes come early. A
//           callback that returns true ends the call. No object forms a pair with itself.
// Order     collide(): by registration of the first object, then of the second. distance(): a function of the boxes, of the
//           order of registration and of what callbacks return.
// Arguments callback(a, b): a was registered before b. With an object or a manager as argument, a is in this manager.
// Boxes     A manager reads boxes in registerObject(), registerObjects(), update() and setup(). By default it computes tight
//           boxes from the transforms of the objects. BoundingBoxes::fcl reads the boxes of CollisionObject::computeAABB().
//           Boxes may be unbounded, like those of planes and half-spaces.
// Managers  The argument of collide() and distance() may be any FCL manager.
// Octrees   An fcl::OcTree is one object with one box, as in FCL with octree_as_geometry_collide and
//           octree_as_geometry_distance.
// Errors    octopair::Error{bad_input} for a box that is not a number, or empty (min > max). The call then changes nothing.
//           Errors of Scene, and exceptions of callbacks, propagate.
// Threads   One thread at a time, also for const functions. Callbacks may call const functions of the manager.
// Cost      update() costs a few memory accesses per object. collide() costs a step of a Scene, which depends on what moved.
#pragma once

#include <fcl/broadphase/broadphase_collision_manager.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "octopair/engine.hpp"
#include "octopair/fcl/near_pairs.hpp"
#include "octopair/fcl/object_set.hpp"

namespace octopair::fcl {

template <typename S>
class BroadPhaseManager : public ::fcl::BroadPhaseCollisionManager<S> {
public:
    using Manager = ::fcl::BroadPhaseCollisionManager<S>;
    using Object = ::fcl::CollisionObject<S>;

    explicit BroadPhaseManager(const ManagerOptions& options = {}) : set_(options) {}

    /// Registers objects. Ignores objects that are registered already.
    void registerObjects(const std::vector<Object*>& objects) override { set_.add(objects); }
    void registerObject(Object* object) override { set_.add(std::span(&object, 1)); }
    /// Removes an object. Does nothing if it is not registered.
    void unregisterObject(Object* object) override { set_.remove(object); }
    void setup() override { set_.update(); }
    /// Reads the boxes of all objects.
    void update() override { set_.update(); }
    /// Read the boxes of objects. Ignore objects that are not registered.
    void update(Object* object) override { set_.update(std::span<Object* const>(&object, 1)); }
    void update(const std::vector<Object*>& objects) override { set_.update(objects); }
    void clear() override { set_.clear(); }
    bool empty() const override { return set_.size() == 0; }
    std::size_t size() const override { return set_.size(); }

    /// Replaces `objects` by the registered objects, in the order of registration.
    void getObjects(std::vector<Object*>& objects) const override {
        objects.clear();
        for (const std::uint32_t index : set_.order()) objects.push_back(set_.object(index));
    }

    void collide(void* data, ::fcl::CollisionCallBack<S> callback) const override {
        Scene& scene = set_.scene_to_step();
        scene.step();
        if (!set_.ordered()) return call_in_order(scene.pairs(), data, callback);
        for (const auto chunk : scene.pairs().chunks()) {
            for (const auto [a, b] : chunk) {
                if (callback(set_.object(a), set_.object(b), data)) return;
            }
        }
    }

    void collide(Object* object, void* data, ::fcl::CollisionCallBack<S> callback) const override {
        if (empty()) return;
        std::vector<std::uint32_t> found = overlaps(detail::box_of_argument(*object, set_.kind()));
        for (const std::uint32_t index : found) {
            if (set_.object(index) != object && callback(set_.object(index), object, data)) return;
        }
    }

    void collide(Manager* other, void* data, ::fcl::CollisionCallBack<S> callback) const override {
        if (other == this) return collide(data, callback);
        if (empty() || other->empty()) return;
        const auto* const same_kind = dynamic_cast<const BroadPhaseManager*>(other);
        if (same_kind != nullptr && size() < other->size() / few) return query(*same_kind, data, callback);
        const List theirs = list_of(*other);
        const std::vector<Pair> pairs = theirs.boxes.size() < size() / few ? query(theirs) : join(theirs);
        for (const auto [a, b] : pairs) {
            if (callback(set_.object(set_.order()[a]), theirs.objects[b], data)) return;
        }
    }

    void distance(void* data, ::fcl::DistanceCallBack<S> callback) const override {
        std::vector<Box<S>> boxes;
        for (const std::uint32_t index : set_.order()) boxes.push_back(set_.box(index));
        const SelfCalls calls{set_, data, callback};
        detail::NearPairs<S, SelfCalls>(set_, boxes, calls).run(engine());
    }

    void distance(Object* object, void* data, ::fcl::DistanceCallBack<S> callback) const override {
        if (empty()) return;
        const Box<S> box = detail::box_of_argument(*object, set_.kind());
        const std::vector<Object*> objects{object};
        const MixedCalls calls{set_, objects, false, data, callback};
        detail::NearPairs<S, MixedCalls>(set_, std::span(&box, 1), calls).run(engine());
    }

    void distance(Manager* other, void* data, ::fcl::DistanceCallBack<S> callback) const override {
        if (other == this) return distance(data, callback);
        if (empty() || other->empty()) return;
        const auto* const same_kind = dynamic_cast<const BroadPhaseManager*>(other);
        // The objects of the smaller manager query the scene of the larger one.
        const bool swapped = same_kind != nullptr && size() < other->size();
        const List seekers = list_of(swapped ? static_cast<const Manager&>(*this) : *other);
        const auto& targets = swapped ? same_kind->set_ : set_;
        const MixedCalls calls{targets, seekers.objects, swapped, data, callback};
        detail::NearPairs<S, MixedCalls>(targets, seekers.boxes, calls).run(engine());
    }

private:
    using Set = detail::ObjectSet<S>;

    /// Ratio of sizes beyond which the objects of the smaller manager query the larger one. For more objects a search from
    /// scratch is faster.
    static constexpr std::size_t few = 16;

    /// The objects of a manager with their boxes, in the order of registration.
    struct List {
        std::vector<Object*> objects;
        std::vector<Box<S>> boxes;
    };

    /// Calls for pairs of registered objects. Seekers are in the order of registration.
    struct SelfCalls {
        static constexpr bool is_self = true;
        const Set& set;
        void* data;
        ::fcl::DistanceCallBack<S> callback;

        bool wants(std::uint32_t seeker, std::uint32_t target) const {
            return set.registration(set.order()[seeker]) < set.registration(target);
        }
        bool call(std::uint32_t seeker, std::uint32_t target, S& dist) const {
            return callback(set.object(set.order()[seeker]), set.object(target), data, dist);
        }
    };

    /// Calls for pairs of registered objects with others. `swapped`: the seekers are in this manager, the targets in another.
    struct MixedCalls {
        static constexpr bool is_self = false;
        const Set& set;
        const std::vector<Object*>& seekers;
        bool swapped;
        void* data;
        ::fcl::DistanceCallBack<S> callback;

        bool wants(std::uint32_t seeker, std::uint32_t target) const { return seekers[seeker] != set.object(target); }
        bool call(std::uint32_t seeker, std::uint32_t target, S& dist) const {
            Object* const a = set.object(target);
            Object* const b = seekers[seeker];
            return swapped ? callback(b, a, data, dist) : callback(a, b, data, dist);
        }
    };

    Engine& engine() const {
        if (!engine_) engine_ = make_local_engine(set_.threads());
        return *engine_;
    }

    List list_of(const Manager& manager) const {
        List list;
        manager.getObjects(list.objects);
        const auto* const same_kind = dynamic_cast<const BroadPhaseManager*>(&manager);
        for (std::size_t i = 0; i < list.objects.size(); ++i) {
            list.boxes.push_back(same_kind != nullptr ? same_kind->set_.box(same_kind->set_.order()[i])
                                                      : detail::box_of_argument(*list.objects[i], set_.kind()));
        }
        return list;
    }

    /// Calls for pairs of indices in the order of registration. Requires: indices are in another order.
    void call_in_order(const PairList& pairs, void* data, ::fcl::CollisionCallBack<S> callback) const {
        std::vector<Pair> sorted = ranked(pairs);
        std::sort(sorted.begin(), sorted.end());
        for (const auto [a, b] : sorted) {
            if (callback(set_.object(set_.order()[a]), set_.object(set_.order()[b]), data)) return;
        }
    }

    /// Returns the pairs with positions in order() instead of indices, a < b.
    std::vector<Pair> ranked(const PairList& pairs) const {
        const std::vector<std::uint32_t> ranks = set_.ranks();
        std::vector<Pair> result;
        result.reserve(std::size_t(pairs.size()));
        for (const auto chunk : pairs.chunks()) {
            for (const auto [a, b] : chunk)
                result.push_back({std::min(ranks[a], ranks[b]), std::max(ranks[a], ranks[b])});
        }
        return result;
    }

    /// Returns the indices of objects that overlap a box, in the order of registration.
    std::vector<std::uint32_t> overlaps(const Box<S>& box) const {
        std::vector<std::uint32_t> found = set_.scene_to_query(1).overlaps(detail::to_double(box));
        const auto earlier = [&](std::uint32_t a, std::uint32_t b) {
            return set_.registration(a) < set_.registration(b);
        };
        if (!set_.ordered()) std::sort(found.begin(), found.end(), earlier);
        return found;
    }

    /// Queries a larger manager with all objects, and calls for the answers.
    void query(const BroadPhaseManager& other, void* data, ::fcl::CollisionCallBack<S> callback) const {
        for (const std::uint32_t index : set_.order()) {
            for (const std::uint32_t found : other.overlaps(set_.box(index))) {
                Object* const object = set_.object(index);
                if (object != other.set_.object(found) && callback(object, other.set_.object(found), data)) return;
            }
        }
    }

    /// Returns the pairs of order() and `theirs`, by queries with the boxes of `theirs`.
    std::vector<Pair> query(const List& theirs) const {
        const std::vector<std::uint32_t> ranks = set_.ranks();
        std::vector<Pair> pairs;
        for (std::uint32_t i = 0; i < theirs.boxes.size(); ++i) {
            for (const std::uint32_t index : overlaps(theirs.boxes[i])) {
                if (set_.object(index) != theirs.objects[i]) pairs.push_back({ranks[index], i});
            }
        }
        std::sort(pairs.begin(), pairs.end());
        return pairs;
    }

    /// Returns the pairs of order() and `theirs`, by a search from scratch.
    std::vector<Pair> join(const List& theirs) const {
        const List ours = list_of(*this);
        const auto objects = [](const List& list) { return Objects{.boxes = std::span<const Box<S>>(list.boxes)}; };
        PairList found;
        (void)engine().find_pairs(Join{objects(ours), objects(theirs)}, found);
        std::vector<Pair> pairs = found.to_vector();
        std::erase_if(pairs, [&](Pair pair) { return ours.objects[pair.a] == theirs.objects[pair.b]; });
        return pairs;
    }

    Set set_;
    mutable std::unique_ptr<Engine> engine_;
};

using BroadPhaseManagerf = BroadPhaseManager<float>;
using BroadPhaseManagerd = BroadPhaseManager<double>;

}  // namespace octopair::fcl
