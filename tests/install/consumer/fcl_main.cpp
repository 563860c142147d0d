// A program for FCL with octopair's manager.
#include <fcl/geometry/shape/sphere.h>
#include <octopair/fcl/broad_phase_manager.hpp>

#include <cstdio>
#include <memory>

int main() {
    try {
        fcl::CollisionObjectd a(std::make_shared<fcl::Sphered>(1)), b(std::make_shared<fcl::Sphered>(1));
        octopair::fcl::BroadPhaseManagerd manager;
        manager.registerObjects({&a, &b});
        int pairs = 0;
        const auto count = [](fcl::CollisionObjectd*, fcl::CollisionObjectd*, void* data) {
            ++*static_cast<int*>(data);
            return false;
        };
        manager.collide(&pairs, count);
        return pairs == 1 ? 0 : 1;
    } catch (const octopair::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
