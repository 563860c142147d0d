// Broadphase: octopair as the broad phase of a Bullet world.
//
//     octopair::bullet::Broadphase broadphase;      // was: btDbvtBroadphase broadphase;
//     btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
//
// Pairs     After calculateOverlappingPairs() the pair cache has each pair of proxies whose boxes overlap, touching included, and that
//           the filter accepts. Bullet's own broad phases have pairs of enlarged boxes, too.
// Filter    Groups and masks as in Bullet; changed values count from the next change of the proxy's box on, also for pairs in the cache.
//           If the cache has a filter callback, it decides alone. Pairs that it has refused are offered to it again in each step. Pairs
//           that it has accepted stay until the boxes part.
// Cache     If the program has changed the number of pairs in the cache, the next step adds the missing pairs. Pairs that the program has
//           added may stay until one of their proxies is destroyed.
// Order     Ended pairs leave and new pairs come in the order of the scene's indices. It depends on the calls alone, neither on addresses
//           nor on threads. Without removals it is the order of creation.
// Queries   rayTest() and aabbTest() use the current boxes, also between steps. They call the callback in an order that depends on the
//           boxes alone.
// Errors    octopair::Error{bad_input} for a box that is not finite or has min > max. Bullet does not call setAabb() with such a box.
//           Exceptions of the filter callback propagate. After a failed call all other calls work; if calculateOverlappingPairs()
//           fails, the cache may lack pairs until it succeeds.
// Threads   One thread at a time. `threads` threads search for pairs.
#pragma once

#include <BulletCollision/BroadphaseCollision/btBroadphaseInterface.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <LinearMath/btAabbUtil2.h>

#include <cstdio>
#include <utility>

#include "octopair/bullet/proxies.hpp"

namespace octopair::bullet {

class Broadphase : public btBroadphaseInterface {
public:
    /// `cache`: borrowed; null: the broad phase makes a btHashedOverlappingPairCache. `threads`: 0: one per core.
    explicit Broadphase(btOverlappingPairCache* cache = nullptr, unsigned threads = 1)
        : proxies_(threads),
          own_cache_(cache == nullptr ? std::make_unique<btHashedOverlappingPairCache>() : nullptr),
          cache_(cache == nullptr ? own_cache_.get() : cache) {}
    Broadphase(const Broadphase&) = delete;
    Broadphase& operator=(const Broadphase&) = delete;
    ~Broadphase() override = default;

    btBroadphaseProxy* createProxy(const btVector3& aabbMin, const btVector3& aabbMax, int /*shapeType*/, void* userPtr,
                                   int collisionFilterGroup, int collisionFilterMask,
                                   btDispatcher* /*dispatcher*/) override {
        return &proxies_.add({aabbMin, aabbMax, userPtr, collisionFilterGroup, collisionFilterMask});
    }

    void destroyProxy(btBroadphaseProxy* proxy, btDispatcher* dispatcher) override {
        Proxy& gone = *static_cast<Proxy*>(proxy);
        proxies_.reserve_removal();
        const int before = cache_->getNumOverlappingPairs();
        // The program may have added pairs that are not among the partners. Only a search of the whole cache finds them.
        const bool was_complete = std::exchange(is_complete_, false);
        const bool are_known = was_complete && before == expected_ && !cache_->hasDeferredRemoval();
        if (was_complete) {
            for (const std::uint32_t index : gone.partners) {
                Proxy& partner = *proxies_.at(index);
                std::erase(partner.partners, gone.id.index);
                if (are_known) cache_->removeOverlappingPair(&gone, &partner, dispatcher);
            }
        }
        if (!are_known) cache_->removeOverlappingPairsContainingProxy(&gone, dispatcher);
        expected_ -= before - cache_->getNumOverlappingPairs();
        proxies_.remove(gone);
        is_complete_ = was_complete;
    }

    void setAabb(btBroadphaseProxy* proxy, const btVector3& aabbMin, const btVector3& aabbMax,
                 btDispatcher* /*dispatcher*/) override {
        proxies_.move(*static_cast<Proxy*>(proxy), aabbMin, aabbMax);
    }
    void getAabb(btBroadphaseProxy* proxy, btVector3& aabbMin, btVector3& aabbMax) const override {
        aabbMin = proxy->m_aabbMin;
        aabbMax = proxy->m_aabbMax;
    }

    void rayTest(const btVector3& rayFrom, const btVector3& rayTo, btBroadphaseRayCallback& rayCallback,
                 const btVector3& aabbMin = btVector3(0, 0, 0), const btVector3& aabbMax = btVector3(0, 0, 0)) override;

    void aabbTest(const btVector3& aabbMin, const btVector3& aabbMax, btBroadphaseAabbCallback& callback) override {
        Box3d box;
        for (int axis = 0; axis < 3; ++axis) {
            box.min[axis] = double(aabbMin[axis]);
            box.max[axis] = double(aabbMax[axis]);
        }
        for (const std::uint32_t index : proxies_.flush().overlaps(box)) (void)callback.process(proxies_.at(index));
    }

    void calculateOverlappingPairs(btDispatcher* dispatcher) override;

    btOverlappingPairCache* getOverlappingPairCache() override { return cache_; }
    const btOverlappingPairCache* getOverlappingPairCache() const override { return cache_; }

    /// Returns the box around all proxies; 0 in all corners if there are none.
    void getBroadphaseAabb(btVector3& aabbMin, btVector3& aabbMax) const override {
        bool any = false;
        aabbMin = aabbMax = btVector3(0, 0, 0);
        proxies_.for_each([&](const Proxy& proxy) {
            if (!any) aabbMin = proxy.m_aabbMin, aabbMax = proxy.m_aabbMax;
            any = true;
            aabbMin.setMin(proxy.m_aabbMin);
            aabbMax.setMax(proxy.m_aabbMax);
        });
    }

    /// If there are no proxies: numbers new ones from the beginning, so that a repeated simulation has the same order of pairs.
    void resetPool(btDispatcher* /*dispatcher*/) override { proxies_.reset_if_empty(); }

    void printStats() override { std::printf("octopair: %d pairs\n", cache_->getNumOverlappingPairs()); }

private:
    /// Adds a pair to the cache, if the filter accepts it.
    void offer(const Pair& pair) {
        if (cache_->addOverlappingPair(proxies_.at(pair.a), proxies_.at(pair.b)) == nullptr) refused_.push_back(pair);
    }
    bool overlap(const Pair& pair) const {
        const Proxy* const a = proxies_.at(pair.a);
        return a != nullptr && std::find(a->partners.begin(), a->partners.end(), pair.b) != a->partners.end();
    }
    void end_pair(const Pair& pair, btDispatcher* dispatcher) {
        Proxy *const a = proxies_.at(pair.a), *const b = proxies_.at(pair.b);
        if (a == nullptr || b == nullptr) return;  // destroyProxy() has removed the pair
        std::erase(a->partners, pair.b);
        std::erase(b->partners, pair.a);
        if (!cache_->hasDeferredRemoval()) cache_->removeOverlappingPair(a, b, dispatcher);
    }
    void begin_pair(const Pair& pair) {
        proxies_.at(pair.a)->partners.push_back(pair.b);
        proxies_.at(pair.b)->partners.push_back(pair.a);
    }
    void remove_ended(btDispatcher* dispatcher);
    void offer_refused_again() {
        std::vector<Pair> before;
        before.swap(refused_);
        for (const Pair& pair : before) {
            if (overlap(pair)) offer(pair);
        }
    }
    void restore_partners(Scene& scene);
    void restore_cache(Scene& scene);

    Proxies proxies_;
    std::unique_ptr<btOverlappingPairCache> own_cache_;
    btOverlappingPairCache* cache_;
    int expected_ = 0;           // number of pairs in the cache, unless the program changes it
    bool is_complete_ = true;    // false: a call failed before partners and cache had all its changes
    std::vector<Pair> refused_;  // overlapping pairs that the filter callback has refused
    std::uint64_t rays_ = 0;
};

inline void Broadphase::calculateOverlappingPairs(btDispatcher* dispatcher) {
    Scene& scene = proxies_.flush(cache_->getOverlapFilterCallback() == nullptr);
    const bool is_ours = is_complete_ && cache_->getNumOverlappingPairs() == expected_;
    const StepResult& step = scene.step();
    const bool was_complete = std::exchange(is_complete_, false);
    if (was_complete) {
        for (const Pair& pair : step.ended) end_pair(pair, dispatcher);
        if (!step.ended.empty() && cache_->hasDeferredRemoval()) remove_ended(dispatcher);
        for (const Pair& pair : step.began) begin_pair(pair);
    } else {
        restore_partners(scene);
        remove_ended(dispatcher);
    }
    if (is_ours) {
        offer_refused_again();
        for (const Pair& pair : step.began) offer(pair);
    } else {
        restore_cache(scene);
    }
    expected_ = cache_->getNumOverlappingPairs();
    is_complete_ = true;
}

/// Removes the pairs whose boxes have parted by a search of the whole cache.
inline void Broadphase::remove_ended(btDispatcher* dispatcher) {
    struct Parted : btOverlapCallback {
        explicit Parted(const Broadphase& of) : broadphase(of) {}
        bool processOverlap(btBroadphasePair& pair) override {
            return !broadphase.overlap({static_cast<const Proxy*>(pair.m_pProxy0)->id.index,
                                        static_cast<const Proxy*>(pair.m_pProxy1)->id.index});
        }
        const Broadphase& broadphase;
    };
    Parted parted(*this);
    cache_->processAllOverlappingPairs(&parted, dispatcher);
}

/// Finds the partners of all proxies anew, after a failure.
inline void Broadphase::restore_partners(Scene& scene) {
    proxies_.for_each([](Proxy& proxy) { proxy.partners.clear(); });
    for (const std::span<const Pair> chunk : scene.pairs().chunks()) {
        for (const Pair& pair : chunk) begin_pair(pair);
    }
}

/// Adds the pairs that the cache lacks, because the program has removed them or because a step failed.
inline void Broadphase::restore_cache(Scene& scene) {
    refused_.clear();
    for (const std::span<const Pair> chunk : scene.pairs().chunks()) {
        for (const Pair& pair : chunk) {
            if (cache_->findPair(proxies_.at(pair.a), proxies_.at(pair.b)) == nullptr) offer(pair);
        }
    }
}

/// Divides the ray into pieces of a few typical lengths, and tests the proxies whose boxes overlap the box around a piece.
inline void Broadphase::rayTest(const btVector3& rayFrom, const btVector3& rayTo, btBroadphaseRayCallback& rayCallback,
                                const btVector3& aabbMin, const btVector3& aabbMax) {
    Scene& scene = proxies_.flush();
    const std::uint64_t ray = ++rays_;
    const auto test = [&](Proxy& proxy) {
        if (std::exchange(proxy.last_ray, ray) == ray) return;
        const btVector3 bounds[2] = {proxy.m_aabbMin - aabbMax, proxy.m_aabbMax - aabbMin};
        btScalar entry = 1;
        if (btRayAabb2(rayFrom, rayCallback.m_rayDirectionInverse, rayCallback.m_signs, bounds, entry, 0,
                       rayCallback.m_lambda_max))
            (void)rayCallback.process(&proxy);
    };
    const btVector3 way = rayTo - rayFrom;
    const double length = double(way.length()), farthest = double(rayCallback.m_lambda_max);
    if (!(farthest <= 1.001 * length)) {
        // The callback's ray does not end at rayTo.
        proxies_.for_each([&](Proxy& proxy) { test(proxy); });
        return;
    }
    constexpr double max_pieces = 256;
    const double pieces = std::clamp(std::ceil(length / (4 * proxies_.typical_length())), 1.0, max_pieces);
    // More than the rounding errors of the pieces and of btRayAabb2().
    const double slack =
        1e-4 * (double(rayFrom.length() + rayTo.length() + aabbMin.length() + aabbMax.length()) + length);
    for (double piece = 0; piece < pieces && piece / pieces * length <= double(rayCallback.m_lambda_max); ++piece) {
        Box3d around;
        for (int axis = 0; axis < 3; ++axis) {
            const double begin = double(rayFrom[axis]) + piece / pieces * double(way[axis]);
            const double end = double(rayFrom[axis]) + (piece + 1) / pieces * double(way[axis]);
            around.min[axis] = std::min(begin, end) + double(aabbMin[axis]) - slack;
            around.max[axis] = std::max(begin, end) + double(aabbMax[axis]) + slack;
        }
        for (const std::uint32_t index : scene.overlaps(around)) test(*proxies_.at(index));
    }
}

}  // namespace octopair::bullet
