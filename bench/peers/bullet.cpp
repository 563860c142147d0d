// Bullet's dynamic bounding volume trees, all pairs at once (deferred).
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>

#include "peers/contender.hpp"

namespace octopair::bench {

namespace {

btVector3 vector_of(const float* at) { return {at[0], at[1], at[2]}; }

class Bullet : public CollectingContender {
public:
    void run(std::span<const Box3f> boxes) override {
        btHashedOverlappingPairCache cache;
        btDbvtBroadphase broadphase(&cache);
        broadphase.m_deferedcollide = true;
        std::vector<btBroadphaseProxy*> proxies(boxes.size());
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            proxies[i] = broadphase.createProxy(vector_of(boxes[i].min), vector_of(boxes[i].max), 0,
                                                reinterpret_cast<void*>(i), 1, 1, nullptr);
        }
        broadphase.calculateOverlappingPairs(nullptr);
        pairs_.clear();
        const btBroadphasePairArray& found = cache.getOverlappingPairArray();
        for (int i = 0; i < found.size(); ++i)
            pairs_.push_back({object(found[i].m_pProxy0), object(found[i].m_pProxy1)});
        // Each proxy that goes has the cache looked through for its pairs: in all n times the pairs, of no use to anyone.
        btNullPairCache empty;
        broadphase.m_paircache = &empty;
        for (btBroadphaseProxy* proxy : proxies) broadphase.destroyProxy(proxy, nullptr);
    }

private:
    static std::uint32_t object(const btBroadphaseProxy* proxy) {
        return std::uint32_t(reinterpret_cast<std::uintptr_t>(proxy->m_clientObject));
    }
};

}  // namespace

std::vector<ContenderKind> bullet_contenders() {
    return {{"Bullet dbvt", false, false,
             [](unsigned) -> std::unique_ptr<Contender> { return std::make_unique<Bullet>(); }}};
}

}  // namespace octopair::bench
