// C++ calls for comparison with those of the Python package, in the same process: compare.py loads this library. Each function
// returns the seconds of one call.
#include <chrono>
#include <memory>
#include <span>
#include <vector>

#include "octopair/octopair.hpp"

namespace {

using namespace octopair;

template <typename Work>
double seconds_of(Work work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

std::span<const Box3f> boxes_at(const float* numbers, std::size_t count) {
    return {reinterpret_cast<const Box3f*>(numbers), count};
}

Engine& kept_engine(unsigned threads) {
    static std::unique_ptr<Engine> engine;
    static unsigned made_with = 0;
    if (!engine || made_with != threads) engine = make_local_engine(made_with = threads);
    return *engine;
}

std::unique_ptr<Scene> scene;
std::vector<ObjectId> ids;

}  // namespace

#pragma GCC visibility push(default)
extern "C" {

/// An engine and a list that are kept.
double find_with_engine(const float* numbers, std::size_t count, unsigned threads) {
    static PairList pairs;
    Engine& engine = kept_engine(threads);
    return seconds_of([&] { engine.find_pairs({boxes_at(numbers, count)}, pairs); });
}

/// The short form, whose result is a vector.
double find_at_once(const float* numbers, std::size_t count, unsigned) {
    std::vector<Pair> pairs;
    return seconds_of([&] { pairs = find_pairs(boxes_at(numbers, count)); });
}

void make_scene(const float* numbers, std::size_t count) {
    scene = std::make_unique<Scene>();
    ids.resize(count);
    scene->add({boxes_at(numbers, count)}, ids);
    scene->step();
}

/// Moves the objects whose mask is 1 and makes a step. `numbers`: the new boxes of these objects.
double move_and_step(const float* numbers, const unsigned char* mask, std::size_t moved) {
    return seconds_of([&] {
        std::vector<ObjectId> chosen;
        chosen.reserve(moved);
        for (std::size_t i = 0; i < ids.size(); ++i) {
            if (mask[i] != 0) chosen.push_back(ids[i]);
        }
        scene->move(chosen, boxes_at(numbers, moved));
        scene->step();
    });
}
}
#pragma GCC visibility pop
