// The broad phase of a step: btDbvtBroadphase beside the adapter, on one thread.
//
//     octopair_adapter_bullet [--quick]
//
// A step sets the boxes that have moved and updates the pairs. Both get the same boxes. They fall, bounce and turn, without a solver,
// whose time is the same for both.
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <random>

#include "adapters/side_by_side.hpp"
#include "octopair/bullet/broadphase.hpp"

namespace {

/// Rigid boxes of side 1 that fall on the ground and bounce. `awake`: part of the boxes that move.
class Boxes {
public:
    Boxes(int count, double awake) : lower(std::size_t(count)), upper(lower.size()), bodies_(lower.size()) {
        const double side = 1.3 * std::cbrt(double(count));
        std::uniform_real_distribution<double> place(0, side), velocity(-1, 1);
        for (std::size_t i = 0; i < lower.size(); ++i) {
            Body& body = bodies_[i];
            for (double& one : body.place) one = place(random_);
            for (double& one : body.velocity) one = velocity(random_);
            body.angle = place(random_);
            set_box(i);
            if (std::bernoulli_distribution(awake)(random_)) moving.push_back(i);
        }
    }

    void step() {
        constexpr double seconds = 1.0 / 60;
        for (const std::size_t i : moving) {
            Body& body = bodies_[i];
            body.velocity[1] -= 10 * seconds;
            for (std::size_t axis = 0; axis < 3; ++axis) body.place[axis] += seconds * body.velocity[axis];
            if (body.place[1] < 0) body.velocity[1] = std::abs(body.velocity[1]) * 0.9;
            body.angle += seconds;
            set_box(i);
        }
    }

    std::vector<btVector3> lower, upper;
    std::vector<std::size_t> moving;

private:
    struct Body {
        double place[3], velocity[3], angle;
    };

    void set_box(std::size_t i) {
        const Body& body = bodies_[i];
        const double half = 0.5 * (std::abs(std::cos(body.angle)) + std::abs(std::sin(body.angle)));
        const btVector3 centre{btScalar(body.place[0]), btScalar(body.place[1]), btScalar(body.place[2])};
        const btVector3 extent{btScalar(half), btScalar(0.5), btScalar(half)};
        lower[i] = centre - extent;
        upper[i] = centre + extent;
    }

    std::mt19937 random_{1};
    std::vector<Body> bodies_;
};

/// A broad phase with a proxy for each box.
class World {
public:
    World(std::unique_ptr<btBroadphaseInterface> broadphase, const Boxes& boxes) : broadphase_(std::move(broadphase)) {
        for (std::size_t i = 0; i < boxes.lower.size(); ++i) {
            proxies_.push_back(broadphase_->createProxy(boxes.lower[i], boxes.upper[i], 0, nullptr, 1, -1, nullptr));
        }
        broadphase_->calculateOverlappingPairs(nullptr);
    }
    void step(const Boxes& boxes) {
        for (const std::size_t i : boxes.moving)
            broadphase_->setAabb(proxies_[i], boxes.lower[i], boxes.upper[i], nullptr);
        broadphase_->calculateOverlappingPairs(nullptr);
    }
    /// Returns the number of pairs whose boxes overlap.
    int pairs() {
        int count = 0;
        const btBroadphasePairArray& all = broadphase_->getOverlappingPairCache()->getOverlappingPairArray();
        for (int i = 0; i < all.size(); ++i) {
            count += TestAabbAgainstAabb2(all[i].m_pProxy0->m_aabbMin, all[i].m_pProxy0->m_aabbMax,
                                          all[i].m_pProxy1->m_aabbMin, all[i].m_pProxy1->m_aabbMax)
                         ? 1
                         : 0;
        }
        return count;
    }

private:
    std::unique_ptr<btBroadphaseInterface> broadphase_;
    std::vector<btBroadphaseProxy*> proxies_;
};

bool compare(const char* name, int count, double awake, unsigned steps) {
    Boxes boxes(count, awake);
    World dbvt(std::make_unique<btDbvtBroadphase>(), boxes),
        octopair(std::make_unique<octopair::bullet::Broadphase>(), boxes);
    octopair::bench::print_side_by_side(
        name, steps, [&] { dbvt.step(boxes); }, [&] { octopair.step(boxes); }, [&] { boxes.step(); });
    return dbvt.pairs() == octopair.pairs();
}

}  // namespace

int main(int count, char** arguments) {
    const bool quick = count > 1 && std::strcmp(arguments[1], "--quick") == 0;
    std::printf("%-44s %13s %13s\n", "boxes", "btDbvt", "octopair");
    const bool same = quick ? compare("2,000 that fall", 2000, 1, 5)
                            : compare("20,000 that fall", 20'000, 1, 200) &&
                                  compare("100,000 that fall", 100'000, 1, 50) &&
                                  compare("100,000, 1 of 100 awake", 100'000, 0.01, 200);
    if (!same) std::printf("the pairs differ\n");
    return same ? 0 : 1;
}
