// The schema of an IFC file, and types that Assimp's reader does not know. It knows IFC2x3 alone, and crashes on geometry of other types.
#pragma once

#include <string>
#include <string_view>

namespace octopair::io {

/// Returns the name in FILE_SCHEMA, for example "IFC4"; empty if there is none. `step`: the text of the file, or its beginning.
std::string ifc_schema(std::string_view step);

/// Returns the geometric types in the text that IFC2x3 does not have, with their numbers: "12 IfcTriangulatedFaceSet, 3
/// IfcIndexedPolyCurve". Complexity: linear in the text, for each of about 30 types.
std::string types_beyond_ifc2x3(std::string_view step);

/// Returns why Assimp fails on an IFC file, as far as its text shows, and what to do. Empty for other files, and for compressed ones.
/// Throws: Error{bad_input, io_failed} if the file cannot be read.
std::string ifc_remedy(const std::string& path);

}  // namespace octopair::io
