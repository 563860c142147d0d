// MeshBuilder: collects the mesh of an object while its part is parsed.
//
// - Vertices come before the triangles that use them.
// - A triangle has the material that it names, or that of its object.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "io/meshes/placed_meshes.hpp"
#include "io/meshes/xml/xml_parser.hpp"

namespace octopair::io::three_mf {

/// A property in a group of properties, for example a base material: identifier of the group, and index of the property in the group.
using Property = std::pair<std::uint32_t, std::uint32_t>;

class MeshBuilder {
public:
    explicit MeshBuilder(ReadBudget& budget) : budget_(budget) {}

    /// Begins the mesh of the next object. `own`: property of the object, for triangles without a property.
    void begin(std::optional<Property> own);
    /// Adds the vertex of an element. Throws: Error{bad_input} at the line of `parser`; Error{resource_limit}.
    void add_vertex(const XmlTag& element, const XmlParser& parser);
    /// Adds the triangle of an element. Returns whether it has three different vertices. Throws: as add_vertex().
    bool add_triangle(const XmlTag& element, const XmlParser& parser);
    /// Returns the mesh. Leaves out vertices that no triangle uses. If there are no triangles, all vertices become loose vertices.
    SharedMesh take();
    /// Returns the properties that the mesh of the last take() uses.
    const std::set<Property>& properties() const { return properties_; }

private:
    void add_property(const XmlTag& element);

    ReadBudget& budget_;
    shape::Mesh mesh_;
    std::optional<Property> own_;
    std::optional<Property> last_;  // property of the previous triangle
    bool uses_own_ = false;
    std::set<Property> properties_;
};

/// Throws: Error{bad_input} "FILE: PART: line N: WHAT".
[[noreturn]] void refuse_at(const XmlParser& parser, std::string_view what);

}  // namespace octopair::io::three_mf
