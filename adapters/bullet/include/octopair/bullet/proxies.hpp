// Proxies: the objects of a Bullet world, and the scene that holds their boxes.
//
// Invariants
//   A change of a proxy reaches the scene with the next flush(): all removals, moves and additions as one batch each.
//   The scene's indices depend only on the order of the calls, so the order of pairs does, too.
#pragma once

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "octopair/error.hpp"
#include "octopair/scene.hpp"

namespace octopair::bullet {

using Real = btScalar;

inline Box<Real> box_of(const btVector3& lower, const btVector3& upper) {
    return {{lower.x(), lower.y(), lower.z()}, {upper.x(), upper.y(), upper.z()}};
}

struct Proxy : btBroadphaseProxy {
    using btBroadphaseProxy::btBroadphaseProxy;

    ObjectId id;                          ///< valid once the proxy is in the scene
    bool is_new = true;                   ///< not in the scene yet
    bool is_queued = true;                ///< in the queue of new or of changed proxies
    std::size_t position = 0;             ///< in that queue
    Traits traits;                        ///< what the scene has
    std::vector<std::uint32_t> partners;  ///< scene indices of the proxies that it overlaps since the last step
    std::uint64_t last_ray = 0;           ///< number of the last ray test that has met it
};

class Proxies {
public:
    explicit Proxies(unsigned threads) : threads_(threads), scene_(options(threads)) {}

    Proxy& add(const btBroadphaseProxy& made) {
        check(made.m_aabbMin, made.m_aabbMax);
        auto proxy = std::make_unique<Proxy>(made.m_aabbMin, made.m_aabbMax, made.m_clientObject,
                                             made.m_collisionFilterGroup, made.m_collisionFilterMask);
        proxy->position = new_.size();
        new_.push_back(std::move(proxy));
        new_.back()->m_uniqueId = ++last_id_;
        return *new_.back();
    }
    /// Sets the box of a proxy. Throws: Error{bad_input} if it is not finite or min > max.
    void move(Proxy& proxy, const btVector3& lower, const btVector3& upper) {
        if (proxy.m_aabbMin == lower && proxy.m_aabbMax == upper) return;
        check(lower, upper);
        if (!proxy.is_queued) changed_.push_back(&proxy);
        proxy.m_aabbMin = lower;
        proxy.m_aabbMax = upper;
        if (proxy.is_queued) return;
        proxy.is_queued = true;
        proxy.position = changed_.size() - 1;
    }
    /// Reserves memory for a call of remove().
    void reserve_removal() {
        if (removed_.size() == removed_.capacity()) removed_.reserve(2 * removed_.size() + 1);
    }
    /// Requires: reserve_removal() was called before each call.
    void remove(Proxy& proxy) noexcept {
        if (proxy.is_new) {
            new_[proxy.position] = nullptr;
            return;
        }
        if (proxy.is_queued) changed_[proxy.position] = nullptr;
        removed_.push_back(proxy.id);
        of_index_[proxy.id.index] = nullptr;
    }

    /// If there are no proxies, makes a new scene, and gives the next proxy the first number.
    void reset_if_empty() {
        bool any = false;
        for_each([&](const Proxy&) { any = true; });
        if (any) return;
        *this = Proxies(threads_);
    }

    /// Sends all changes to the scene. `with_filters`: groups and masks decide which proxies make pairs.
    /// If the call fails, the next one sends the changes that the scene does not have.
    Scene& flush(bool with_filters) {
        is_new_rule_ |= with_filters != with_filters_;
        with_filters_ = with_filters;
        scene_.remove(removed_);
        removed_.clear();
        move_changed();
        if (is_new_rule_) {
            for (const auto& proxy : of_index_) {
                if (proxy != nullptr) set_traits(*proxy);
            }
            is_new_rule_ = false;
        }
        add_new();
        return scene_;
    }
    Scene& flush() { return flush(with_filters_); }

    /// Returns the proxy with a scene index, or null.
    Proxy* at(std::uint32_t index) const { return index < of_index_.size() ? of_index_[index].get() : nullptr; }
    /// Calls visit(proxy) for each proxy.
    template <typename Visit>
    void for_each(Visit&& visit) const {
        for (const auto* const all : {&of_index_, &new_}) {
            for (const auto& proxy : *all) {
                if (proxy != nullptr) visit(*proxy);
            }
        }
    }
    /// Returns a typical length of the boxes: the mean over all that were added.
    double typical_length() const { return lengths_ > 0 ? sum_of_lengths_ / double(lengths_) : 1; }

private:
    static SceneOptions options(unsigned threads) {
        SceneOptions options;
        options.threads = threads;
        options.precision = sizeof(Real) == sizeof(double) ? Precision::float64 : Precision::float32;
        return options;
    }

    static void check(const btVector3& lower, const btVector3& upper) {
        for (int axis = 0; axis < 3; ++axis) {
            if (lower[axis] <= upper[axis] && std::isfinite(lower[axis]) && std::isfinite(upper[axis])) continue;
            throw Error(ErrorCode::bad_input, "box of a proxy: from " + std::to_string(lower[axis]) + " to " +
                                                  std::to_string(upper[axis]) + " on axis " + std::to_string(axis) +
                                                  ", not finite with min <= max");
        }
    }

    Traits wanted_traits(const Proxy& proxy) const {
        if (!with_filters_) return {};
        return {std::uint32_t(proxy.m_collisionFilterGroup), std::uint32_t(proxy.m_collisionFilterMask), false};
    }
    void set_traits(Proxy& proxy) {
        const Traits traits = wanted_traits(proxy);
        if (proxy.traits == traits) return;
        scene_.set_traits(std::span(&proxy.id, 1), std::span(&traits, 1));
        proxy.traits = traits;
    }

    void move_changed() {
        ids_.clear();
        boxes_.clear();
        for (Proxy* const proxy : changed_) {
            if (proxy == nullptr) continue;
            set_traits(*proxy);
            ids_.push_back(proxy->id);
            boxes_.push_back(box_of(proxy->m_aabbMin, proxy->m_aabbMax));
        }
        scene_.move(ids_, std::span<const Box<Real>>(boxes_));
        for (Proxy* const proxy : changed_) {
            if (proxy != nullptr) proxy->is_queued = false;
        }
        changed_.clear();
    }

    void add_new() {
        std::erase(new_, nullptr);
        if (new_.empty()) return;
        boxes_.clear();
        traits_.clear();
        for (std::size_t i = 0; i < new_.size(); ++i) new_[i]->position = i;
        for (const auto& proxy : new_) {
            boxes_.push_back(box_of(proxy->m_aabbMin, proxy->m_aabbMax));
            traits_.push_back(wanted_traits(*proxy));
        }
        ids_.resize(new_.size());
        // Reserves all memory before the scene changes.
        const std::size_t most = std::size_t(scene_.indices()) + new_.size();
        if (most > of_index_.capacity()) of_index_.reserve(2 * most);
        scene_.add(Objects{std::span<const Box<Real>>(boxes_)}, ids_, traits_);
        of_index_.resize(std::size_t(scene_.indices()));
        for (std::size_t i = 0; i < new_.size(); ++i) {
            note_length(*new_[i]);
            new_[i]->traits = traits_[i];
            new_[i]->id = ids_[i];
            new_[i]->is_new = new_[i]->is_queued = false;
            of_index_[ids_[i].index] = std::move(new_[i]);
        }
        new_.clear();
    }

    void note_length(const Proxy& proxy) {
        const double length = double((proxy.m_aabbMax - proxy.m_aabbMin).length());
        if (!(length < 1e9)) return;  // Bullet's planes have boxes of 1e18
        sum_of_lengths_ += length;
        ++lengths_;
    }

    unsigned threads_;
    Scene scene_;
    bool with_filters_ = true;
    bool is_new_rule_ = false;  // with_filters_ has changed, and not all proxies in the scene have the traits that it requires
    int last_id_ = 0;
    std::vector<std::unique_ptr<Proxy>> of_index_;  // by scene index
    std::vector<std::unique_ptr<Proxy>> new_;
    std::vector<Proxy*> changed_;
    std::vector<ObjectId> removed_;
    std::vector<ObjectId> ids_;  // buffers of flush()
    std::vector<Box<Real>> boxes_;
    std::vector<Traits> traits_;
    double sum_of_lengths_ = 0;
    std::uint64_t lengths_ = 0;
};

}  // namespace octopair::bullet
