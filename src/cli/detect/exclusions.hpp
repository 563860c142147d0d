// Adds filters that leave out pairs by attributes of the objects: names, parents and groups.
#pragma once

#include "cli/detect/filter_chain.hpp"

namespace octopair::cli {

/// Adds the filters of --exclude, of --same-parent, and of the groups in scene files. The pipeline borrows from the sets.
/// Throws: Error{bad_input} for a rule about a name that no object has; Error{usage} for rules about names if the objects have
/// none.
void add_exclusions(Pipeline& pipeline, const DetectRequest& request, const SetPair& sets);

}  // namespace octopair::cli
