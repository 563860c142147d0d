// What is written of a collision, whatever the form of the file: which objects, what is known of the two, and how it
// stands to an older result.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "octopair/objects.hpp"
#include "octopair/pipeline.hpp"

namespace octopair::io {

/// The names of what a, or b, of a pair counts. Borrowed.
struct ObjectNames {
    std::span<const std::string> names = {};     ///< empty, or one an object; of triangles: one an owner
    std::span<const std::uint32_t> owners = {};  ///< empty, or of each triangle its owner, ascending

    /// Empty, if it has none.
    std::string_view of(std::uint32_t object) const {
        const std::size_t i = owners.empty() ? object : owners[object];
        return i < names.size() ? std::string_view(names[i]) : std::string_view();
    }
    /// A triangle's number among those of its owner.
    std::uint32_t triangle(std::uint32_t object) const {
        return object - std::uint32_t(std::lower_bound(owners.begin(), owners.end(), owners[object]) - owners.begin());
    }
};

struct CollisionNames {
    ObjectNames a, b;
};

/// How a collision stands to an older result (baseline.hpp).
enum class Change : std::uint8_t { begun, same, gone };

/// Rows of a result, in order. Borrowed.
struct CollisionRows {
    std::span<const Pair> pairs;
    std::span<const Finding> findings = {};  ///< as many, or none
    std::span<const Change> changes = {};    ///< as many, or none
};

/// As it stands in files: "penetrating".
constexpr std::string_view word_of(CollisionClass collision_class) {
    constexpr std::string_view words[] = {"unknown", "clearance", "collision", "touching", "penetrating", "contained"};
    return words[std::size_t(collision_class)];
}
constexpr std::string_view word_of(Change change) {
    constexpr std::string_view words[] = {"new", "same", "gone"};
    return words[std::size_t(change)];
}

/// Two that meet, so that a depth and contacts mean something; else there is a distance.
constexpr bool meet(CollisionClass collision_class) { return collision_class > CollisionClass::clearance; }

}  // namespace octopair::io
