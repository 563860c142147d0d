// Compares octopair::fcl::BroadPhaseManager with FCL's managers on the same objects, one thread. Prints a table of medians.
//
//     octopair_adapter_fcl [--quick] [ROUNDS]
//
// Managers take turns in each round. Objects are boxes, spheres, capsules and cylinders that move and turn from round to round.
// They compute their boxes (computeAABB) before the measurement. FCL's trees keep their structure when all objects move, so they
// become slower from step to step; "rebuilt" registers all objects anew in each step.
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

#include "machine/median.hpp"
#include "octopair/fcl/broad_phase_manager.hpp"

namespace {

using Manager = fcl::BroadPhaseCollisionManagerd;
using Object = fcl::CollisionObjectd;
using Pointers = std::vector<Object*>;

/// Objects that fly through a cube at constant speed, turn, and bounce off its faces. Each has about 3 pairs of FCL's boxes.
class World {
public:
    World(std::size_t count, std::uint64_t seed, double side) : random_(seed), side_(side) {
        for (std::size_t i = 0; i < count; ++i) {
            const fcl::Vector3d place = side_ / 2 * random_vector();
            objects_.push_back(std::make_unique<Object>(shape(i), random_rotation(), place));
            pointers_.push_back(objects_.back().get());
            speeds_.push_back(0.1 * random_vector());
        }
    }
    static double side_for(std::size_t count) { return 1.35 * std::cbrt(double(count)); }

    const Pointers& pointers() const { return pointers_; }
    double side() const { return side_; }

    /// Moves and turns every `stride`-th object, and returns them.
    Pointers move(std::size_t stride) {
        const fcl::Matrix3d turn = fcl::AngleAxisd(0.05, fcl::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
        Pointers moved;
        for (std::size_t i = first_++ % stride; i < pointers_.size(); i += stride) {
            const fcl::Vector3d place = pointers_[i]->getTranslation();
            for (int axis = 0; axis < 3; ++axis) {
                const bool outside = std::abs(place[axis]) > side_ / 2;
                if (outside) speeds_[i][axis] = -std::copysign(speeds_[i][axis], place[axis]);
            }
            put(*pointers_[i], turn * pointers_[i]->getRotation(), place + speeds_[i]);
            moved.push_back(pointers_[i]);
        }
        return moved;
    }

    /// Puts each object near the centre of a cell of a grid, so that no objects meet.
    void spread() {
        constexpr double cell = 3;
        const std::size_t edge = std::size_t(std::ceil(std::cbrt(double(pointers_.size()))));
        for (std::size_t i = 0; i < pointers_.size(); ++i) {
            const fcl::Vector3d centre(double(i % edge), double(i / edge % edge), double(i / edge / edge));
            put(*pointers_[i], random_rotation(), cell * centre + 0.4 * random_vector());
        }
    }

private:
    double unit() { return std::uniform_real_distribution<>(-1, 1)(random_); }
    double size() { return std::uniform_real_distribution<>(0.2, 0.6)(random_); }
    fcl::Vector3d random_vector() { return fcl::Vector3d(unit(), unit(), unit()); }
    fcl::Matrix3d random_rotation() {
        return fcl::Quaterniond(unit(), unit(), unit(), unit()).normalized().toRotationMatrix();
    }
    static void put(Object& object, const fcl::Matrix3d& rotation, const fcl::Vector3d& place) {
        object.setTransform(rotation, place);
        object.computeAABB();
    }

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

    std::mt19937_64 random_;
    double side_;
    std::size_t first_ = 0;
    std::vector<std::unique_ptr<Object>> objects_;
    std::vector<fcl::Vector3d> speeds_;
    Pointers pointers_;
};

struct Contender {
    std::string name;
    std::size_t most;  ///< maximum number of objects; more would take minutes
    std::function<std::unique_ptr<Manager>(double side)> make;
    bool rebuilds = false;  ///< registers all objects anew in place of update()
};

std::unique_ptr<Manager> make_octopair(octopair::fcl::BoundingBoxes boxes) {
    return std::make_unique<octopair::fcl::BroadPhaseManagerd>(octopair::fcl::ManagerOptions{.boxes = boxes});
}

std::vector<Contender> contenders() {
    const auto hash = [](double side) -> std::unique_ptr<Manager> {
        const fcl::Vector3d corner = fcl::Vector3d::Constant(side / 2 + 4);
        return std::make_unique<fcl::SpatialHashingCollisionManager<double>>(2.0, -corner, corner);
    };
    const auto tree = [](double) { return std::make_unique<fcl::DynamicAABBTreeCollisionManagerd>(); };
    const auto array = [](double) { return std::make_unique<fcl::DynamicAABBTreeCollisionManager_Arrayd>(); };
    constexpr std::size_t all = ~std::size_t(0);
    return {
        {"octopair", all, [](double) { return make_octopair(octopair::fcl::BoundingBoxes::tight); }},
        {"octopair, FCL's boxes", all, [](double) { return make_octopair(octopair::fcl::BoundingBoxes::fcl); }},
        {"FCL AABB tree", all, tree},
        {"FCL AABB tree, array", all, array},
        {"FCL AABB tree, rebuilt", all, tree, true},
        {"FCL spatial hash", 2'000, hash},
        {"FCL sweep and prune", 2'000, [](double) { return std::make_unique<fcl::SaPCollisionManagerd>(); }},
        {"FCL simple sweep and prune", 2'000, [](double) { return std::make_unique<fcl::SSaPCollisionManagerd>(); }},
        {"FCL interval tree", 2'000, [](double) { return std::make_unique<fcl::IntervalTreeCollisionManagerd>(); }},
    };
}

bool count_pair(Object*, Object*, void* data) {
    ++*static_cast<std::uint64_t*>(data);
    return false;
}

/// Returns the duration of `work`.
double milliseconds(const std::function<void()>& work) {
    // Some managers free millions of small blocks, which glibc merges in the next large allocation. That is done here, so that
    // the time does not count for the next manager.
    void* volatile block = std::malloc(100'000);  // volatile: compilers remove unused allocations
    std::free(block);
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

/// A manager in a comparison, with its times.
struct Runner {
    std::string name;
    std::unique_ptr<Manager> manager;
    bool rebuilds;
    std::vector<double> times = {};
    double result = 0;  ///< number of pairs, or distance

    double median() const { return octopair::bench::median(times); }
    /// Updates the manager after all objects moved, or those of `moved`.
    void update(const Pointers& all, const Pointers* moved = nullptr) {
        if (rebuilds) {
            manager->clear();
            manager->registerObjects(all);
            manager->setup();
        } else if (moved != nullptr) {
            manager->update(*moved);
        } else {
            manager->update();
        }
    }
};

std::vector<Runner> register_all(const World& world) {
    const Pointers& objects = world.pointers();
    std::vector<Runner> runners;
    for (const Contender& contender : contenders()) {
        if (objects.size() > contender.most) continue;
        runners.push_back({contender.name, contender.make(world.side()), contender.rebuilds});
        runners.back().manager->registerObjects(objects);
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

struct Steps {
    std::size_t objects;
    std::size_t stride;  ///< one in `stride` objects moves in a step
    int first;           ///< number of steps before the measured ones
};

/// Objects move, then all pairs are found. The first step is never measured.
void compare_steps(const Steps& steps, int rounds) {
    World world(steps.objects, 1, World::side_for(steps.objects));
    std::vector<Runner> runners = register_all(world);
    for (int round = 0; round <= steps.first + rounds; ++round) {
        const Pointers moved = world.move(steps.stride);
        for (Runner& runner : runners) {
            std::uint64_t pairs = 0;
            const double time = milliseconds([&] {
                runner.update(world.pointers(), steps.stride == 1 ? nullptr : &moved);
                runner.manager->collide(&pairs, count_pair);
            });
            runner.result = double(pairs);
            if (round > steps.first) runner.times.push_back(time);
        }
    }
    const std::string moving = steps.stride == 1 ? "all move" : "one in " + std::to_string(steps.stride) + " moves";
    print(std::to_string(steps.objects) + " objects, " + moving + ", after " + std::to_string(steps.first) +
              " steps: update and collide()",
          runners, "pairs");
}

/// All objects move, then `queries` other objects are tested one by one.
void compare_queries(std::size_t objects, std::size_t queries, int rounds) {
    World world(objects, 2, World::side_for(objects));
    const World others(queries, 3, world.side());
    std::vector<Runner> runners = register_all(world);
    for (int round = 0; round <= rounds; ++round) {
        world.move(1);
        for (Runner& runner : runners) {
            std::uint64_t pairs = 0;
            const double time = milliseconds([&] {
                runner.update(world.pointers());
                for (Object* const other : others.pointers()) runner.manager->collide(other, &pairs, count_pair);
            });
            runner.result = double(pairs);
            if (round > 0) runner.times.push_back(time);
        }
    }
    print(std::to_string(objects) + " objects move: update and collide(object) for " + std::to_string(queries) +
              " objects",
          runners, "calls");
}

/// Two managers of one kind, of which one moves.
void compare_managers(std::size_t objects, int rounds) {
    World world(objects, 4, World::side_for(objects));
    const World other_world(objects, 5, world.side());
    std::vector<Runner> runners = register_all(world), others = register_all(other_world);
    for (int round = 0; round <= rounds; ++round) {
        world.move(1);
        for (std::size_t i = 0; i < runners.size(); ++i) {
            std::uint64_t pairs = 0;
            const double time = milliseconds([&] {
                runners[i].update(world.pointers());
                runners[i].manager->collide(others[i].manager.get(), &pairs, count_pair);
            });
            runners[i].result = double(pairs);
            if (round > 0) runners[i].times.push_back(time);
        }
    }
    print("2 managers of " + std::to_string(objects) + " objects, one moves: update and collide(manager)", runners,
          "pairs");
}

/// FCL's default callback finds the smallest distance of objects that do not meet.
void compare_distances(std::size_t objects, int rounds) {
    World world(objects, 6, 3 * std::cbrt(double(objects)));
    world.spread();
    std::vector<Runner> runners = register_all(world);
    for (int round = 0; round <= rounds; ++round) {
        world.spread();
        for (Runner& runner : runners) {
            fcl::DefaultDistanceData<double> data;
            const double time = milliseconds([&] {
                runner.update(world.pointers());
                runner.manager->distance(&data, fcl::DefaultDistanceFunction);
            });
            runner.result = data.result.min_distance;
            if (round > 0) runner.times.push_back(time);
        }
    }
    print(std::to_string(objects) + " objects move: update and distance()", runners, "distance");
}

}  // namespace

int main(int argc, char** argv) {
    if (argc > 1 && std::strcmp(argv[1], "--quick") == 0) {
        compare_steps({500, 1, 0}, 1);
        compare_steps({500, 100, 0}, 1);
        compare_queries(500, 100, 1);
        compare_managers(500, 1);
        compare_distances(100, 1);
        return 0;
    }
    const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 11;
    compare_steps({2'000, 1, 0}, rounds);
    for (const std::size_t objects : {10'000, 100'000}) {
        for (const int first : {0, 20, 50}) compare_steps({objects, 1, first}, rounds);
    }
    compare_steps({100'000, 100, 0}, rounds);
    compare_queries(10'000, 1'000, rounds);
    compare_managers(10'000, rounds);
    compare_distances(2'000, rounds);
    return 0;
}
