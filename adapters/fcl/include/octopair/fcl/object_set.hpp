// ObjectSet: the registered objects of a manager, with their boxes and the scene that holds the boxes.
//
// Invariants
//   An object has the same index in the scene and in all arrays here. Arrays have null or stale elements at free indices.
//   The scene has the box of boxes_[index] for each object.
//   If ordered_, ascending indices are in the order of registration.
//   A call that throws has changed nothing.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <unordered_map>
#include <vector>

#include "octopair/fcl/object_boxes.hpp"
#include "octopair/scene.hpp"

namespace octopair::fcl {

struct ManagerOptions {
    unsigned threads =
        1;  ///< threads that find pairs; 0: one per core. Callbacks are always called on the calling thread.
    BoundingBoxes boxes = BoundingBoxes::tight;
};

namespace detail {

template <typename S>
class ObjectSet {
public:
    using Object = ::fcl::CollisionObject<S>;

    explicit ObjectSet(const ManagerOptions& options) : options_(options), scene_(scene_options()) {}

    /// Adds the objects that the set does not have. Throws: Error{bad_input} for an invalid box.
    void add(std::span<Object* const> objects) {
        fresh_.clear();
        boxes_to_send_.clear();
        fresh_.reserve(objects.size());
        try {
            for (std::size_t i = 0; i < objects.size(); ++i) {
                if (!indices_.emplace(objects[i], no_index).second) continue;
                fresh_.push_back(objects[i]);
                Box<S> box = bounding_box(*objects[i], *objects[i]->collisionGeometry(), options_.boxes);
                if (!make_valid(box)) refuse_box(box, "object " + std::to_string(i) + " of the call");
                boxes_to_send_.push_back(box);
            }
            add_fresh();
        } catch (...) {
            for (const Object* const object : fresh_) indices_.erase(object);
            throw;
        }
    }

    /// Removes an object. Does nothing if the set does not have it.
    void remove(const Object* object) {
        const auto at = indices_.find(object);
        if (at == indices_.end()) return;
        const std::uint32_t index = at->second;
        scene_.remove(std::span(&ids_[index], 1));
        indices_.erase(at);
        objects_[index] = nullptr;
        order_is_stale_ = true;
        note_changes(1);
    }

    void clear() {
        clear_arrays();
        indices_.clear();
    }

    /// Gives the scene the present boxes of all objects that moved. Throws: Error{bad_input} for an invalid box.
    void update() {
        changed_.clear();
        boxes_to_send_.clear();
        changed_.reserve(objects_.size());
        boxes_to_send_.reserve(objects_.size());
        for (std::uint32_t index = 0; index < objects_.size(); ++index) {
            prefetch(index + 6);
            if (objects_[index] != nullptr) note_if_moved(index);
        }
        send_moves();
    }
    /// As update(), for those of `objects` that the set has.
    void update(std::span<Object* const> objects) {
        changed_.clear();
        boxes_to_send_.clear();
        for (const Object* const object : objects) {
            const auto at = indices_.find(object);
            if (at != indices_.end()) note_if_moved(at->second);
        }
        send_moves();
    }

    std::size_t size() const { return indices_.size(); }
    BoundingBoxes kind() const { return options_.boxes; }
    unsigned threads() const { return options_.threads; }
    Object* object(std::uint32_t index) const { return objects_[index]; }
    const Box<S>& box(std::uint32_t index) const { return boxes_[index]; }
    /// Returns whether ascending indices are in the order of registration.
    bool ordered() const { return ordered_; }
    /// Returns the indices of all objects in the order of registration.
    const std::vector<std::uint32_t>& order() const {
        if (order_is_stale_) find_order();
        return order_;
    }
    /// Returns the position in order() of each index.
    std::vector<std::uint32_t> ranks() const {
        std::vector<std::uint32_t> ranks(objects_.size());
        for (std::uint32_t i = 0; i < order().size(); ++i) ranks[order()[i]] = i;
        return ranks;
    }
    /// Returns a number for each index; it is larger for objects that were registered later.
    std::uint64_t registration(std::uint32_t index) const { return registrations_[index]; }

    /// Returns the scene for a step.
    Scene& scene_to_step() const {
        changes_ = queries_ = 0;
        return scene_;
    }
    /// Returns the scene for a number of queries.
    Scene& scene_to_query(std::size_t queries) const {
        // Each query tests all objects that few changes have touched since the last step. A step costs about as much as some
        // hundred queries. After many changes the scene itself builds what its queries need.
        constexpr std::size_t queries_per_step = 256;
        queries_ += queries;
        if (changes_ > 0 && changes_ < size() / 8 + queries_per_step && queries_ > queries_per_step)
            scene_to_step().step();
        return scene_;
    }

private:
    SceneOptions scene_options() const {
        SceneOptions options;
        options.threads = options_.threads;
        options.precision = std::is_same_v<S, float> ? Precision::float32 : Precision::float64;
        return options;
    }
    static Objects as_objects(const std::vector<Box<S>>& boxes) { return {.boxes = std::span<const Box<S>>(boxes)}; }

    /// Empties the scene and all arrays, but not indices_.
    void clear_arrays() {
        scene_ = Scene(scene_options());
        objects_.clear();
        geometries_.clear();
        boxes_.clear();
        ids_.clear();
        registrations_.clear();
        ordered_ = true;
        order_is_stale_ = true;
        changes_ = queries_ = 0;
    }

    void note_changes(std::size_t count) {
        changes_ += count;
        queries_ = 0;
    }

    /// Starts to load what the box of an object depends on. Objects and geometries lie apart in memory, so an update of
    /// 100,000 moved objects would wait for memory most of its time.
    void prefetch(std::size_t index) const {
        if (index >= objects_.size() || objects_[index] == nullptr) return;
        const Object& object = *objects_[index];
        if (options_.boxes == BoundingBoxes::fcl) return prefetch_all(object.getAABB());
        prefetch_all(object.getTransform());
        prefetch_all(geometries_[index]->aabb_local);
    }
    template <typename Value>
    static void prefetch_all(const Value& value) {
        constexpr std::size_t cache_line = 64;
        const auto* const bytes = reinterpret_cast<const char*>(&value);
        for (std::size_t at = 0; at < sizeof(Value); at += cache_line) __builtin_prefetch(bytes + at);
        __builtin_prefetch(bytes + sizeof(Value) - 1);
    }

    /// Appends the object to the changed ones if its box has changed.
    void note_if_moved(std::uint32_t index) {
        Box<S> box = bounding_box(*objects_[index], *geometries_[index], options_.boxes);
        if (!make_valid(box)) refuse_box(box, "registered object " + std::to_string(rank(index)));
        const Box<S>& former = boxes_[index];
        bool is_same = true;
        for (int axis = 0; axis < 3; ++axis) {
            is_same &= (box.min[axis] == former.min[axis]) & (box.max[axis] == former.max[axis]);
        }
        if (is_same) return;
        changed_.push_back(ids_[index]);
        boxes_to_send_.push_back(box);
    }

    void send_moves() {
        if (changed_.empty()) return;
        scene_.move(changed_, std::span<const Box<S>>(boxes_to_send_));
        for (std::size_t i = 0; i < changed_.size(); ++i) boxes_[changed_[i].index] = boxes_to_send_[i];
        note_changes(changed_.size());
    }

    /// Adds the objects of fresh_ with the boxes of boxes_to_send_. Requires: indices_ has these objects, with no_index.
    void add_fresh() {
        if (fresh_.empty()) return;
        const bool was_empty = size() == fresh_.size();
        if (was_empty && !objects_.empty()) clear_arrays();
        changed_.resize(fresh_.size());
        reserve(std::size_t(scene_.indices()) + fresh_.size());
        scene_.add(as_objects(boxes_to_send_), changed_);
        // From here on nothing fails.
        grow(std::size_t(scene_.indices()));
        for (std::size_t i = 0; i < fresh_.size(); ++i) {
            const std::uint32_t index = changed_[i].index;
            ordered_ &= last_index_ < index || (was_empty && i == 0);
            last_index_ = index;
            indices_.find(fresh_[i])->second = index;
            objects_[index] = fresh_[i];
            geometries_[index] = fresh_[i]->collisionGeometry().get();
            boxes_[index] = boxes_to_send_[i];
            ids_[index] = changed_[i];
            registrations_[index] = next_registration_++;
        }
        order_is_stale_ = true;
        note_changes(fresh_.size());
    }

    /// Reserves memory for a number of indices, so that grow() does not fail.
    void reserve(std::size_t indices) {
        if (indices <= objects_.capacity()) return;
        const std::size_t more = std::max(indices, 2 * objects_.capacity());
        registrations_.reserve(more);
        ids_.reserve(more);
        boxes_.reserve(more);
        geometries_.reserve(more);
        objects_.reserve(more);  // last: its capacity is the smallest one
    }
    void grow(std::size_t indices) {
        objects_.resize(indices);
        geometries_.resize(indices);
        boxes_.resize(indices);
        ids_.resize(indices);
        registrations_.resize(indices);
    }

    void find_order() const {
        order_.clear();
        for (std::uint32_t index = 0; index < objects_.size(); ++index) {
            if (objects_[index] != nullptr) order_.push_back(index);
        }
        const auto earlier = [&](std::uint32_t a, std::uint32_t b) { return registrations_[a] < registrations_[b]; };
        if (!ordered_) std::sort(order_.begin(), order_.end(), earlier);
        order_is_stale_ = false;
    }

    std::size_t rank(std::uint32_t index) const {
        const auto& all = order();
        return std::size_t(std::find(all.begin(), all.end(), index) - all.begin());
    }

    static constexpr std::uint32_t no_index = ~std::uint32_t(0);  ///< index of an object while add() runs

    ManagerOptions options_;
    mutable Scene scene_;
    std::unordered_map<const Object*, std::uint32_t> indices_;
    // Elements of the following arrays belong to the object of an index.
    std::vector<Object*> objects_;
    std::vector<const ::fcl::CollisionGeometry<S>*> geometries_;
    std::vector<Box<S>> boxes_;
    std::vector<ObjectId> ids_;
    std::vector<std::uint64_t> registrations_;
    std::uint64_t next_registration_ = 0;
    std::uint32_t last_index_ = 0;  ///< index of the object that was registered last
    bool ordered_ = true;
    mutable bool order_is_stale_ = true;
    mutable std::vector<std::uint32_t> order_;
    mutable std::size_t changes_ = 0;  ///< number of changed objects since the last step
    mutable std::size_t queries_ = 0;  ///< number of queries since the last change
    // Buffers of a call.
    std::vector<Object*> fresh_;
    std::vector<ObjectId> changed_;
    std::vector<Box<S>> boxes_to_send_;
};

}  // namespace detail

}  // namespace octopair::fcl
