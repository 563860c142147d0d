// Drops boxes on the ground with Bullet, and octopair as its broad phase. Only one line differs from a program that uses Bullet alone.
#include <btBulletDynamicsCommon.h>
#include <octopair/bullet/broadphase.hpp>

#include <cstdio>
#include <memory>
#include <vector>

int main() {
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher(&configuration);
    octopair::bullet::Broadphase broadphase;  // was: btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);

    btStaticPlaneShape ground({0, 1, 0}, 0);
    btBoxShape box({0.5f, 0.5f, 0.5f});
    std::vector<std::unique_ptr<btRigidBody>> bodies;
    const auto add = [&](btCollisionShape& shape, const btVector3& place, btScalar mass) {
        btVector3 inertia(0, 0, 0);
        if (mass > 0) shape.calculateLocalInertia(mass, inertia);
        btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, &shape, inertia);
        info.m_startWorldTransform.setOrigin(place);
        bodies.push_back(std::make_unique<btRigidBody>(info));
        world.addRigidBody(bodies.back().get());
    };
    add(ground, {0, 0, 0}, 0);
    for (int i = 0; i < 5; ++i) add(box, {0, btScalar(2 * i + 1), 0}, 1);  // a tower

    for (int step = 0; step < 120; ++step) (void)world.stepSimulation(1.0f / 60, 0);
    std::printf("%d pairs: the neighbours in the tower, and each box with the ground\n",
                broadphase.getOverlappingPairCache()->getNumOverlappingPairs());
    std::printf("the highest box lies at %.1f\n", double(bodies.back()->getWorldTransform().getOrigin().y()));
    for (const auto& body : bodies) world.removeRigidBody(body.get());
}
