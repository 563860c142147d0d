// A program for FCL that uses octopair as its broad phase. It differs from one with FCL's manager in the line marked below.
#include <fcl/broadphase/default_broadphase_callbacks.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/sphere.h>
#include <octopair/fcl/broad_phase_manager.hpp>

#include <cstdio>
#include <memory>
#include <vector>

int main() {
    // A ground, a box above it, and a ball that falls.
    fcl::CollisionObjectd ground(std::make_shared<fcl::Boxd>(20, 20, 2));
    fcl::CollisionObjectd box(std::make_shared<fcl::Boxd>(2, 2, 2));
    fcl::CollisionObjectd ball(std::make_shared<fcl::Sphered>(0.5));
    ground.setTranslation(fcl::Vector3d(0, 0, -1));
    box.setTranslation(fcl::Vector3d(0, 0, 1.25));
    ball.setTranslation(fcl::Vector3d(4, 0, 2));
    for (fcl::CollisionObjectd* const object : {&ground, &box, &ball}) object->computeAABB();

    octopair::fcl::BroadPhaseManagerd manager;  // was: fcl::DynamicAABBTreeCollisionManagerd manager;
    manager.registerObjects({&ground, &box, &ball});
    manager.setup();

    fcl::DefaultDistanceData<double> nearest;
    manager.distance(&nearest, fcl::DefaultDistanceFunction);
    std::printf("smallest distance: %.2f\n", nearest.result.min_distance);  // of the box and the ground

    for (int frame = 1; frame <= 4; ++frame) {
        ball.setTranslation(fcl::Vector3d(4, 0, 2 - 0.5 * frame));
        ball.computeAABB();
        manager.update(&ball);
        fcl::DefaultCollisionData<double> collision;
        manager.collide(&collision, fcl::DefaultCollisionFunction);
        std::printf("frame %d: %s\n", frame,
                    collision.result.isCollision() ? "the ball hits the ground" : "no collision");
    }
}
