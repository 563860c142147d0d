// Describes what octopair reads from a file, as lines of text.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

namespace octopair::cli {

/// Returns lines "NAME  VALUE" about each file: format, version, unit, axes, objects by kind, vertices, triangles, open meshes, bounds,
/// what was not read, and warnings. An empty line stands between files.
/// Requires: no other thread of this process runs.
/// Throws: what read_input_set() and make_shaped() throw.
std::string describe_files(const std::vector<std::string>& paths, const std::stop_token& stop);

}  // namespace octopair::cli
