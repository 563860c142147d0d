// Filter "relation rules": drops pairs of elements of building models that belong together (io/object_relations.hpp).
//
// A relation is between two different elements, also if they are in different inputs: GlobalIds of one project name them.
//
// fills      One element fills an opening of the other. The parts of an element fill and have its openings, too. What fills an opening of
//            a part fills one of its wholes. What fills an opening of an element that fills an opening of a third fills this one, too.
// assembly   Both have the same outermost whole, or one is this whole.
// system     Both are in one system. The parts of an element are in its systems.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "cli/input/input_set.hpp"
#include "io/json/exclusion_rules.hpp"
#include "octopair/filters.hpp"

namespace octopair::cli {

/// Makes the filter.
std::unique_ptr<Filter> make_relation_filter(std::span<const io::RelationRule> rules, const SetPair& sets);

/// Returns a warning for each rule whose relation no input has.
std::vector<std::string> relation_warnings(std::span<const io::RelationRule> rules, const SetPair& sets);

}  // namespace octopair::cli
