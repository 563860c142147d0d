// Exclusion rules: a JSON file that names pairs of objects to leave out of the result.
//
//     {"exclude": [{"a": "*/bolt*", "b": "*/nut*"}, {"a": {"type": "IfcBeam"}, "b": {"type": "IfcSlab", "level": "0.*"}},
//                 {"relation": "fills"}],
//      "ignored_pairs": [["frame/door", "frame/hinge"]],
//      "same_parent": true}
//
// docs/formats.md describes the keys. Every key is optional. An unknown key and a repeated key are errors.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/object_details.hpp"
#include "io/object_relations.hpp"
#include "octopair/filters.hpp"

namespace octopair::io {

/// Column of a rule: 0 is the name, and 1 + i is all_details[i] (object_details.hpp).
constexpr std::size_t column_of(Detail detail) { return 1 + std::size_t(detail); }

/// A rule that leaves out pairs of related elements.
struct RelationRule {
    Relation relation;
    std::string place;  ///< for messages, for example "rules.json: exclude[2]"
};

struct ExclusionRules {
    std::vector<ColumnRule> exclude;  ///< patterns of the columns above
    std::vector<RelationRule> relations;
    std::vector<std::array<std::string, 2>> ignored_pairs;  ///< two exact names each
    bool same_parent = false;
};

/// Returns the rules of a list of relations, such as "fills,assembly"; nothing if a word is no relation.
std::optional<ExclusionRules> relation_rules(std::string_view words);

/// Checks the value of an option that takes a list of relations or the path of a file. The value is a list if no such file exists, and it has a
/// comma, or neither a dot nor a slash. Throws: Error{usage} if the value is a list, and one of its words is no relation.
void check_relations(std::string_view option, const std::string& value);

/// Reads the rules of a file.
/// Throws: Error{bad_input, io_failed} that begins with the file and names the place in it, for example "exclude[2]: b".
ExclusionRules read_exclusion_rules(const std::string& path);

/// Parses rules. `file` is the name that messages begin with. Throws: Error{bad_input}.
ExclusionRules parse_exclusion_rules(std::string_view text, std::string_view file);

}  // namespace octopair::io
