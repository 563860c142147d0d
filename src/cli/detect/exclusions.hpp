// Filters that leave pairs out by what files say of objects: rules of names, parents, groups.
#pragma once

#include "cli/detect/filter_row.hpp"

namespace octopair::cli {

/// Adds those of --exclude, of --same-parent, and of the groups in scene files. The pipeline borrows from the sets. Throws
/// Error{bad_input} for a rule about a name that no object has, Error{usage} where rules are about names and there are none.
void add_exclusions(Pipeline& pipeline, const DetectRequest& request, const SetPair& sets);

}  // namespace octopair::cli
