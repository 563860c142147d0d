// Compares octopair::fcl::BroadPhaseManager with FCL's managers on the same objects, one thread. Prints a table of medians.
//
//     octopair_fcl_adapter [--quick] [ROUNDS]
//
// Managers take turns in each round. Objects are boxes, spheres, capsules and cylinders with random rotations; all of them
// move and turn from round to round. Objects compute their boxes (computeAABB) before the measurement.
#include <fcl/broadphase/broadphase_SSaP.h>
#include <fcl/broadphase/broadphase_SaP.h>
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/broadphase/broadphase_dynamic_AABB_tree_array.h>
#include <fcl/broadphase/broadphase_interval_tree.h>
#include <fcl/broadphase/broadphase_spatialhash.h>
#include <fcl/broadphase/default_broadphase_callbacks.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "octopair/fcl/broad_phase_manager.hpp"

namespace {

using Manager = fcl::BroadPhaseCollisionManagerd;
using Object = fcl::CollisionObjectd;
using Pointers = std::vector<Object*>;

/// Objects in a cube, with about 3 pairs per object of FCL's boxes.
class World {
public:
    World(std::size_t count, std::uint64_t seed, double spacing = 1.35)
        : random_(seed), side_(spacing * std::cbrt(double(count))) {
        for (std::size_t i = 0; i < count; ++i) {
            objects_.push_back(std::make_unique<Object>(shape(i), random_pose()));
            pointers_.push_back(objects_.back().get());
        }
    }

    const Pointers& pointers() const { return pointers_; }
    double side() const { return side_; }

    /// Moves and turns every `step`-th object, and returns them.
    Pointers move(std::size_t step) {
        Pointers moved;
        for (std::size_t i = first_++ % step; i < pointers_.size(); i += step) {
            Object& object = *pointers_[i];
            const fcl::Matrix3d turn = fcl::AngleAxisd(0.05 * unit(), fcl::Vector3d::UnitX()).toRotationMatrix();
            const fcl::Vector3d shift(0.1 * unit(), 0.1 * unit(), 0.1 * unit());
            object.setTransform(fcl::Matrix3d(turn * object.getRotation()),
                                fcl::Vector3d(object.getTranslation() + shift));
            object.computeAABB();
            moved.push_back(&object);
        }
        return moved;
    }

private:
    double unit() { return std::uniform_real_distribution<>(-1, 1)(random_); }
    double size() { return std::uniform_real_distribution<>(0.2, 0.6)(random_); }

    std::shared_ptr<fcl::CollisionGeometryd> shape(std::size_t kind) {
        switch (kind % 4) {
            case 0:
                return std::make_shared<fcl::Boxd>(2 * size(), 2 * size(), 2 * size());
            case 1:
                return std::make_shared<fcl::Sphered>(size());
            case 2:
                return std::make_shared<fcl::Capsuled>(size() / 2, 2 * size());
            default:
                return std::make_shared<fcl::Cylinderd>(size(), 2 * size());
        }
    }

    fcl::Transform3d random_pose() {
        fcl::Transform3d pose = fcl::Transform3d::Identity();
        pose.linear() = fcl::Quaterniond(unit(), unit(), unit(), unit()).normalized().toRotationMatrix();
        pose.translation() = fcl::Vector3d(side_ / 2 * unit(), side_ / 2 * unit(), side_ / 2 * unit());
        return pose;
    }

    std::mt19937_64 random_;
    double side_;
    std::size_t first_ = 0;
    std::vector<std::unique_ptr<Object>> objects_;
    Pointers pointers_;
};

struct Contender {
    std::string name;
    std::size_t most;  ///< maximum number of objects; more would take minutes
    std::function<std::unique_ptr<Manager>(double side)> make;
    std::size_t most_for_distance = ~std::size_t(0);
};

std::unique_ptr<Manager> make_octopair(octopair::fcl::BoundingBoxes boxes) {
    return std::make_unique<octopair::fcl::BroadPhaseManagerd>(octopair::fcl::ManagerOptions{.boxes = boxes});
}

std::vector<Contender> contenders() {
    const auto hash = [](double side) -> std::unique_ptr<Manager> {
        const fcl::Vector3d corner = fcl::Vector3d::Constant(side / 2 + 4);
        return std::make_unique<fcl::SpatialHashingCollisionManager<double>>(2.0, -corner, corner);
    };
    constexpr std::size_t all = ~std::size_t(0);
    return {
        {"octopair", all, [](double) { return make_octopair(octopair::fcl::BoundingBoxes::tight); }},
        {"octopair, FCL's boxes", all, [](double) { return make_octopair(octopair::fcl::BoundingBoxes::fcl); }},
        {"FCL AABB tree", all, [](double) { return std::make_unique<fcl::DynamicAABBTreeCollisionManagerd>(); }},
        {"FCL AABB tree, array", all,
         [](double) { return std::make_unique<fcl::DynamicAABBTreeCollisionManager_Arrayd>(); }},
        {"FCL spatial hash", all, hash, 2'000},
        {"FCL sweep and prune", 10'000, [](double) { return std::make_unique<fcl::SaPCollisionManagerd>(); }},
        {"FCL simple sweep and prune", 10'000, [](double) { return std::make_unique<fcl::SSaPCollisionManagerd>(); }},
        {"FCL interval tree", 10'000, [](double) { return std::make_unique<fcl::IntervalTreeCollisionManagerd>(); }},
    };
}

bool count_pair(Object*, Object*, void* data) {
    ++*static_cast<std::uint64_t*>(data);
    return false;
}

double milliseconds(const std::function<void()>& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

/// A manager in a comparison, with its times.
struct Runner {
    std::string name;
    std::unique_ptr<Manager> manager;
    std::vector<double> times = {};
    double result = 0;  ///< number of pairs, or distance

    double median() {
        std::nth_element(times.begin(), times.begin() + std::ptrdiff_t(times.size() / 2), times.end());
        return times[times.size() / 2];
    }
};

std::vector<Runner> register_all(const World& world, std::size_t objects, bool distance = false) {
    std::vector<Runner> runners;
    for (const Contender& contender : contenders()) {
        if (objects > contender.most || (distance && objects > contender.most_for_distance)) continue;
        runners.push_back({contender.name, contender.make(world.side())});
        runners.back().manager->registerObjects(world.pointers());
        runners.back().manager->setup();
    }
    return runners;
}

/// Prints a table: median times, and their ratios to that of the first manager.
void print(const std::string& title, std::vector<Runner>& runners, const char* result) {
    std::printf("%s\n", title.c_str());
    const double first = runners.front().median();
    double best = std::numeric_limits<double>::max();
    for (Runner& runner : runners) {
        std::printf("    %-28s %10.3f ms  %8.2f x  %s %.9g\n", runner.name.c_str(), runner.median(),
                    runner.median() / first, result, runner.result);
        if (runner.name.starts_with("FCL")) best = std::min(best, runner.median());
    }
    std::printf("    fastest of FCL / octopair: %.2f\n", best / first);
    std::fflush(stdout);
}

/// Every `step`-th object moves, then all pairs are found. The first round is not counted.
void compare_steps(std::size_t objects, std::size_t step, int rounds) {
    World world(objects, 1);
    std::vector<Runner> runners = register_all(world, objects);
    for (int round = 0; round <= rounds; ++round) {
        const Pointers moved = world.move(step);
        for (Runner& runner : runners) {
            std::uint64_t pairs = 0;
            const double time = milliseconds([&] {
                step == 1 ? runner.manager->update() : runner.manager->update(moved);
                runner.manager->collide(&pairs, count_pair);
            });
            runner.result = double(pairs);
            if (round > 0) runner.times.push_back(time);
        }
    }
    const std::string what =
        step == 1 ? "all move, update()" : "one in " + std::to_string(step) + " moves, update(moved)";
    print(std::to_string(objects) + " objects, " + what + " and collide()", runners, "pairs");
}

/// All objects move, then `queries` objects are tested one by one.
void compare_queries(std::size_t objects, std::size_t queries, int rounds) {
    World world(objects, 2);
    World others(queries, 3, 1.35 * std::cbrt(double(objects) / double(queries)));
    std::vector<Runner> runners = register_all(world, objects);
    for (int round = 0; round <= rounds; ++round) {
        world.move(1);
        for (Runner& runner : runners) {
            std::uint64_t pairs = 0;
            const double time = milliseconds([&] {
                runner.manager->update();
                for (Object* const other : others.pointers()) runner.manager->collide(other, &pairs, count_pair);
            });
            runner.result = double(pairs);
            if (round > 0) runner.times.push_back(time);
        }
    }
    print(std::to_string(objects) + " objects move, update() and collide(object) for " + std::to_string(queries) +
              " objects (not all managers compare the boxes)",
          runners, "calls");
}

/// Two managers of one kind, of which one moves.
void compare_managers(std::size_t objects, int rounds) {
    World world(objects, 4), other_world(objects, 5);
    std::vector<Runner> runners = register_all(world, objects), others = register_all(other_world, objects);
    for (int round = 0; round <= rounds; ++round) {
        world.move(1);
        for (std::size_t i = 0; i < runners.size(); ++i) {
            std::uint64_t pairs = 0;
            const double time = milliseconds([&] {
                runners[i].manager->update();
                runners[i].manager->collide(others[i].manager.get(), &pairs, count_pair);
            });
            runners[i].result = double(pairs);
            if (round > 0) runners[i].times.push_back(time);
        }
    }
    print("2 managers of " + std::to_string(objects) + " objects, one moves, update() and collide(manager)", runners,
          "pairs");
}

/// All objects move, then FCL's default callback finds the smallest distance. `spacing` keeps the objects apart.
void compare_distances(std::size_t objects, double spacing, int rounds) {
    World world(objects, 6, spacing);
    std::vector<Runner> runners = register_all(world, objects, true);
    for (int round = 0; round <= rounds; ++round) {
        world.move(1);
        for (Runner& runner : runners) {
            fcl::DefaultDistanceData<double> data;
            const double time = milliseconds([&] {
                runner.manager->update();
                runner.manager->distance(&data, fcl::DefaultDistanceFunction);
            });
            runner.result = data.result.min_distance;
            if (round > 0) runner.times.push_back(time);
        }
    }
    print(std::to_string(objects) + " objects move, spacing " + std::to_string(int(spacing)) +
              ", update() and distance()",
          runners, "distance");
}

}  // namespace

int main(int argc, char** argv) {
    const bool quick = argc > 1 && std::strcmp(argv[1], "--quick") == 0;
    const int rounds = argc > 1 && !quick ? std::max(1, std::atoi(argv[1])) : quick ? 1 : 11;
    if (quick) {
        compare_steps(500, 1, rounds);
        compare_steps(500, 100, rounds);
        compare_queries(500, 100, rounds);
        compare_managers(500, rounds);
        compare_distances(100, 8, rounds);
        return 0;
    }
    compare_steps(10'000, 1, rounds);
    compare_steps(100'000, 1, rounds);
    compare_steps(100'000, 100, rounds);
    compare_queries(10'000, 1'000, rounds);
    compare_managers(10'000, rounds);
    compare_distances(2'000, 4, rounds);
    compare_distances(2'000, 8, rounds);
    return 0;
}
