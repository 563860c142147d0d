// The version or schema that a file states at its beginning, for people.
#pragma once

#include <string>

namespace octopair::io {

/// Returns the version of a scene file within its format, for example "IFC2X3", "1.4.1" or "binary"; empty if the beginning of the file
/// states none.
/// Throws: Error{io_failed}.
std::string version_of(const std::string& path);

}  // namespace octopair::io
