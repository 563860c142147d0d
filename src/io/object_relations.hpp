// ObjectRelations: how the elements of building models belong together, and the elements that objects are parts of.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "io/object_details.hpp"

namespace octopair::io {

/// A relation between elements.
enum class Relation : std::uint8_t {
    fills,     ///< one element fills an opening of the other, as a door does in its wall
    assembly,  ///< both are in one assembly, as the flights of a stair are
    system     ///< both are in one system, for example of pipes
};
inline constexpr std::array all_relations = {Relation::fills, Relation::assembly, Relation::system};

/// Returns the word for a relation in rules, for example "fills".
constexpr std::string_view word_of(Relation relation) {
    constexpr std::array<std::string_view, all_relations.size()> words = {"fills", "assembly", "system"};
    return words[std::size_t(relation)];
}
/// Returns the relation of a word; nothing if there is none.
std::optional<Relation> relation_of(std::string_view word);

/// A link from one key to another:
/// - fills: from the element that fills an opening to the element that has the opening.
/// - assembly: from a part to the element that it is a direct part of.
/// - system: from a member to its system.
struct Link {
    std::uint32_t from, to;

    bool operator==(const Link&) const = default;
};

/// Relations of n objects, or of none if no file has elements.
///
/// A key names an element or a system: the GlobalId of the project, and its own. So two files of one project name an element alike.
struct ObjectRelations {
    std::vector<std::string> keys = {{}};  ///< distinct keys; the first is empty
    std::vector<std::uint32_t> elements;   ///< n indices into `keys`: the element of each object; 0: none
    std::array<std::vector<Link>, all_relations.size()> links;  ///< indices into `keys`, by relation

    bool empty() const { return elements.empty(); }
};

/// Adds keys to a table. Equal keys get the same number.
class KeyNumbers {
public:
    /// Adds to `keys`, which is borrowed.
    explicit KeyNumbers(std::vector<std::string>& keys);

    std::uint32_t of(const std::string& key);

private:
    std::vector<std::string>& keys_;
    std::unordered_map<std::string, std::uint32_t> numbers_;
};

/// Appends the relations of a second set to those of a first set. If a set has no relations, its objects get no elements.
void append_relations(ObjectRelations& first, const ObjectRelations& second, const DetailCounts& counts);

}  // namespace octopair::io
