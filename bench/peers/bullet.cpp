// Bullet's dynamic bounding volume trees: all pairs at once (deferred), and frame by frame.
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>

#include "peers/contender.hpp"
#include "peers/tracker.hpp"

namespace octopair::bench {

namespace {

btVector3 vector_of(const float* at) { return {at[0], at[1], at[2]}; }

std::uint32_t object(const btBroadphaseProxy* proxy) {
    return std::uint32_t(reinterpret_cast<std::uintptr_t>(proxy->m_clientObject));
}

/// Broad phase with its pair cache, and a proxy for each box.
class BulletWorld {
public:
    BulletWorld(std::span<const Box3f> boxes, bool deferred) : broadphase_(&cache_), proxies_(boxes.size()) {
        broadphase_.m_deferedcollide = deferred;
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            proxies_[i] = broadphase_.createProxy(vector_of(boxes[i].min), vector_of(boxes[i].max), 0,
                                                  reinterpret_cast<void*>(i), 1, 1, nullptr);
        }
        broadphase_.calculateOverlappingPairs(nullptr);
    }
    BulletWorld(const BulletWorld&) = delete;
    BulletWorld& operator=(const BulletWorld&) = delete;
    ~BulletWorld() {
        // destroyProxy() searches the whole pair cache for the pairs of its proxy. An empty cache saves these n
        // searches.
        btNullPairCache empty;
        broadphase_.m_paircache = &empty;
        for (btBroadphaseProxy* proxy : proxies_) broadphase_.destroyProxy(proxy, nullptr);
    }

    void next(const Frame& frame) {
        for (std::size_t i = 0; i < frame.moved.size(); ++i) {
            const Box3f& box = frame.moved_boxes[i];
            broadphase_.setAabb(proxies_[frame.moved[i]], vector_of(box.min), vector_of(box.max), nullptr);
        }
        broadphase_.calculateOverlappingPairs(nullptr);
    }

    const btBroadphasePairArray& found() { return cache_.getOverlappingPairArray(); }

    /// Returns the number of objects that overlap a box.
    std::uint64_t overlaps(const Box3f& box) {
        struct Count final : btBroadphaseAabbCallback {
            explicit Count(const Box3f& of) : low(vector_of(of.min)), high(vector_of(of.max)) {}
            bool process(const btBroadphaseProxy* proxy) override {
                // The trees have enlarged boxes.
                if (TestAabbAgainstAabb2(low, high, proxy->m_aabbMin, proxy->m_aabbMax)) ++objects;
                return true;
            }
            btVector3 low, high;
            std::uint64_t objects = 0;
        } count(box);
        broadphase_.aabbTest(count.low, count.high, count);
        return count.objects;
    }

private:
    btHashedOverlappingPairCache cache_;
    btDbvtBroadphase broadphase_;
    std::vector<btBroadphaseProxy*> proxies_;
};

class Bullet : public CollectingContender {
public:
    void run(std::span<const Box3f> boxes) override {
        BulletWorld world(boxes, true);
        pairs_.clear();
        const btBroadphasePairArray& found = world.found();
        for (int i = 0; i < found.size(); ++i)
            pairs_.push_back({object(found[i].m_pProxy0), object(found[i].m_pProxy1)});
    }
};

/// Bullet's cache holds pairs of enlarged boxes, and drops ended pairs only gradually. Each pair is therefore tested
/// with the proxies' own boxes before it enters the list.
template <bool deferred>
class BulletTracker : public CollectingTracker {
public:
    void begin(std::span<const Box3f> boxes) override {
        gDbvtMargin = margin_for(boxes);
        world_ = std::make_unique<BulletWorld>(boxes, deferred);
        collect();
    }
    void next(const Frame& frame) override {
        world_->next(frame);
        collect();
    }
    std::optional<std::uint64_t> overlaps(std::span<const Box3f> boxes) override {
        std::uint64_t objects = 0;
        for (const Box3f& box : boxes) objects += world_->overlaps(box);
        return objects;
    }

private:
    /// Returns a margin in proportion to the objects: Bullet's default of 0.05 is meant for objects of size about 1.
    static btScalar margin_for(std::span<const Box3f> boxes) {
        double sides = 0;
        for (const Box3f& box : boxes) sides += double(box.max[0]) - double(box.min[0]);
        return btScalar(0.05 * sides / double(boxes.size()));
    }

    void collect() {
        pairs_.clear();
        const btBroadphasePairArray& found = world_->found();
        for (int i = 0; i < found.size(); ++i) {
            const btBroadphaseProxy* const a = found[i].m_pProxy0;
            const btBroadphaseProxy* const b = found[i].m_pProxy1;
            if (TestAabbAgainstAabb2(a->m_aabbMin, a->m_aabbMax, b->m_aabbMin, b->m_aabbMax)) {
                pairs_.push_back({object(a), object(b)});
            }
        }
    }

    std::unique_ptr<BulletWorld> world_;
};

}  // namespace

std::vector<ContenderKind> bullet_contenders() {
    return {{"Bullet dbvt", false, false,
             [](unsigned) -> std::unique_ptr<Contender> { return std::make_unique<Bullet>(); }}};
}

std::vector<TrackerKind> bullet_trackers() {
    return {
        {"Bullet dbvt", false,
         [](unsigned) -> std::unique_ptr<Tracker> { return std::make_unique<BulletTracker<false>>(); }},
        {"Bullet dbvt deferred", false,
         [](unsigned) -> std::unique_ptr<Tracker> { return std::make_unique<BulletTracker<true>>(); }},
    };
}

}  // namespace octopair::bench
