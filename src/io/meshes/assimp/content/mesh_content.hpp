// MeshContent: the result of a check of a mesh file's text, before Assimp reads the file.
// Start here to change what is done about faults of Assimp.
//
// A check of a format finds what Assimp reads wrongly. It writes the content in a form that Assimp reads rightly, refuses the file, or counts
// what is left out.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "io/formats.hpp"

namespace octopair::io {

struct MeshContent {
    /// Text that Assimp reads in place of the file; none: Assimp reads the file itself.
    std::optional<std::string> text;
    /// Ending of the format of `text`; empty: that of the file.
    std::string ending;
    /// Content that Assimp leaves out, for example "entities of type 3DSOLID (2)".
    std::vector<std::string> left_out;
};

/// Counts what is left out.
class LeftOut {
public:
    void add(const std::string& what, std::size_t count = 1) { counts_[what] += count; }
    /// Returns for example "nodes of type LOD (2)", in alphabetical order.
    std::vector<std::string> list() const;

private:
    std::map<std::string, std::size_t> counts_;
};

/// Checks the content of a file that Assimp is going to read.
/// Throws: Error{bad_input} with the line if Assimp would read the file wrongly; Error{io_failed}.
MeshContent check_mesh_content(const std::string& path, const KnownFormat& known);

}  // namespace octopair::io
