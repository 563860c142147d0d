// Shows a running scene in a browser (component viewer).
//
//     view [OBJECTS [FRAMES]]      default 10000 1000
//
// Boxes drift through the unit cube. The program prints the address of the page, and then 60 frames per second.
#include <octopair/octopair.hpp>
#include <octopair/view.hpp>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <random>
#include <thread>
#include <vector>

namespace {

/// A box, and what it moves in a frame.
struct Drifter {
    octopair::Box3f box;
    float velocity[3];
};

std::vector<Drifter> make_drifters(std::size_t count) {
    std::mt19937 random(1);
    const auto between = [&](float low, float high) { return low + float(random() % 65536) / 65536 * (high - low); };
    const float size = 0.4f / std::cbrt(float(count));
    std::vector<Drifter> drifters(count);
    for (Drifter& drifter : drifters) {
        for (int axis = 0; axis < 3; ++axis) {
            drifter.box.min[axis] = between(0, 1 - size);
            drifter.box.max[axis] = drifter.box.min[axis] + size;
            drifter.velocity[axis] = between(-0.02f, 0.02f) * size;
        }
    }
    return drifters;
}

void run(std::size_t count, int frames) {
    std::vector<Drifter> drifters = make_drifters(count);
    std::vector<octopair::Box3f> boxes;
    for (const Drifter& drifter : drifters) boxes.push_back(drifter.box);

    octopair::Scene scene;
    std::vector<octopair::ObjectId> ids(count);
    scene.add({boxes}, ids);
    octopair::View view(scene, {.title = "drifting boxes"});
    std::printf("%s\n", view.address().c_str());
    std::fflush(stdout);

    std::size_t pairs = 0;
    for (int frame = 0; frame < frames; ++frame) {
        for (std::size_t i = 0; i < count; ++i) {
            for (int axis = 0; axis < 3; ++axis) {
                const float step = frame / 200 % 2 == 0 ? drifters[i].velocity[axis] : -drifters[i].velocity[axis];
                boxes[i].min[axis] += step;
                boxes[i].max[axis] += step;
            }
        }
        scene.move(ids, boxes);
        const octopair::StepResult& step = scene.step();
        view.show(step);
        pairs = step.pairs();
        std::this_thread::sleep_for(std::chrono::milliseconds(16));
    }
    std::printf("%zu pairs in the last frame\n", pairs);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        run(argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 10'000, argc > 2 ? std::atoi(argv[2]) : 1000);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
