// Keys: the identity of objects and collisions from one version of a model to the next. Baselines, statuses and topics of BCF use it.
// Start here to change which objects of two results count as the same.
//
// - The key of an object is PROJECT/ID: the ids of the project and of the element, as IFC has them. A format without these ids has
//   INPUT:PATH: the number of the input file, from 1, and the path of the object in the file. An object without a name has INPUT#NUMBER.
// - Names of files, of IFC elements and of what contains them do not change a key.
// - If several objects have the same key, "~2", "~3" and so on follow the keys of all but the first, in the order of their numbers.
// - A triangle adds "#" and its number within its owner.
// - The key of a collision has the keys of its two objects, the lesser first, with " | " between them. The order of the sets does not matter.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "io/results/collision_row.hpp"

namespace octopair::io {

/// Data from which the keys of a set are made, besides its names. A key is made when a row needs it, so large sets need little memory.
struct ObjectKeys {
    std::uint32_t inputs_before = 0;  ///< number of input files of the sets before
    std::unordered_map<std::uint32_t, std::string> repeated =
        {};  ///< keys that would occur twice, by the object or owner
};

/// Returns the keys of the sets of a result: of one set, or of both sets of a join. Requires: the sets have sources.
/// Complexity: linear in the objects with names or ids, up to a sort of 16 bytes for each.
std::vector<ObjectKeys> make_object_keys(std::span<const ObjectNames> sets);

/// Returns the key of an object; empty if its set has no keys.
std::string object_key(std::uint32_t object, const ObjectNames& names);

/// Returns the key of a collision; empty if a set has no keys.
std::string collision_key(Pair pair, const CollisionNames& names);

/// Returns an object in words for people: its label and type, or its name, or its number. Not for comparisons.
std::string object_title(std::uint32_t object, const ObjectNames& names);

}  // namespace octopair::io
