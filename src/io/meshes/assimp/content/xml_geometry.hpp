// Writes the geometry of COLLADA and X3D files in a form that Assimp reads rightly: only positions, and only indices that were checked
// (mesh_content.hpp).
#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "io/meshes/xml/xml_tree.hpp"

namespace octopair::io {

/// Returns the numbers of the text of a COLLADA element, separated by white space.
/// Throws: Error{bad_input} with the line for another number than `count` (0: any), and for a word that is no number.
std::vector<double> collada_numbers(const XmlElement& element, std::size_t count = 0);

/// Returns the number of groups of primitives of a <mesh> that have a primitive.
std::size_t count_primitive_groups(const XmlElement& mesh);

/// Writes a <mesh> of COLLADA.
/// Throws: Error{bad_input} with the line.
void write_collada_mesh(const XmlElement& mesh, XmlWriter& out);

/// Returns the node that an element with USE refers to, or the element itself.
using X3dResolve = std::function<XmlElement(const XmlElement&)>;

/// Writes a geometry node of X3D. Returns false if its type is not known.
/// Throws: Error{bad_input} with the line.
bool write_x3d_geometry(const XmlElement& node, const X3dResolve& resolve, XmlWriter& out);

/// Writes an attribute of X3D with `count` numbers, if the node has the attribute.
/// Throws: Error{bad_input} with the line.
void write_x3d_numbers(const XmlElement& node, std::string_view name, std::size_t count, XmlWriter& out);

/// Returns the numbers of an attribute of X3D. Numbers are separated by white space and commas.
/// Throws: Error{bad_input} with the line for a word that is no number.
std::vector<double> x3d_numbers(const XmlElement& node, std::string_view name);

}  // namespace octopair::io
