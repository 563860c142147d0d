// Tests the broad phase for Bullet on random sequences of calls, against a model that tests all pairs of boxes. Some calls fail, and
// are made again.
//
// Replay: OCTOPAIR_TEST_SEED=<the seed that a failure printed>.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <set>

#include "octopair/bullet/broadphase.hpp"
#include "support/at_allocation.hpp"
#include "support/cases.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using Numbers = std::pair<int, int>;

std::set<Numbers> pairs_in(btOverlappingPairCache& cache) {
    std::set<Numbers> pairs;
    for (int i = 0; i < cache.getNumOverlappingPairs(); ++i) {
        const btBroadphasePair& pair = cache.getOverlappingPairArray()[i];
        const auto [low, high] = std::minmax(pair.m_pProxy0->m_uniqueId, pair.m_pProxy1->m_uniqueId);
        EXPECT_TRUE(pairs.emplace(low, high).second) << "a pair is twice in the cache";
    }
    return pairs;
}

/// Refuses the pairs whose numbers have a sum that `refused` divides; 0: none.
struct SumFilter : btOverlapFilterCallback {
    struct Failure {};
    int refused = 0;
    mutable int calls_before_failure = -1;  // below 0: no failure
    bool needBroadphaseCollision(btBroadphaseProxy* a, btBroadphaseProxy* b) const override {
        if (calls_before_failure-- == 0) throw Failure();
        return refused == 0 || (a->m_uniqueId + b->m_uniqueId) % refused != 0;
    }
};

struct Collected : btBroadphaseRayCallback {
    std::set<int> numbers;
    bool process(const btBroadphaseProxy* proxy) override {
        EXPECT_TRUE(numbers.insert(proxy->m_uniqueId).second) << "met twice";
        return true;
    }
};

class History {
public:
    explicit History(std::uint64_t seed)
        : random_(seed), broadphase_(seed / 2 % 2 == 0 ? nullptr : &sorted_, unsigned(1 + seed % 2)) {}

    void run(int steps) {
        for (int step = 0; step < steps && !::testing::Test::HasFailure(); ++step) {
            change();
            check_queries();
            call([&] { broadphase_.calculateOverlappingPairs(nullptr); },
                 [&] {
                     if (chance(0.3)) create();
                     if (chance(0.3)) destroy();
                 });
            EXPECT_EQ(pairs_in(*broadphase_.getOverlappingPairCache()), expected());
            check_queries();
        }
        for (btBroadphaseProxy* proxy : proxies_) broadphase_.destroyProxy(proxy, nullptr);
        EXPECT_EQ(broadphase_.getOverlappingPairCache()->getNumOverlappingPairs(), 0);
    }

    int failures() const { return failures_; }

private:
    /// Makes a call. Before it succeeds, it may fail in allocations and in the filter. Calls between() after each failure.
    template <typename Call>
    void call(
        Call&& make, const std::function<void()>& between = [] {}) {
        while (chance(0.2)) {
            const AtAllocation failure(random_() % (1u << random_() % 7), fail_allocation);
            filter_.calls_before_failure = chance(0.5) ? int(random_() % 4) : -1;
            try {
                make();
                filter_.calls_before_failure = -1;
                return;
            } catch (const std::bad_alloc&) {
                ++failures_;
            } catch (const SumFilter::Failure&) {
                ++failures_;
            } catch (const Error& error) {
                EXPECT_EQ(error.code(), ErrorCode::resource_limit) << error.what();
                ++failures_;
            }
            filter_.calls_before_failure = -1;
            between();
        }
        make();
    }

    bool chance(double part) { return std::uniform_real_distribution<>(0, 1)(random_) < part; }
    btScalar number(double low, double high) { return btScalar(std::uniform_real_distribution<>(low, high)(random_)); }
    btVector3 place() { return {number(-10, 10), number(-10, 10), number(-10, 10)}; }
    btVector3 size() {
        if (chance(0.02)) return {btScalar(1e18), number(0, 1), btScalar(1e18)};
        return {number(0, 3), number(0, 3), number(0, 3)};
    }
    btBroadphaseProxy* any() { return proxies_[std::size_t(random_() % proxies_.size())]; }

    void change() {
        for (int i = chance(0.1) ? 60 : 5; i > 0; --i) {
            if (chance(0.3) || proxies_.empty()) create();
            if (chance(0.5)) move(any());
            if (chance(0.2)) destroy();
        }
        if (chance(0.2)) broadphase_.getOverlappingPairCache()->removeOverlappingPairsContainingProxy(any(), nullptr);
        if (chance(0.2)) broadphase_.getOverlappingPairCache()->cleanProxyFromPairs(any(), nullptr);
        if (chance(0.3)) change_filter();
    }
    void create() {
        const btVector3 lower = place();
        const int group = 1 << random_() % 3, mask = int(random_() % 8);
        const btVector3 upper = lower + size();
        btBroadphaseProxy* made = nullptr;
        call([&] { made = broadphase_.createProxy(lower, upper, 0, nullptr, group, mask, nullptr); });
        proxies_.push_back(made);
    }
    void move(btBroadphaseProxy* proxy) {
        if (chance(0.2)) proxy->m_collisionFilterMask = int(random_() % 8);
        const btVector3 lower = chance(0.5) ? place() : proxy->m_aabbMin + btVector3(number(-1, 1), 0, 0);
        const btVector3 upper = lower + size();
        call([&] { broadphase_.setAabb(proxy, lower, upper, nullptr); });
    }
    void destroy() {
        if (proxies_.size() < 2) return;
        const std::size_t at = std::size_t(random_() % proxies_.size());
        call([&] { broadphase_.destroyProxy(proxies_[at], nullptr); });
        proxies_.erase(proxies_.begin() + std::ptrdiff_t(at));
    }
    /// A callback that has accepted a pair is not asked again until the boxes part. So it only accepts more here.
    void change_filter() {
        btOverlappingPairCache& cache = *broadphase_.getOverlappingPairCache();
        if (cache.getOverlapFilterCallback() == nullptr && cache.getNumOverlappingPairs() == 0) {
            filter_.refused = 2;
            cache.setOverlapFilterCallback(&filter_);
        } else if (cache.getOverlapFilterCallback() != nullptr) {
            filter_.refused = filter_.refused == 0 ? 0 : filter_.refused * 2 % 64;
        }
    }

    std::set<Numbers> expected() {
        std::set<Numbers> pairs;
        btOverlappingPairCache& cache = *broadphase_.getOverlappingPairCache();
        for (std::size_t i = 0; i < proxies_.size(); ++i) {
            for (std::size_t k = i + 1; k < proxies_.size(); ++k) {
                btBroadphaseProxy *const a = proxies_[i], *const b = proxies_[k];
                if (!TestAabbAgainstAabb2(a->m_aabbMin, a->m_aabbMax, b->m_aabbMin, b->m_aabbMax)) continue;
                if (!cache.needsBroadphaseCollision(a, b)) continue;
                const auto [low, high] = std::minmax(a->m_uniqueId, b->m_uniqueId);
                pairs.emplace(low, high);
            }
        }
        return pairs;
    }

    void check_queries() {
        check_ray();
        Collected found;
        const btVector3 lower = place(), upper = lower + size();
        call([&] {
            found.numbers.clear();
            broadphase_.aabbTest(lower, upper, found);
        });
        std::set<int> wanted;
        for (const btBroadphaseProxy* proxy : proxies_) {
            if (TestAabbAgainstAabb2(lower, upper, proxy->m_aabbMin, proxy->m_aabbMax))
                wanted.insert(proxy->m_uniqueId);
        }
        EXPECT_EQ(found.numbers, wanted);
    }
    void check_ray() {
        const btVector3 from = place(), to = chance(0.2) ? from + btVector3(number(-9, 9), 0, 0) : place();
        const btVector3 reach = chance(0.5) ? btVector3(0, 0, 0) : btVector3(number(0, 1), number(0, 1), number(0, 1));
        Collected found;
        const btVector3 way = to - from, direction = way.normalized();
        for (int axis = 0; axis < 3; ++axis) {
            const btScalar along = direction[axis];
            found.m_rayDirectionInverse[axis] = along == 0 ? btScalar(BT_LARGE_FLOAT) : 1 / along;
            found.m_signs[axis] = found.m_rayDirectionInverse[axis] < 0;
        }
        found.m_lambda_max = chance(0.2) ? btScalar(BT_LARGE_FLOAT) : direction.dot(way);
        broadphase_.rayTest(from, to, found, -reach, reach);
        std::set<int> wanted;
        for (const btBroadphaseProxy* proxy : proxies_) {
            const btVector3 bounds[2] = {proxy->m_aabbMin - reach, proxy->m_aabbMax + reach};
            btScalar entry = 1;
            if (btRayAabb2(from, found.m_rayDirectionInverse, found.m_signs, bounds, entry, 0, found.m_lambda_max))
                wanted.insert(proxy->m_uniqueId);
        }
        EXPECT_EQ(found.numbers, wanted);
    }

    std::mt19937_64 random_;
    int failures_ = 0;
    SumFilter filter_;
    btSortedOverlappingPairCache sorted_;
    bullet::Broadphase broadphase_;
    std::vector<btBroadphaseProxy*> proxies_;
};

TEST(BulletModel, HasThePairsAndAnswersOfAllPairsTested) {
    const std::uint64_t histories = case_count(scaled(300, 10));
    int failures = 0;
    for (std::uint64_t i = 0; i < histories && !HasFailure(); ++i) {
        const std::uint64_t seed = case_seed("bullet", i);
        SCOPED_TRACE("OCTOPAIR_TEST_SEED=" + std::to_string(seed));
        History history(seed);
        history.run(30);
        failures += history.failures();
    }
    EXPECT_GT(failures, 0);
}

/// Pairs of destroyed proxies leave the cache, also those that others have added.
TEST(BulletBroadphase, LeavesNoPairOfADestroyedProxy) {
    btHashedOverlappingPairCache hashed;
    btSortedOverlappingPairCache sorted;
    for (btOverlappingPairCache* const cache :
         {static_cast<btOverlappingPairCache*>(&hashed), static_cast<btOverlappingPairCache*>(&sorted)}) {
        bullet::Broadphase broadphase(cache);
        std::vector<btBroadphaseProxy*> proxies;
        for (const btScalar at : {btScalar(0), btScalar(1), btScalar(9)}) {
            const btVector3 lower(at, at, at);
            proxies.push_back(broadphase.createProxy(lower, lower + btVector3(1, 1, 1), 0, nullptr, 1, 1, nullptr));
        }
        broadphase.calculateOverlappingPairs(nullptr);
        EXPECT_EQ(pairs_in(*cache), (std::set<Numbers>{{1, 2}}));
        EXPECT_NE(cache->addOverlappingPair(proxies[0], proxies[2]), nullptr);
        broadphase.destroyProxy(proxies[0], nullptr);
        EXPECT_EQ(cache->getNumOverlappingPairs(), 0);
        broadphase.destroyProxy(proxies[1], nullptr);
        broadphase.destroyProxy(proxies[2], nullptr);
        broadphase.calculateOverlappingPairs(nullptr);
        broadphase.resetPool(nullptr);
        EXPECT_EQ(broadphase.createProxy({0, 0, 0}, {1, 1, 1}, 0, nullptr, 1, 1, nullptr)->m_uniqueId, 1);
    }
}

TEST(BulletBroadphase, RefusesBoxesThatAreNotFinite) {
    bullet::Broadphase broadphase;
    const btVector3 zero(0, 0, 0), one(1, 1, 1);
    btBroadphaseProxy* const proxy = broadphase.createProxy(zero, one, 0, nullptr, 1, 1, nullptr);
    EXPECT_THROW(broadphase.setAabb(proxy, btVector3(0, btScalar(NAN), 0), one, nullptr), Error);
    EXPECT_THROW(broadphase.setAabb(proxy, one, zero, nullptr), Error);
    EXPECT_THROW((void)broadphase.createProxy(one, zero, 0, nullptr, 1, 1, nullptr), Error);
    broadphase.calculateOverlappingPairs(nullptr);
    btVector3 lower, upper;
    broadphase.getBroadphaseAabb(lower, upper);
    EXPECT_TRUE(lower == zero && upper == one);
    broadphase.destroyProxy(proxy, nullptr);
}

}  // namespace
}  // namespace octopair::test
