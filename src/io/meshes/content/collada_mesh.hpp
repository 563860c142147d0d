// Writes meshes of COLLADA with nothing but positions (collada_content.hpp).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/meshes/content/xml_tree.hpp"
#include "io/meshes/content/xml_writer.hpp"

namespace octopair::io {

/// Returns the numbers of an element's text, separated by white space.
/// Throws: Error{bad_input} with the line for another number than `count` (0: any), and for a word that is no number.
std::vector<double> collada_numbers(const XmlElement& element, std::size_t count = 0);

/// Returns a text with these numbers.
std::string collada_text(const std::vector<double>& numbers);

/// Returns the number of groups of primitives of a <mesh> that have a primitive.
std::size_t count_primitive_groups(const XmlElement& mesh);

/// Writes a <mesh>.
/// Throws: Error{bad_input} with the line.
void write_collada_mesh(const XmlElement& mesh, XmlWriter& out);

}  // namespace octopair::io
