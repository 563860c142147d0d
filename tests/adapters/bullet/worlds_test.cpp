// Tests worlds of Bullet with octopair's broad phase: in each step the pairs are those of btDbvtBroadphase whose boxes overlap.
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "octopair/bullet/broadphase.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using Numbers = std::pair<int, int>;

/// Returns the numbers of the pairs in a cache whose boxes overlap, in the order of the cache.
std::vector<Numbers> overlapping(btOverlappingPairCache& cache) {
    std::vector<Numbers> pairs;
    for (int i = 0; i < cache.getNumOverlappingPairs(); ++i) {
        const btBroadphaseProxy *const a = cache.getOverlappingPairArray()[i].m_pProxy0,
                                       *const b = cache.getOverlappingPairArray()[i].m_pProxy1;
        if (!TestAabbAgainstAabb2(a->m_aabbMin, a->m_aabbMax, b->m_aabbMin, b->m_aabbMax)) continue;
        pairs.emplace_back(std::min(a->m_uniqueId, b->m_uniqueId), std::max(a->m_uniqueId, b->m_uniqueId));
    }
    return pairs;
}

/// octopair's broad phase, and Bullet's with the same boxes. Compares their pairs in each step.
class Compared : public btBroadphaseInterface {
public:
    explicit Compared(unsigned threads) : octopair_(nullptr, threads) {}

    btBroadphaseProxy* createProxy(const btVector3& lower, const btVector3& upper, int shape, void* user, int group,
                                   int mask, btDispatcher* dispatcher) override {
        btBroadphaseProxy* const proxy = octopair_.createProxy(lower, upper, shape, user, group, mask, dispatcher);
        others_.resize(std::size_t(proxy->m_uniqueId) + 1);
        btBroadphaseProxy*& other = others_.back();
        other = dbvt_.createProxy(lower, upper, shape, user, group, mask, nullptr);
        other->m_uniqueId = proxy->m_uniqueId;
        return proxy;
    }
    void destroyProxy(btBroadphaseProxy* proxy, btDispatcher* dispatcher) override {
        dbvt_.destroyProxy(other(proxy), nullptr);
        octopair_.destroyProxy(proxy, dispatcher);
    }
    void setAabb(btBroadphaseProxy* proxy, const btVector3& lower, const btVector3& upper,
                 btDispatcher* dispatcher) override {
        octopair_.setAabb(proxy, lower, upper, dispatcher);
        dbvt_.setAabb(other(proxy), lower, upper, nullptr);
    }
    void getAabb(btBroadphaseProxy* proxy, btVector3& lower, btVector3& upper) const override {
        octopair_.getAabb(proxy, lower, upper);
    }
    void rayTest(const btVector3& from, const btVector3& to, btBroadphaseRayCallback& callback, const btVector3& lower,
                 const btVector3& upper) override {
        octopair_.rayTest(from, to, callback, lower, upper);
    }
    void aabbTest(const btVector3& lower, const btVector3& upper, btBroadphaseAabbCallback& callback) override {
        octopair_.aabbTest(lower, upper, callback);
    }
    void calculateOverlappingPairs(btDispatcher* dispatcher) override {
        octopair_.calculateOverlappingPairs(dispatcher);
        dbvt_.calculateOverlappingPairs(nullptr);
        ++steps;
        btOverlappingPairCache& cache = *octopair_.getOverlappingPairCache();
        order = overlapping(cache);
        EXPECT_EQ(order.size(), std::size_t(cache.getNumOverlappingPairs())) << "a pair does not overlap";
        std::vector<Numbers> found = order, expected = overlapping(*dbvt_.getOverlappingPairCache());
        std::sort(found.begin(), found.end());
        std::sort(expected.begin(), expected.end());
        EXPECT_EQ(found, expected) << "step " << steps;
        pairs += found.size();
    }
    btOverlappingPairCache* getOverlappingPairCache() override { return octopair_.getOverlappingPairCache(); }
    const btOverlappingPairCache* getOverlappingPairCache() const override {
        return octopair_.getOverlappingPairCache();
    }
    void getBroadphaseAabb(btVector3& lower, btVector3& upper) const override {
        octopair_.getBroadphaseAabb(lower, upper);
    }
    void printStats() override {}

    int steps = 0;
    std::size_t pairs = 0;
    std::vector<Numbers> order;  ///< of the last step

private:
    btBroadphaseProxy* other(const btBroadphaseProxy* proxy) { return others_[std::size_t(proxy->m_uniqueId)]; }

    bullet::Broadphase octopair_;
    btDbvtBroadphase dbvt_;
    std::vector<btBroadphaseProxy*> others_;
};

/// A world above a plane.
class World {
public:
    explicit World(unsigned threads = 1)
        : broadphase(threads),
          dispatcher_(&configuration_),
          world(&dispatcher_, &broadphase, &solver_, &configuration_) {
        world.setGravity({0, -10, 0});
        ground_ = std::make_unique<btStaticPlaneShape>(btVector3(0, 1, 0), btScalar(0));
        (void)add(*ground_, {0, 0, 0}, 0);
    }
    World(const World&) = delete;
    World& operator=(const World&) = delete;
    ~World() {
        for (const auto& joint : joints_) world.removeConstraint(joint.get());
        for (const auto& body : bodies_) world.removeRigidBody(body.get());
    }

    btRigidBody& add(btCollisionShape& shape, const btVector3& place, btScalar mass) {
        btVector3 inertia(0, 0, 0);
        if (mass > 0) shape.calculateLocalInertia(mass, inertia);
        btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, &shape, inertia);
        info.m_startWorldTransform = btTransform(btQuaternion::getIdentity(), place);
        bodies_.push_back(std::make_unique<btRigidBody>(info));
        world.addRigidBody(bodies_.back().get());
        return *bodies_.back();
    }
    btBoxShape& box(const btVector3& half) {
        shapes_.push_back(std::make_unique<btBoxShape>(half));
        return *shapes_.back();
    }
    void join(btRigidBody& a, btRigidBody& b, const btVector3& in_a, const btVector3& in_b) {
        joints_.push_back(std::make_unique<btPoint2PointConstraint>(a, b, in_a, in_b));
        world.addConstraint(joints_.back().get(), true);
    }
    void remove_last() {
        world.removeRigidBody(bodies_.back().get());
        bodies_.pop_back();
    }
    /// Lets objects pass through each other, which takes a tenth of the time.
    void without_contacts() {
        dispatcher_.setNearCallback([](btBroadphasePair&, btCollisionDispatcher&, const btDispatcherInfo&) {});
    }
    void run(int steps) {
        for (int i = 0; i < steps; ++i) (void)world.stepSimulation(btScalar(1) / 60, 0);
    }

    Compared broadphase;

private:
    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_;
    btSequentialImpulseConstraintSolver solver_;
    std::unique_ptr<btStaticPlaneShape> ground_;
    std::vector<std::unique_ptr<btBoxShape>> shapes_;
    std::vector<std::unique_ptr<btRigidBody>> bodies_;
    std::vector<std::unique_ptr<btTypedConstraint>> joints_;

public:
    btDiscreteDynamicsWorld world;
};

void build_wall(World& world, int columns, int rows) {
    btBoxShape& brick = world.box({1, btScalar(0.5), btScalar(0.5)});
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            (void)world.add(brick, {btScalar(2 * column + row % 2), btScalar(row) + btScalar(0.5), 0}, 1);
        }
    }
}

/// A body of boxes, joined by ball joints, without collisions between joined boxes.
void add_ragdoll(World& world, const btVector3& place) {
    const btScalar half(0.5);
    btBoxShape &trunk = world.box({half, 1, half}), &limb = world.box({btScalar(0.2), half, btScalar(0.2)});
    btRigidBody& body = world.add(trunk, place, 5);
    for (const int side : {-1, 1}) {
        for (const int end : {-1, 1}) {
            const btVector3 joint(btScalar(side) * half, btScalar(end), 0);
            btRigidBody& upper = world.add(limb, place + joint + btVector3(0, btScalar(end) * half, 0), 1);
            world.join(body, upper, joint, {0, -btScalar(end) * half, 0});
            btRigidBody& lower = world.add(limb, place + joint + btVector3(0, btScalar(3 * end) * half, 0), 1);
            world.join(upper, lower, {0, btScalar(end) * half, 0}, {0, -btScalar(end) * half, 0});
        }
    }
}

/// Boxes at random heights, which fall on the ground and on each other.
void let_fall(World& world, int boxes) {
    btBoxShape& shape = world.box({btScalar(0.5), btScalar(0.5), btScalar(0.5)});
    const int side = std::max(1, int(std::sqrt(boxes / 10)));
    for (int i = 0; i < boxes; ++i) {
        const btScalar shift = btScalar(i % 7) / 10;
        const btVector3 place(btScalar(i % side) * 2 + shift, 1 + btScalar(i / side / side) * 2,
                              btScalar(i / side % side) * 2 + shift);
        world.add(shape, place, 1)
            .setLinearVelocity({btScalar(i * 7 % 5 - 2), btScalar(i * 13 % 11 - 5), btScalar(i * 3 % 5 - 2)});
    }
}

TEST(Worlds, AWallAndAShot) {
    World world;
    build_wall(world, 12, 8);
    world.run(40);
    btBoxShape& shot = world.box({1, 1, 1});
    world.add(shot, {10, 4, 20}, 20).setLinearVelocity({0, 0, -60});
    world.run(80);
    world.remove_last();
    world.run(20);
    EXPECT_GT(world.broadphase.pairs, 10'000u);
}

TEST(Worlds, RagdollsThatFallOnEachOther) {
    World world;
    for (int i = 0; i < 12; ++i) add_ragdoll(world, {btScalar(i % 3), btScalar(4 + 5 * i), btScalar(i % 2)});
    world.run(150);
    EXPECT_GT(world.broadphase.pairs, 1000u);
}

TEST(Worlds, TwentyThousandBoxesThatFall) {
    World world;
    world.without_contacts();
    const int boxes = sanitized ? 500 : 20'000;
    let_fall(world, boxes);
    world.run(sanitized ? 40 : 300);
    EXPECT_GT(world.broadphase.pairs, std::size_t(100 * boxes) / (sanitized ? 10 : 1));
}

TEST(Worlds, HaveTheSameOrderForAnyNumberOfThreads) {
    World one(1), two(2);
    for (World* world : {&one, &two}) {
        build_wall(*world, 10, 10);
        let_fall(*world, 300);
        world->run(60);
    }
    EXPECT_FALSE(one.broadphase.order.empty());
    EXPECT_EQ(one.broadphase.order, two.broadphase.order);
}

}  // namespace
}  // namespace octopair::test
