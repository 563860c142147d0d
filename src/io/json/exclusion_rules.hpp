// Exclusion rules: which pairs of a scene are not asked about, by the names of their objects. A JSON file:
//
//     {"exclude": [{"a": "*/bolt*", "b": "*/nut*"}],
//      "ignored_pairs": [["frame/door", "frame/hinge"]],
//      "same_parent": true}
//
// docs/formats.md says what each means. Every key may be left out; one that is not known is an error, as is one that is there
// twice.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "octopair/filters.hpp"

namespace octopair::io {

struct ExclusionRules {
    std::vector<NameRule> exclude;
    std::vector<std::array<std::string, 2>> ignored_pairs;  ///< by whole names
    bool same_parent = false;
};

/// Throws Error{bad_input, io_failed}; the message begins with the file and names the place: "exclude[2]: b".
ExclusionRules read_exclusion_rules(const std::string& path);

/// `file`: for messages.
ExclusionRules parse_exclusion_rules(std::string_view text, std::string_view file);

}  // namespace octopair::io
