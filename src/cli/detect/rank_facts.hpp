// Facts that all ranks of `octopair detect` must share: its options and its inputs.
#pragma once

#include "cli/detect/frame_search.hpp"
#include "cli/ranks/facts.hpp"

namespace octopair::cli {

/// Facts about the options. Paths of inputs may differ, because hosts may have their files in different folders. So may --threads and
/// --quiet.
Facts option_facts(const DetectRequest& request);

/// Facts about the inputs: objects, frames and precision of each set, and size and content of each file. The content is that of 1,024
/// blocks of the file, evenly spread; of all of it with --verify. Boxes that a scene's shapes have count as content, too, because they
/// may depend on files that it names.
/// Requires: the inputs were read. Throws: Error{io_failed, bad_input, cancelled}.
Facts input_facts(const DetectRun& run);

}  // namespace octopair::cli
