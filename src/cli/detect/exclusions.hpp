// Adds filters that leave out pairs by attributes of the objects: names, parents and groups.
#pragma once

#include "cli/detect/filter_chain.hpp"
#include "io/json/exclusion_rules.hpp"

namespace octopair::cli {

/// Reads the rules of --exclude; without the option, returns no rules. Throws: Error{bad_input, io_failed}.
io::ExclusionRules read_exclusions(const DetectRequest& request);

/// Adds the filters of --exclude, of --same-parent, and of the groups in scene files. The pipeline borrows from the sets.
/// Returns whether it has added any filter.
/// Throws: Error{bad_input} for a rule about a name that no object has; Error{usage} for rules about names if the objects have
/// none.
bool add_exclusions(Pipeline& pipeline, const io::ExclusionRules& rules, const DetectRequest& request,
                    const SetPair& sets);

}  // namespace octopair::cli
