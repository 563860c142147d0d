// Loop of a simulation: in each frame objects move, collisions are found, and objects respond.
//
//     bounce [OBJECTS [FRAMES [THREADS]]]      default 10000 300 0; 0 threads: one per core
//
// Cubes of equal mass move in a room. Two cubes that begin to overlap exchange their velocities on the axis with the
// least overlap, like in an elastic collision. Walls reflect the cubes. The scene reports which pairs began. So a pair
// that overlaps for several frames gets only one response.
#include <octopair/octopair.hpp>

#include <algorithm>
#include <chrono>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <random>
#include <utility>
#include <vector>

namespace {

struct Settings {
    std::size_t objects = 10'000;
    std::size_t frames = 300;
    unsigned threads = 0;
};

struct Cube {
    float centre[3];
    float velocity[3];  // distance per frame
};

class Room {
public:
    explicit Room(std::size_t objects)
        : cubes_(objects), half_(0.2f / std::cbrt(float(std::max<std::size_t>(1, objects)))) {
        std::mt19937 random(1);
        const auto between = [&](float low, float high) {
            return low + float(random() % 65536) / 65536 * (high - low);
        };
        for (Cube& cube : cubes_) {
            for (int axis = 0; axis < 3; ++axis) {
                cube.centre[axis] = between(half_, 1 - half_);
                cube.velocity[axis] = between(-half_, half_) / 4;
            }
        }
    }

    /// Moves all cubes by one frame; the room is the unit cube.
    void advance() {
        for (Cube& cube : cubes_) {
            for (int axis = 0; axis < 3; ++axis) {
                float& velocity = cube.velocity[axis];
                const float next = cube.centre[axis] + velocity;
                if (next < half_ || next > 1 - half_) velocity = -velocity;
                cube.centre[axis] += velocity;
            }
        }
    }

    void put_boxes(std::vector<octopair::Box3f>& boxes) const {
        boxes.clear();
        for (const Cube& cube : cubes_) {
            const auto [x, y, z] = cube.centre;
            boxes.push_back({{x - half_, y - half_, z - half_}, {x + half_, y + half_, z + half_}});
        }
    }

    void bounce(octopair::Pair pair) {
        Cube &a = cubes_[pair.a], &b = cubes_[pair.b];
        const auto distance = [&](int axis) { return b.centre[axis] - a.centre[axis]; };
        int axis = 0;  // the overlap is least on the axis with the largest distance
        for (int other = 1; other < 3; ++other) {
            if (std::abs(distance(other)) > std::abs(distance(axis))) axis = other;
        }
        const bool approach = (b.velocity[axis] - a.velocity[axis]) * distance(axis) < 0;
        if (approach) std::swap(a.velocity[axis], b.velocity[axis]);
    }

private:
    std::vector<Cube> cubes_;
    float half_;  // half of a cube's side
};

struct Totals {
    std::uint64_t began = 0, ended = 0;
    std::vector<double> milliseconds;  // one time for each frame
};

Totals simulate(const Settings& settings) {
    Room room(settings.objects);
    std::vector<octopair::Box3f> boxes;
    room.put_boxes(boxes);
    octopair::Scene scene({.threads = settings.threads});
    std::vector<octopair::ObjectId> ids(boxes.size());  // a new scene numbers its objects from 0 on: index i is cube i
    scene.add({boxes}, ids);
    scene.step();

    Totals totals;
    for (std::size_t frame = 0; frame < settings.frames; ++frame) {
        const auto start = std::chrono::steady_clock::now();
        room.advance();
        room.put_boxes(boxes);
        scene.move(ids, boxes);
        const octopair::StepResult& step = scene.step();
        for (const octopair::Pair pair : step.began) room.bounce(pair);
        totals.began += step.began.size();
        totals.ended += step.ended.size();
        const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
        totals.milliseconds.push_back(time.count());
    }
    return totals;
}

void print(const Settings& settings, Totals totals) {
    std::printf("%zu objects, %zu frames\n", settings.objects, settings.frames);
    std::printf("%" PRIu64 " pairs began, %" PRIu64 " ended\n", totals.began, totals.ended);
    std::vector<double>& times = totals.milliseconds;
    if (times.empty()) return;
    std::sort(times.begin(), times.end());
    std::printf("a frame: median %.3f ms, 95%% within %.3f ms, slowest %.3f ms\n", times[times.size() / 2],
                times[times.size() * 95 / 100], times.back());
}

}  // namespace

int main(int argc, char** argv) {
    Settings settings;
    const auto number = [&](int i, std::size_t otherwise) {
        return i < argc ? std::size_t(std::strtoull(argv[i], nullptr, 10)) : otherwise;
    };
    settings.objects = number(1, settings.objects);
    settings.frames = number(2, settings.frames);
    settings.threads = unsigned(number(3, settings.threads));
    try {
        print(settings, simulate(settings));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return EXIT_FAILURE;
    }
}
