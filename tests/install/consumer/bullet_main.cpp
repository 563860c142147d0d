// A program that finds the pairs of three proxies with octopair as Bullet's broad phase.
#include <octopair/bullet/broadphase.hpp>

int main() {
    octopair::bullet::Broadphase broadphase;
    const btVector3 one(1, 1, 1);
    for (const float at : {0.0f, 1.0f, 3.0f}) {
        const btVector3 lower = at * one;
        (void)broadphase.createProxy(lower, lower + one, 0, nullptr, 1, -1, nullptr);
    }
    broadphase.calculateOverlappingPairs(nullptr);
    return broadphase.getOverlappingPairCache()->getNumOverlappingPairs() == 1 ? 0 : 1;
}
