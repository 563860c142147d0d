// The text of an IFC file (STEP, ISO 10303-21).
//
// - Elements: Assimp describes an element in the name of its node. The text adds what Assimp loses: encoded letters of names
//   ("B\X2\00FC\X0\ro", for Büro, becomes "Bro"), and materials. The text also shows whether the file is cut; Assimp reads such files.
// - Schema: Assimp reads only IFC2x3, and crashes on geometric types of other schemas.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "io/object_relations.hpp"

namespace octopair::io {

/// An IFC element, as the name of its node describes it: TYPE_NAME_GLOBALID. Borrows from that name.
struct IfcElement {
    std::string_view type;
    std::string_view name;  ///< empty if the element has none, or if Assimp has cut the node's name
    std::string_view id;    ///< GlobalId; empty if Assimp has cut the node's name
};

/// Parses the name of a node of an IFC file. Returns nothing if the node is not an element.
std::optional<IfcElement> parse_ifc_element(std::string_view node_name);

/// Maps the GlobalId of an element to a text in UTF-8.
using IfcTexts = std::unordered_map<std::string, std::string>;

/// An element with a body.
struct IfcBody {
    std::string id, type;  ///< GlobalId, and class in capitals, for example "IFCWALL"

    bool operator==(const IfcBody&) const = default;
};

/// A link between two elements, or between an element and a system (io::Link), by their GlobalIds.
struct IfcLink {
    std::string from, to;

    bool operator==(const IfcLink&) const = default;
};
/// Links by relation.
using IfcLinks = std::array<std::vector<IfcLink>, all_relations.size()>;

/// Facts that the text of an IFC file has and Assimp does not pass on.
struct IfcText {
    IfcTexts names;      ///< names of the elements that have one
    IfcTexts materials;  ///< names of the materials that are associated with an element, joined by ", "
    /// Elements that have a body: a representation that is no axis, footprint or the like. They are in the order of the file. Openings,
    /// spaces and grids are left out, because Assimp leaves them out.
    std::vector<IfcBody> bodies;
    std::map<std::string, std::uint64_t> left_out;  ///< number of elements with a shape that Assimp leaves out, by type
    std::string project;                            ///< GlobalId of the project; empty if there is none
    IfcLinks links;                                 ///< links between elements, and to systems
    std::string schema;             ///< name of the schema, for example "IFC2X3"; empty if there is none
    double largest_coordinate = 0;  ///< largest absolute coordinate of all points, in the unit of the file
    bool complete = false;          ///< false: the text ends before the end of a STEP file
};

/// Reads a STEP text. An element is an instance whose first attribute is a text of 22 characters; its third attribute is its name. A text
/// that is not STEP has no elements. Complexity: linear.
IfcText read_ifc_text(std::string_view step);

/// Decodes a text of a STEP file to UTF-8: the codes '', \\, \S\, \X\, \X2\ and \X4\. Invalid codes stay as they are.
std::string decode_step_text(std::string_view text);

/// Returns the name of the schema in FILE_SCHEMA, for example "IFC4"; empty if there is none. `step`: text of the file, or its beginning.
std::string ifc_schema(std::string_view step);

/// Returns the geometric types in the text that IFC2x3 lacks, each with its number of instances: "12 IfcTriangulatedFaceSet, 3
/// IfcIndexedPolyCurve". Complexity: linear in the text, for each of about 30 types.
std::string types_beyond_ifc2x3(std::string_view step);

/// Returns a likely reason why Assimp fails on an IFC file, and what to do. Empty for other files, and for compressed files.
/// Throws: Error{bad_input, io_failed} if the file cannot be read.
std::string ifc_remedy(const std::string& path);

}  // namespace octopair::io
