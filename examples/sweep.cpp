// A fast projectile is in front of a thin wall in one frame and behind the wall in the next. The boxes overlap in
// neither frame. sweep() tests the whole path between both frames.
#include <octopair/octopair.hpp>

#include <array>
#include <cstdio>

namespace {

constexpr octopair::Box3f wall = {{0, -5, -5}, {0.1f, 5, 5}};
constexpr octopair::Box3f before = {{-4, 0, 0}, {-3, 1, 1}};
constexpr octopair::Box3f behind = {{3, 0, 0}, {4, 1, 1}};

/// Returns how many pairs begin when the projectile flies past the wall.
std::size_t fly(bool swept) {
    octopair::Scene scene;
    std::array<octopair::ObjectId, 2> ids;
    scene.add({std::array{wall, before}}, ids);
    scene.step();

    const std::array projectile = {ids[1]};
    const std::array boxes = {behind};
    swept ? scene.sweep(projectile, boxes) : scene.move(projectile, boxes);
    return scene.step().began.size();
}

}  // namespace

int main() {
    std::printf("pairs found by move: %zu, by sweep: %zu\n", fly(false), fly(true));  // 0 and 1
}
