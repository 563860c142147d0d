// Kind: a kind of sample scene, and the function that places its objects. Internal to samples.
// Start here to add a new scene of generate.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

#include "octopair/objects.hpp"

namespace octopair::samples {

/// Returns the box of object i. A pure function of i.
using Placer = std::function<Box3f(std::uint64_t)>;

/// Parameters of a scene. The sizes of its boxes depend on the number of objects.
struct Population {
    std::uint64_t objects;
    std::uint64_t seed;
};

struct Kind {
    std::string_view name;
    std::string_view description;
    bool moves;  ///< true if a scene may have several frames
    Placer (*make_placer)(const Population&);
};

/// Returns all kinds, in the order of docs/scenes.md.
std::span<const Kind> all_kinds();

/// Returns a side length: n cubes of this side at random places in the unit cube form about `pairs_per_object` * n pairs. Large
/// cubes form fewer, because of the border of the world.
double cube_side(std::uint64_t objects, double pairs_per_object);

}  // namespace octopair::samples
