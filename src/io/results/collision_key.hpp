// Keys: the identity of objects and collisions from one version of a model to the next. Baselines, statuses and topics of BCF use it.
// Start here to change which objects of two results count as the same.
//
// - The key of an object is PROJECT/ID: the ids of the project and of the element, as IFC has them. A format without these ids has
//   INPUT:PATH: the number of the input file, from 1, and the path of the object in the file. An object without a name has INPUT:#NUMBER.
// - Names of files, of IFC elements and of what contains them do not change a key.
// - If several objects have the same key, "~2", "~3" and so on follow the keys of all but the first, in the order of their numbers.
// - A triangle adds "#" and its number within its owner.
// - The key of a collision has the keys of its two objects, the lesser first, with " | " between them. The order of the sets does not matter.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "io/results/collision_row.hpp"

namespace octopair::io {

/// Makes the keys of all objects of a result.
class KeyMaker {
public:
    /// Returns a key for each object of the next set; for triangles, for each owner. Requires: the set has sources.
    std::vector<std::string> keys_of(const ObjectNames& set);

private:
    std::string different_from_known(const std::string& key);

    std::size_t inputs_ = 0;                                // number of inputs of the sets before
    std::unordered_map<std::string, std::uint32_t> known_;  // keys so far, and the last number that follows each
};

/// Returns the key of an object; empty if its set has no keys.
std::string object_key(std::uint32_t object, const ObjectNames& names);

/// Returns the key of a collision; empty if a set has no keys.
std::string collision_key(Pair pair, const CollisionNames& names);

}  // namespace octopair::io
