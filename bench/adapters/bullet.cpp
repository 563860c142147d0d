// The broad phase of a step: btDbvtBroadphase beside the adapter, on one thread.
//
//     octopair_adapter_bullet [--quick]
//
// A step sets the boxes that have moved and updates the pairs. Both get the same boxes:
//   fall   20,000 rigid boxes that fall on the ground and on each other, in a btDiscreteDynamicsWorld
//   rest   100,000 boxes, of which one in 100 moves, at most 3 cm in a step
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <random>

#include "adapters/side_by_side.hpp"
#include "octopair/bullet/broadphase.hpp"

namespace octopair {

namespace {

/// A box that a step sets.
struct Change {
    int number;  ///< of the proxy
    btVector3 lower, upper;
};

/// Broad phases that get the same calls in turns.
class SideBySide {
public:
    void create(const btVector3& lower, const btVector3& upper, int group, int mask) {
        for (std::size_t which = 0; which < 2; ++which)
            proxies_[which].push_back(broadphases_[which]->createProxy(lower, upper, 0, nullptr, group, mask, nullptr));
    }
    void step(const std::vector<Change>& changes) {
        for (std::size_t which = 0; which < 2; ++which) {
            seconds_[which].push_back(bench::seconds_of([&] {
                for (const Change& change : changes) {
                    broadphases_[which]->setAabb(proxies_[which][std::size_t(change.number)], change.lower,
                                                 change.upper, nullptr);
                }
                broadphases_[which]->calculateOverlappingPairs(nullptr);
            }));
        }
    }
    /// Prints the medians of the steps after the first `left_out`. Returns whether the pairs whose boxes overlap are equally many.
    bool print(const char* name, std::size_t left_out) {
        const auto median = [&](std::size_t which) {
            return bench::median({seconds_[which].begin() + std::ptrdiff_t(left_out), seconds_[which].end()});
        };
        bench::print_medians(name, median(0), median(1));
        std::printf("%46d pairs in the cache %10d\n",
                    broadphases_[0]->getOverlappingPairCache()->getNumOverlappingPairs(),
                    broadphases_[1]->getOverlappingPairCache()->getNumOverlappingPairs());
        return overlapping(0) == overlapping(1);
    }

private:
    int overlapping(std::size_t which) {
        const btBroadphasePairArray& all = broadphases_[which]->getOverlappingPairCache()->getOverlappingPairArray();
        int count = 0;
        for (int i = 0; i < all.size(); ++i) {
            const btBroadphaseProxy *const a = all[i].m_pProxy0, *const b = all[i].m_pProxy1;
            count += TestAabbAgainstAabb2(a->m_aabbMin, a->m_aabbMax, b->m_aabbMin, b->m_aabbMax) ? 1 : 0;
        }
        return count;
    }

    std::unique_ptr<btBroadphaseInterface> broadphases_[2] = {std::make_unique<btDbvtBroadphase>(),
                                                              std::make_unique<bullet::Broadphase>()};
    std::vector<btBroadphaseProxy*> proxies_[2];
    std::vector<double> seconds_[2];
};

/// The broad phase of a world. Passes the boxes of each step on.
class Recorded : public bullet::Broadphase {
public:
    SideBySide measured;
    btBroadphaseProxy* createProxy(const btVector3& lower, const btVector3& upper, int shape, void* user, int group,
                                   int mask, btDispatcher* dispatcher) override {
        measured.create(lower, upper, group, mask);
        return bullet::Broadphase::createProxy(lower, upper, shape, user, group, mask, dispatcher);
    }
    void setAabb(btBroadphaseProxy* proxy, const btVector3& lower, const btVector3& upper,
                 btDispatcher* dispatcher) override {
        changes_.push_back({proxy->m_uniqueId - 1, lower, upper});
        bullet::Broadphase::setAabb(proxy, lower, upper, dispatcher);
    }
    void calculateOverlappingPairs(btDispatcher* dispatcher) override {
        measured.step(changes_);
        changes_.clear();
        bullet::Broadphase::calculateOverlappingPairs(dispatcher);
    }

private:
    std::vector<Change> changes_;
};

bool fall(const char* name, int count, int steps) {
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher(&configuration);
    btSequentialImpulseConstraintSolver solver;
    Recorded broadphase;
    btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
    btStaticPlaneShape ground({0, 1, 0}, 0);
    btBoxShape box({btScalar(0.5), btScalar(0.5), btScalar(0.5)});
    btVector3 inertia;
    box.calculateLocalInertia(1, inertia);
    std::vector<std::unique_ptr<btRigidBody>> bodies;
    bodies.push_back(std::make_unique<btRigidBody>(0, nullptr, &ground));
    std::mt19937 random(1);
    std::uniform_real_distribution<double> shift(0, 0.5);
    const int side = std::max(1, int(std::sqrt(count / 20)));
    for (int i = 0; i < count; ++i) {
        bodies.push_back(std::make_unique<btRigidBody>(1, nullptr, &box, inertia));
        const double place[] = {1.6 * (i % side), 1 + 1.6 * (i / side / side), 1.6 * (i / side % side)};
        bodies.back()->setWorldTransform(btTransform(
            btQuaternion::getIdentity(), {btScalar(place[0] + shift(random)), btScalar(place[1] + shift(random)),
                                          btScalar(place[2] + shift(random))}));
    }
    for (const auto& body : bodies) world.addRigidBody(body.get());
    for (int step = 0; step < steps; ++step) (void)world.stepSimulation(btScalar(1) / 60, 0);
    for (const auto& body : bodies) world.removeRigidBody(body.get());
    return broadphase.measured.print(name, std::size_t(steps / 4));
}

bool rest(const char* name, int count, int steps) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> place(0, 1.3 * std::cbrt(count)), way(-0.03, 0.03);
    SideBySide measured;
    std::vector<Change> moving;
    for (int i = 0; i < count; ++i) {
        const btVector3 lower{btScalar(place(random)), btScalar(place(random)), btScalar(place(random))};
        measured.create(lower, lower + btVector3(1, 1, 1), 1, -1);
        if (i % 100 == 0) moving.push_back({i, lower, lower + btVector3(1, 1, 1)});
    }
    for (int step = 0; step < steps; ++step) {
        measured.step(step == 0 ? std::vector<Change>() : moving);
        for (Change& change : moving) {
            const btVector3 by{btScalar(way(random)), btScalar(way(random)), btScalar(way(random))};
            change.lower += by;
            change.upper += by;
        }
    }
    return measured.print(name, std::size_t(steps / 4));
}

}  // namespace

}  // namespace octopair

int main(int count, char** arguments) {
    const bool quick = count > 1 && std::strcmp(arguments[1], "--quick") == 0;
    std::printf("%-44s %13s %13s\n", "boxes", "btDbvt", "octopair");
    const bool same =
        quick ? octopair::fall("fall: 500", 500, 8) && octopair::rest("rest: 2,000", 2000, 8)
              : octopair::fall("fall: 20,000", 20'000, 120) && octopair::rest("rest: 100,000", 100'000, 200);
    if (!same) std::printf("the pairs differ\n");
    return same ? 0 : 1;
}
