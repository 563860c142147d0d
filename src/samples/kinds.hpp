// The kinds of scenes: how each places its object i. Internal to samples.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

#include "octopair/objects.hpp"

namespace octopair::samples {

/// The box of object i. Pure: any order of calls gives the same boxes.
using Placer = std::function<Box3f(std::uint64_t)>;

/// What the sizes of a scene follow from.
struct Population {
    std::uint64_t objects;
    std::uint64_t seed;
};

struct Kind {
    std::string_view name;
    std::string_view description;
    bool moves;
    Placer (*make_placer)(const Population&);
};

/// All kinds, in the order of docs/scenes.md.
std::span<const Kind> all_kinds();

/// The side of a cube such that n cubes, thrown into the unit cube at random, make `pairs_per_object` * n pairs (fewer
/// where they are so large that the border of the world matters).
double cube_side(std::uint64_t objects, double pairs_per_object);

}  // namespace octopair::samples
