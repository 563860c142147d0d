// The part of a scene that a rank makes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "samples/scenes.hpp"

namespace octopair::cluster {

/// A kind of `octopair generate`, with the number of its objects.
struct WholeScene {
    std::string kind;
    std::uint64_t objects;
};

/// Returns objects [begin, end) of the scene.
inline std::vector<Box3f> make_slice(const WholeScene& scene, std::uint64_t begin, std::uint64_t end) {
    std::vector<Box3f> own;
    if (begin == end) return own;
    own.reserve(std::size_t(end - begin));
    std::uint64_t before = 0;
    samples::generate_scene({scene.kind, scene.objects, 1}, [&](std::span<const Box3f> boxes) {
        const std::uint64_t first = std::clamp(begin, before, before + boxes.size());
        const std::uint64_t last = std::clamp(end, before, before + boxes.size());
        own.insert(own.end(), boxes.begin() + std::ptrdiff_t(first - before),
                   boxes.begin() + std::ptrdiff_t(last - before));
        before += boxes.size();
    });
    return own;
}

}  // namespace octopair::cluster
