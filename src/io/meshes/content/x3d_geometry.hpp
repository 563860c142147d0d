// Writes the geometry nodes of X3D in a form that Assimp reads rightly (x3d_content.hpp).
#pragma once

#include <functional>
#include <string_view>

#include "io/meshes/content/xml_tree.hpp"
#include "io/meshes/content/xml_writer.hpp"

namespace octopair::io {

/// Returns the node that an element with USE refers to, or the element itself.
using X3dResolve = std::function<XmlElement(const XmlElement&)>;

/// Writes a geometry node. Returns false if its type is not known.
/// Throws: Error{bad_input} with the line.
bool write_x3d_geometry(const XmlElement& node, const X3dResolve& resolve, XmlWriter& out);

/// Writes an attribute with `count` numbers, if the node has the attribute.
/// Throws: Error{bad_input} with the line.
void write_x3d_numbers(const XmlElement& node, std::string_view name, std::size_t count, XmlWriter& out);

/// Returns the numbers of an attribute. Numbers are separated by white space and commas.
/// Throws: Error{bad_input} with the line for a word that is no number.
std::vector<double> x3d_numbers(const XmlElement& node, std::string_view name);

/// Returns the text of an attribute with these numbers.
std::string x3d_text(const std::vector<double>& numbers);

}  // namespace octopair::io
