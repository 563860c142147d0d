// Rows of a collision result, independent of the file format: objects, findings, and the change since an older result.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "io/object_details.hpp"
#include "octopair/objects.hpp"
#include "octopair/pipeline.hpp"

namespace octopair::io {

struct ObjectKeys;

/// An input file of a set. Borrowed.
struct ObjectSource {
    std::string_view path;
    std::uint32_t end;              ///< 1 more than the number of its last object; for triangles, of its last owner
    std::string_view project = {};  ///< LoadedScene::project
    std::string_view root = {};     ///< LoadedScene::root
};

/// Names of the objects of one set. Borrowed.
struct ObjectNames {
    std::span<const std::string> names = {};     ///< empty, or one name per object; for triangles, one per owner
    std::span<const std::uint32_t> owners = {};  ///< for triangles, the owner of each, ascending; otherwise empty
    const ObjectDetails* details = nullptr;      ///< null, empty, or a row per name
    std::span<const ObjectSource> sources = {};  ///< the input files, in the order of their objects; or empty
    const ObjectKeys* keys = nullptr;            ///< null: keys are unknown (collision_key.hpp)

    /// Returns the name of an object; empty if it has none.
    std::string_view of(std::uint32_t object) const {
        const std::size_t i = owners.empty() ? object : owners[object];
        return i < names.size() ? std::string_view(names[i]) : std::string_view();
    }
    /// Returns a detail of an object, or of the owner of a triangle; empty if it is unknown.
    std::string_view detail(std::uint32_t object, Detail what) const {
        return details == nullptr ? std::string_view() : details->of(owners.empty() ? object : owners[object], what);
    }
    /// Returns the input file of an object. Requires: `sources` is not empty.
    const ObjectSource& source(std::uint32_t object) const {
        const std::size_t i = owners.empty() ? object : owners[object];
        return *std::upper_bound(sources.begin(), sources.end(), i,
                                 [](std::size_t n, const ObjectSource& source) { return n < source.end; });
    }
    bool has(Detail what) const { return details != nullptr && details->has(what); }
    /// Returns the number of a triangle among those of its owner. Requires: `owners` is not empty.
    std::uint32_t triangle(std::uint32_t object) const {
        return object - std::uint32_t(std::lower_bound(owners.begin(), owners.end(), owners[object]) - owners.begin());
    }
};

struct CollisionNames {
    ObjectNames a, b;
};

/// Change of a collision since an older result (baseline.hpp).
enum class Change : std::uint8_t { begun, same, gone };

/// Decision of people about a collision (statuses.hpp). `begun`: nobody has decided anything.
enum class Status : std::uint8_t { begun, active, reviewed, approved, resolved };

/// Number of statuses, for arrays that a status indexes.
inline constexpr std::size_t status_values = 5;

/// Status and comment of a row. The comment is borrowed.
struct RowStatus {
    Status status = Status::begun;
    std::string_view comment = {};
};

/// Selects the fields that the collisions of a result have.
struct CollisionForm {
    CollisionNames names = {};
    bool features = false;  ///< depth and contacts are known
    bool times = false;     ///< the time of first contact is known
    bool changes = false;   ///< the result is compared with a baseline
    bool statuses = false;  ///< the collisions have statuses
    bool files = false;     ///< the objects are of several input files
};

/// Consecutive rows of a result. Borrowed.
struct CollisionRows {
    std::span<const Pair> pairs;
    std::span<const Finding> findings = {};    ///< one per pair, or empty
    std::span<const Change> changes = {};      ///< one per pair, or empty
    std::span<const RowStatus> statuses = {};  ///< one per pair, or empty
};

/// Returns the word for a class in result files, for example "penetrating".
constexpr std::string_view word_of(CollisionClass collision_class) {
    constexpr std::string_view words[] = {"unknown",     "clearance", "collision", "touching",
                                          "penetrating", "contained", "duplicate", "undecided"};
    static_assert(std::size(words) == collision_classes);
    return words[std::size_t(collision_class)];
}
/// Returns the word for a kind of depth, for example "at_least".
constexpr std::string_view word_of(DepthKind kind) {
    constexpr std::string_view words[] = {"unknown", "least", "at_least"};
    return words[std::size_t(kind)];
}
/// Returns the word for a kind of thickness, for example "at_most".
constexpr std::string_view word_of(ThicknessKind kind) {
    constexpr std::string_view words[] = {"unknown", "at_most", "at_least", "undecided"};
    return words[std::size_t(kind)];
}
constexpr std::string_view word_of(Change change) {
    constexpr std::string_view words[] = {"new", "same", "gone"};
    return words[std::size_t(change)];
}

constexpr std::string_view word_of(Status status) {
    constexpr std::string_view words[] = {"new", "active", "reviewed", "approved", "resolved"};
    static_assert(std::size(words) == status_values);
    return words[std::size_t(status)];
}

/// Returns whether objects of this class meet. If they meet, depth and contacts are defined.
constexpr bool meet(CollisionClass collision_class) {
    return collision_class > CollisionClass::clearance && collision_class != CollisionClass::undecided;
}

}  // namespace octopair::io
